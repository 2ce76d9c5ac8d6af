/* machine.h - what a measurement was made on: processor, memory, system, libraries.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_MACHINE_H
#define PARIAN_MEASURE_MACHINE_H

#include <stdint.h>

struct cJSON;

enum { PARIAN_MACHINE_TEXT_MAX = 160 };

typedef struct parian_machine {
    char processor[PARIAN_MACHINE_TEXT_MAX]; /* "unknown" where the system does not tell */
    char system[PARIAN_MACHINE_TEXT_MAX];    /* distribution, kernel */
    char compiler[PARIAN_MACHINE_TEXT_MAX];
    uint32_t cores; /* that this process may use */
    uint64_t memory_bytes;
} parian_machine;

void parian_machine_read(parian_machine *machine);

/* An object of all of it, with the shared libraries that are loaded, by the names of their files,
 * which carry their versions. NULL without memory. */
struct cJSON *parian_machine_json(const parian_machine *machine);

#endif
