/* inspect_values.c - single numbers of typed arrays.
 *
 * SPDX-License-Identifier: MIT
 */
#include "inspect/inspect_values.h"

#include <inttypes.h>
#include <stdio.h>

#include "core/half.h"

double inspect_value(parian_element element, const void *data, size_t index)
{
    switch (element) {
    case PARIAN_ELEMENT_U8:
        return ((const uint8_t *)data)[index];
    case PARIAN_ELEMENT_S8:
        return ((const int8_t *)data)[index];
    case PARIAN_ELEMENT_U16:
        return ((const uint16_t *)data)[index];
    case PARIAN_ELEMENT_S16:
        return ((const int16_t *)data)[index];
    case PARIAN_ELEMENT_U32:
        return ((const uint32_t *)data)[index];
    case PARIAN_ELEMENT_S32:
        return ((const int32_t *)data)[index];
    case PARIAN_ELEMENT_U64:
        return (double)((const uint64_t *)data)[index];
    case PARIAN_ELEMENT_F16:
        return parian_half_to_float(((const parian_half *)data)[index]);
    case PARIAN_ELEMENT_F32:
        return ((const float *)data)[index];
    case PARIAN_ELEMENT_F64:
        return ((const double *)data)[index];
    }
    return 0;
}

bool inspect_is_real(parian_element element)
{
    return element == PARIAN_ELEMENT_F16 || element == PARIAN_ELEMENT_F32 ||
           element == PARIAN_ELEMENT_F64;
}

size_t inspect_print_value(parian_element element, const void *data, size_t index, char *text,
                           size_t size)
{
    if (element == PARIAN_ELEMENT_U64) {
        return (size_t)snprintf(text, size, "%" PRIu64, ((const uint64_t *)data)[index]);
    }
    int digits = element == PARIAN_ELEMENT_F64 ? 17 : element == PARIAN_ELEMENT_F16 ? 6 : 9;
    digits = inspect_is_real(element) ? digits : 10;
    return (size_t)snprintf(text, size, "%.*g", digits, inspect_value(element, data, index));
}
