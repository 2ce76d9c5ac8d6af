/* inspect_values.h - single numbers of typed arrays.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_INSPECT_VALUES_H
#define PARIAN_INSPECT_VALUES_H

#include "parian/format.h"

/* Element `index` of an array as a double (u64 above 2^53 is rounded). */
double inspect_value(parian_element element, const void *data, size_t index);
/* The same as text that reads back exactly; returns its length. */
size_t inspect_print_value(parian_element element, const void *data, size_t index, char *text,
                           size_t size);
bool inspect_is_real(parian_element element);

#endif
