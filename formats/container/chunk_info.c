/* chunk_info.c - elements, and what can be said of a chunk from its description alone.
 *
 * SPDX-License-Identifier: MIT
 */
#include "container/chunk_info.h"

#include "container/container_layout.h"

static const struct {
    uint8_t size;
    bool integer;
    char name[4];
} element_table[] = {
    [PARIAN_ELEMENT_U8] = {1, true, "u8"},    [PARIAN_ELEMENT_S8] = {1, true, "s8"},
    [PARIAN_ELEMENT_U16] = {2, true, "u16"},  [PARIAN_ELEMENT_S16] = {2, true, "s16"},
    [PARIAN_ELEMENT_U32] = {4, true, "u32"},  [PARIAN_ELEMENT_S32] = {4, true, "s32"},
    [PARIAN_ELEMENT_U64] = {8, true, "u64"},  [PARIAN_ELEMENT_F16] = {2, false, "f16"},
    [PARIAN_ELEMENT_F32] = {4, false, "f32"}, [PARIAN_ELEMENT_F64] = {8, false, "f64"},
};

size_t parian_element_size(parian_element element)
{
    unsigned index = (unsigned)element;
    return index <= PARIAN_ELEMENT_F64 ? element_table[index].size : 0;
}

const char *parian_element_name(parian_element element)
{
    return parian_element_size(element) ? element_table[element].name : NULL;
}

const char *parian_codec_name(parian_codec codec)
{
    static const char *const name[] = {"raw", "zstd", "shuffle+zstd", "delta+zstd"};
    unsigned index = (unsigned)codec;
    return index <= PARIAN_CODEC_DELTA_ZSTD ? name[index] : NULL;
}

static bool is_name_byte(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
}

static bool is_name(const char *name)
{
    size_t length = 0;
    while (length < PARIAN_CHUNK_NAME_MAX && is_name_byte(name[length])) {
        length++;
    }
    if (length == 0) {
        return false;
    }
    for (size_t i = length; i < PARIAN_CHUNK_NAME_MAX; i++) {
        if (name[i] != 0) {
            return false;
        }
    }
    return length < PARIAN_CHUNK_NAME_MAX;
}

static bool shape_size(const parian_chunk_info *info, uint64_t *size)
{
    uint64_t total = parian_element_size(info->element);
    for (uint32_t i = 0; i < info->rank; i++) {
        if (info->shape[i] != 0 && total > INT64_MAX / info->shape[i]) {
            return false;
        }
        total *= info->shape[i];
    }
    *size = total;
    return true;
}

static bool shape_is_tidy(const parian_chunk_info *info)
{
    if (info->rank < 1 || info->rank > PARIAN_CHUNK_RANK_MAX) {
        return false;
    }
    for (uint32_t i = info->rank; i < PARIAN_CHUNK_RANK_MAX; i++) {
        if (info->shape[i] != 0) {
            return false;
        }
    }
    return true;
}

int parian_chunk_info_check(const parian_chunk_info *info, uint64_t *size, const char **finding)
{
    if (!is_name(info->name)) {
        *finding = "a chunk name is 1 to 39 of a-z 0-9 _ . and zeros behind them";
        return RULE_NAME;
    }
    if (parian_element_size(info->element) == 0) {
        *finding = "the element type is unknown";
        return RULE_ELEMENT;
    }
    if (!parian_codec_name(info->codec)) {
        *finding = "the codec is unknown";
        return RULE_CODEC;
    }
    if (info->codec == PARIAN_CODEC_DELTA_ZSTD && !element_table[info->element].integer) {
        *finding = "the delta codec is for integers";
        return RULE_CODEC;
    }
    if (!shape_is_tidy(info)) {
        *finding = "the rank is 1 to 4 and the shape behind it zero";
        return RULE_SHAPE;
    }
    if (info->flags & FLAGS_RESERVED) {
        *finding = "a reserved flag is set";
        return RULE_ENTRY_RESERVED;
    }
    if (!shape_size(info, size)) {
        *finding = "the shape is larger than any file";
        return RULE_SIZE;
    }
    return 0;
}

int parian_chunk_info_order(const parian_chunk_info *a, const parian_chunk_info *b)
{
    if (a->object != b->object) {
        return a->object < b->object ? -1 : 1;
    }
    if (a->level != b->level) {
        return a->level < b->level ? -1 : 1;
    }
    return strcmp(a->name, b->name);
}
