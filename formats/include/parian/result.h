/* result.h - what every fallible Parian function returns, and the text of each result.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_RESULT_H
#define PARIAN_RESULT_H

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default) /* what a shared library exports */
#endif

/* One table: name, number, exit status of a tool that ends with it, text. Numbers never change. */
#define PARIAN_RESULT_TABLE(X)                                                                     \
    X(PARIAN_OK, 0, 0, "ok")                                                                       \
    X(PARIAN_E_ARGUMENT, 1, 1, "invalid argument")                                                 \
    X(PARIAN_E_IO, 2, 2, "input or output failed")                                                 \
    X(PARIAN_E_FORMAT, 3, 3, "invalid input file")                                                 \
    X(PARIAN_E_COMPUTE, 4, 4, "computation failed")                                                \
    X(PARIAN_E_NOMEM, 5, 4, "out of memory")                                                       \
    X(PARIAN_E_UNSUPPORTED, 6, 5, "not supported")                                                 \
    X(PARIAN_E_LIMIT, 7, 3, "a limit is exceeded")                                                 \
    X(PARIAN_E_DEVICE, 8, 4, "graphics device failed")                                             \
    X(PARIAN_E_INTERRUPTED, 9, 130, "interrupted")

typedef enum parian_result {
#define X(name, number, status, text) name = number,
    PARIAN_RESULT_TABLE(X)
#undef X
} parian_result;

/* The text of a result: static, English, lower case, without a full stop. Never NULL. */
const char *parian_result_text(parian_result result);

/* The exit status of a tool that fails with this result (docs: command-line contract). */
int parian_result_exit_status(parian_result result);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
