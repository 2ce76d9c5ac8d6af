/* operator_check.c - checks the sparse operators of a body: runs, factors, and how they chain.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/array_check.h"
#include "core/body_schema.h"
#include "core/memory.h"

static parian_result fail(const parian_env *env, const char *where, int rule, const char *what,
                          size_t index)
{
    return parian_fail(env, PARIAN_E_FORMAT, "%s: rule %d: %s (element %zu)", where, rule, what,
                       index);
}

static parian_result check_offsets(const parian_env *env, const parian_operator *op,
                                   const char *where)
{
    const uint32_t *offset = op->run_offset;
    if (offset[0] != 0 || offset[op->row_count] != op->run_total) {
        return fail(env, where, RULE_OFFSETS,
                    "operator.run_offset goes from 0 to the number of runs", op->row_count);
    }
    for (uint32_t row = 0; row < op->row_count; row++) {
        if (offset[row] > offset[row + 1] || offset[row + 1] > op->run_total) {
            return fail(env, where, RULE_OFFSETS, "operator.run_offset never descends", row);
        }
    }
    return PARIAN_OK;
}

/* Row of the first bad run; offsets are good. */
static size_t find_row(const void *context, size_t begin, size_t end)
{
    const parian_operator *op = context;
    for (size_t row = begin; row < end; row++) {
        uint64_t free_column = 0;
        for (uint32_t run = op->run_offset[row]; run < op->run_offset[row + 1]; run++) {
            uint32_t count = op->run_count[run];
            if (count < 1 || count > PARIAN_RUN_MAX || op->run_column[run] < free_column) {
                return row;
            }
            free_column = (uint64_t)op->run_column[run] + count;
        }
        if (free_column > op->column_count) {
            return row;
        }
    }
    return PARIAN_ALL_GOOD;
}

static parian_result check_factors(const parian_env *env, const parian_operator *op,
                                   const char *where)
{
    uint64_t total = 0;
    for (uint32_t run = 0; run < op->run_total; run++) {
        total += op->run_count[run];
    }
    if (total != op->factor_total) {
        return fail(env, where, RULE_FACTOR_COUNT,
                    "operator.factor has as many rows as the runs have columns", total);
    }
    size_t bad = parian_find_infinite_half(env, op->factor, op->factor_total * 3);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(env, where, RULE_FINITE, "operator.factor is finite", bad);
    }
    bad = parian_find_outside(env, op->scale, (size_t)op->row_count * 3, 0, 1e30f);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(env, where, RULE_FINITE, "operator.scale is 0 to 1e30", bad);
    }
    return PARIAN_OK;
}

parian_result parian_operator_check(const parian_env *env, const parian_operator *op,
                                    const char *where)
{
    parian_result result = check_offsets(env, op, where);
    if (result != PARIAN_OK) {
        return result;
    }
    size_t bad = parian_find_bad(env, op->row_count, find_row, op);
    if (bad != PARIAN_ALL_GOOD) {
        return fail(env, where, RULE_RUNS,
                    "runs of a row have 1 to 256 columns, ascend, do not overlap and stay inside "
                    "the operator",
                    bad);
    }
    return check_factors(env, op, where);
}

/* Registers hold as many numbers as the operators that meet there say. */
enum { REGISTER_COUNT = 2 * PARIAN_MAX_OPERATORS };

static bool claim_register(uint32_t size[REGISTER_COUNT], bool known[REGISTER_COUNT],
                           uint32_t index, uint32_t count)
{
    if (index >= REGISTER_COUNT || (known[index] && size[index] != count)) {
        return false;
    }
    known[index] = true;
    size[index] = count;
    return true;
}

parian_result parian_operators_check(const parian_env *env, const parian_body *body,
                                     const char *where)
{
    uint32_t size[REGISTER_COUNT] = {body->vertex_count, body->vertex_count};
    bool known[REGISTER_COUNT] = {true, true};
    for (uint32_t i = 0; i < body->operator_count; i++) {
        const parian_operator *op = &body->operators[i];
        if (op->source_register == op->target_register ||
            (i == 0 && (op->source_register != 0 || op->target_register != 1)) ||
            !claim_register(size, known, op->source_register, op->column_count) ||
            !claim_register(size, known, op->target_register, op->row_count)) {
            return fail(env, where, RULE_REGISTER,
                        "operators lead from a register to another, 0 to 31, whose sizes agree; 0 "
                        "and 1 hold the vertices, and the first operator leads from 0 to 1",
                        i);
        }
        parian_result result = parian_operator_check(env, op, where);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}
