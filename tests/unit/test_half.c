/* test_half.c - half floats: exact values, rounding to even, and the vector path equal to the
 * scalar one.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "core/half.h"
#include "support/test_support.h"

enum { HALVES = 65536, STRIDE = 997 };

static float float_of_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t bits_of_float(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void known_values(void **state)
{
    (void)state;
    assert_int_equal(parian_half_from_float(0.0f), 0);
    assert_int_equal(parian_half_from_float(-0.0f), 0x8000);
    assert_int_equal(parian_half_from_float(1.0f), 0x3c00);
    assert_int_equal(parian_half_from_float(-2.0f), 0xc000);
    assert_int_equal(parian_half_from_float(65504.0f), 0x7bff);
    assert_int_equal(parian_half_from_float(65519.996f), 0x7bff);
    assert_int_equal(parian_half_from_float(65520.0f), 0x7c00);
    assert_int_equal(parian_half_from_float(INFINITY), 0x7c00);
    assert_int_equal(parian_half_from_float(-INFINITY), 0xfc00);
    assert_int_equal(parian_half_from_float(0x1p-14f), 0x0400);
    assert_int_equal(parian_half_from_float(0x1p-24f), 0x0001);
    assert_int_equal(parian_half_from_float(0x1p-25f), 0x0000);   /* tie to even */
    assert_int_equal(parian_half_from_float(0x1.8p-24f), 0x0002); /* tie to even */
    assert_int_equal(parian_half_from_float(0x1.000002p-25f), 0x0001);
    assert_int_equal(parian_half_from_float(1.0f + 0x1p-11f), 0x3c00); /* tie to even */
    assert_int_equal(parian_half_from_float(1.0f + 0x1.8p-10f), 0x3c02);
    assert_true(isnan(parian_half_to_float(parian_half_from_float(NAN))));
}

/* Every half comes back; halfway to its upper neighbour it rounds to the even one of the two. */
static void every_half(void **state)
{
    (void)state;
    for (uint32_t h = 0; h < 0x7c00; h++) {
        float value = parian_half_to_float((parian_half)h);
        assert_int_equal(parian_half_from_float(value), h);
        assert_int_equal(parian_half_from_float(-value), h | 0x8000);
        assert_true(value == (h < 0x400 ? ldexpf((float)h, -24)
                                        : ldexpf((float)(h % 1024 + 1024), (int)(h / 1024) - 25)));
        if (h < 0x7bff) {
            float middle = 0.5f * (value + parian_half_to_float((parian_half)(h + 1)));
            assert_int_equal(parian_half_from_float(middle), h + (h & 1));
            assert_int_equal(parian_half_from_float(nextafterf(middle, 0)), h);
            assert_int_equal(parian_half_from_float(nextafterf(middle, 1e9f)), h + 1);
        }
    }
}

static void arrays_equal_scalars(void **state)
{
    (void)state;
    static parian_half half[HALVES];
    static float value[HALVES];
    for (uint32_t h = 0; h < HALVES; h++) {
        half[h] = (parian_half)h;
    }
    for (size_t count = HALVES - 9; count <= HALVES; count++) { /* with and without a tail */
        parian_half_to_float_array(half, value, count);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(bits_of_float(value[i]), bits_of_float(parian_half_to_float(half[i])));
        }
    }
    for (uint64_t bits = 0; bits <= UINT32_MAX;) { /* a spread of all floats, NaNs included */
        size_t count = 0;
        for (; count < HALVES && bits <= UINT32_MAX; count++, bits += STRIDE) {
            value[count] = float_of_bits((uint32_t)bits);
        }
        parian_half_from_float_array(value, half, count);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(half[i], parian_half_from_float(value[i]));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_values),
        cmocka_unit_test(every_half),
        cmocka_unit_test(arrays_equal_scalars),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
