/* result.c - texts and exit statuses of results.
 *
 * SPDX-License-Identifier: MIT
 */
#include "parian/result.h"

const char *parian_result_text(parian_result result)
{
    switch (result) {
#define X(name, number, status, text)                                                              \
    case name:                                                                                     \
        return text;
        PARIAN_RESULT_TABLE(X)
#undef X
    }
    return "unknown result";
}

int parian_result_exit_status(parian_result result)
{
    switch (result) {
#define X(name, number, status, text)                                                              \
    case name:                                                                                     \
        return status;
        PARIAN_RESULT_TABLE(X)
#undef X
    }
    return 4;
}
