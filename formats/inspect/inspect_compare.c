/* inspect_compare.c - parian-info compare: whether two assets hold the same, up to a tolerance.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "inspect/inspect.h"
#include "inspect/inspect_values.h"

typedef enum verdict { SAME, WITHIN, DIFFERENT, SHAPE, ONLY_A, ONLY_B } verdict;

static const char *const verdict_names[] = {"same",  "within",    "different",
                                            "shape", "only in a", "only in b"};

typedef struct difference {
    verdict verdict;
    double largest;     /* largest |a - b| */
    double scale;       /* largest |a| */
    double relative_l2; /* sqrt(sum (a - b)^2 / sum a^2) */
} difference;

typedef struct comparison {
    const parian_env *env;
    const inspect_options *options;
    parian_reader *a, *b;
    cJSON *list; /* NULL: text */
    bool different;
} comparison;

/* Numbers with a tolerance: reals, and the bytes of kernels. Indices and texts are exact. */
static bool has_tolerance(parian_element element)
{
    return inspect_is_real(element) || element == PARIAN_ELEMENT_S8 ||
           element == PARIAN_ELEMENT_S16;
}

static void measure(const parian_chunk_info *info, const void *a, const void *b, difference *found)
{
    size_t count = info->size / parian_element_size(info->element);
    double square = 0, square_a = 0;
    for (size_t i = 0; i < count; i++) {
        double x = inspect_value(info->element, a, i), y = inspect_value(info->element, b, i);
        double gap = fabs(x - y);
        found->largest = gap > found->largest || isnan(gap) ? gap : found->largest;
        found->scale = fmax(found->scale, fabs(x));
        square += gap * gap;
        square_a += x * x;
    }
    found->relative_l2 = square > 0 ? sqrt(square / square_a) : 0;
}

static void judge(const comparison *c, const parian_chunk_info *info, const void *a, const void *b,
                  difference *found)
{
    if (memcmp(a, b, info->size) == 0) {
        return;
    }
    bool text = info->element == PARIAN_ELEMENT_U8;
    measure(info, a, b, found);
    bool near =
        has_tolerance(info->element) && found->largest <= c->options->tolerance * found->scale;
    found->verdict = near || (text && c->options->tolerance_given) ? WITHIN : DIFFERENT;
}

static bool same_shape(const parian_chunk_info *a, const parian_chunk_info *b)
{
    return a->element == b->element && a->rank == b->rank &&
           memcmp(a->shape, b->shape, sizeof a->shape) == 0;
}

static parian_result compare_data(const comparison *c, uint32_t index_a, uint32_t index_b,
                                  difference *found)
{
    const parian_chunk_info *info = parian_reader_chunk(c->a, index_a);
    uint8_t *a = parian_alloc(c->env, info->size, 1), *b = parian_alloc(c->env, info->size, 1);
    parian_result result =
        a && b ? PARIAN_OK
               : parian_fail(c->env, PARIAN_E_NOMEM, "no memory to compare %s", info->name);
    if (result == PARIAN_OK) {
        result = parian_reader_read(c->a, index_a, a);
    }
    if (result == PARIAN_OK) {
        result = parian_reader_read(c->b, index_b, b);
    }
    if (result == PARIAN_OK) {
        judge(c, info, a, b, found);
    }
    parian_free(c->env, a);
    parian_free(c->env, b);
    return result;
}

static void report(comparison *c, const parian_chunk_info *info, const difference *found)
{
    char name[INSPECT_NAME_MAX];
    inspect_chunk_name(info, name);
    c->different |= found->verdict >= DIFFERENT;
    bool measured = found->verdict == WITHIN || found->verdict == DIFFERENT;
    if (c->list) {
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "name", name);
        cJSON_AddStringToObject(json, "verdict", verdict_names[found->verdict]);
        if (measured) {
            cJSON_AddNumberToObject(json, "max_difference", found->largest);
            cJSON_AddNumberToObject(json, "max_value", found->scale);
            cJSON_AddNumberToObject(json, "relative_l2", found->relative_l2);
        }
        cJSON_AddItemToArray(c->list, json);
    } else if (measured) {
        printf("%-32s %-10s largest %.3g of %.3g, relative L2 %.3g\n", name,
               verdict_names[found->verdict], found->largest, found->scale, found->relative_l2);
    } else if (found->verdict != SAME) {
        printf("%-32s %s\n", name,
               found->verdict == SHAPE ? "another shape or element"
                                       : verdict_names[found->verdict]);
    }
}

static parian_result compare_chunks(comparison *c)
{
    for (uint32_t i = 0; i < parian_reader_chunk_count(c->a); i++) {
        const parian_chunk_info *info = parian_reader_chunk(c->a, i);
        int64_t other = parian_reader_find(c->b, info->name, info->object, info->level);
        difference found = {.verdict = SAME};
        if (other < 0) {
            found.verdict = ONLY_A;
        } else if (!same_shape(info, parian_reader_chunk(c->b, (uint32_t)other))) {
            bool text = info->element == PARIAN_ELEMENT_U8 && c->options->tolerance_given;
            found.verdict = text ? WITHIN : SHAPE;
        } else {
            parian_result result = compare_data(c, i, (uint32_t)other, &found);
            if (result != PARIAN_OK) {
                return result;
            }
        }
        report(c, info, &found);
    }
    for (uint32_t i = 0; i < parian_reader_chunk_count(c->b); i++) {
        const parian_chunk_info *info = parian_reader_chunk(c->b, i);
        if (parian_reader_find(c->a, info->name, info->object, info->level) < 0) {
            report(c, info, &(difference){.verdict = ONLY_B});
        }
    }
    return PARIAN_OK;
}

static parian_result print_comparison(comparison *c)
{
    if (!c->list) {
        if (!c->different && !c->options->common.quiet) {
            puts(c->options->tolerance_given ? "the same within the tolerance" : "the same");
        }
        return PARIAN_OK;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "a", parian_reader_name(c->a));
    cJSON_AddStringToObject(json, "b", parian_reader_name(c->b));
    cJSON_AddNumberToObject(json, "tolerance", c->options->tolerance);
    cJSON_AddBoolToObject(json, "different", c->different);
    cJSON_AddItemToObject(json, "chunks", c->list);
    c->list = NULL;
    return inspect_print_json(c->env, json);
}

parian_result inspect_compare(const parian_env *env, const inspect_options *options,
                              bool *different)
{
    comparison c = {.env = env, .options = options};
    parian_result result = parian_reader_open(env, options->assets.item[0], NULL, &c.a);
    if (result == PARIAN_OK) {
        result = parian_reader_open(env, options->assets.item[1], NULL, &c.b);
    }
    if (result == PARIAN_OK) {
        c.list = options->json ? cJSON_CreateArray() : NULL;
        result = compare_chunks(&c);
    }
    if (result == PARIAN_OK) {
        result = print_comparison(&c);
    }
    *different = c.different;
    cJSON_Delete(c.list);
    parian_reader_close(c.a);
    parian_reader_close(c.b);
    return result;
}
