/* media_presets.c - measured media, as the literature lists them.
 *
 * Numbers are in mm^-1 as printed; the macros turn them into m^-1. Jensen et al. measured reduced
 * scattering only, which stays reduced (g is unknown, not 0). Circulating copies have misprints
 * that are mended here: Chicken1 and Chicken2 absorb 0.015 and 0.018 in red (not a tenth of it),
 * Apple 0.046 in blue (not 0.0046).
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/media_file.h"

#include <ctype.h>

/* clang-format off */
#define JENSEN \
    "Jensen et al. 2001, A Practical Model for Subsurface Light Transport, Figure 5 (reduced coefficients only)"
#define NARASIMHAN \
    "Narasimhan et al. 2006, Acquiring Scattering Properties of Participating Media by Dilution; eta assumed"
#define GKIOULEKAS \
    "Gkioulekas et al. 2013, Inverse Volume Rendering with Material Dictionaries, second-hand; eta assumed"
#define PER_MM(r, g, b) {1e3 * (r), 1e3 * (g), 1e3 * (b)}
/* name, source, sigma_s', sigma_a, eta */
#define REDUCED(title, from, s, a, index) {title, from, PER_MM s, PER_MM a, {0, 0, 0}, index, true}
/* name, source, sigma_s', sigma_a, g, eta; sigma_s = sigma_s' / (1 - g) agrees with the measured one within 2 % */
#define FULL(title, from, s, a, g0, g1, g2, index) {title, from, PER_MM s, PER_MM a, {g0, g1, g2}, index, false}

static const parian_medium presets[] = {
    REDUCED("Apple", JENSEN, (2.29, 2.39, 1.97), (0.003, 0.0034, 0.046), 1.3),
    REDUCED("Chicken1", JENSEN, (0.15, 0.21, 0.38), (0.015, 0.077, 0.19), 1.3),
    REDUCED("Chicken2", JENSEN, (0.19, 0.25, 0.32), (0.018, 0.088, 0.2), 1.3),
    REDUCED("Cream", JENSEN, (7.38, 5.47, 3.15), (0.0002, 0.0028, 0.0163), 1.3),
    REDUCED("Ketchup", JENSEN, (0.18, 0.07, 0.03), (0.061, 0.97, 1.45), 1.3),
    REDUCED("Marble", JENSEN, (2.19, 2.62, 3), (0.0021, 0.0041, 0.0071), 1.5),
    REDUCED("Potato", JENSEN, (0.68, 0.7, 0.55), (0.0024, 0.009, 0.12), 1.3),
    REDUCED("Skimmilk", JENSEN, (0.7, 1.22, 1.9), (0.0014, 0.0025, 0.0142), 1.3),
    REDUCED("Skin1", JENSEN, (0.74, 0.88, 1.01), (0.032, 0.17, 0.48), 1.3),
    REDUCED("Skin2", JENSEN, (1.09, 1.59, 1.79), (0.013, 0.07, 0.145), 1.3),
    REDUCED("Spectralon", JENSEN, (11.6, 20.4, 14.9), (0, 0, 0), 1.3),
    REDUCED("Wholemilk", JENSEN, (2.55, 3.21, 3.77), (0.0011, 0.0024, 0.014), 1.3),
    FULL("Lowfat Milk", NARASIMHAN, (0.89187, 1.5136, 2.532), (0.002875, 0.00575, 0.0115),
         0.932, 0.902, 0.859, 1.33),
    FULL("Reduced Milk", NARASIMHAN, (2.4858, 3.1669, 4.5214), (0.0025556, 0.0051111, 0.012778),
         0.819, 0.797, 0.746, 1.33),
    FULL("Regular Milk", NARASIMHAN, (4.5513, 5.8294, 7.136), (0.0015333, 0.0046, 0.019933),
         0.75, 0.714, 0.681, 1.33),
    FULL("Espresso", NARASIMHAN, (0.72378, 0.84557, 1.0247), (4.7984, 6.5751, 8.8493),
         0.907, 0.896, 0.88, 1.33),
    FULL("Mint Mocha Coffee", NARASIMHAN, (0.31602, 0.38538, 0.48131), (3.772, 5.8228, 7.82),
         0.91, 0.907, 0.914, 1.33),
    FULL("Lowfat Soy Milk", NARASIMHAN, (0.30576, 0.34233, 0.61664), (0.0014375, 0.0071875, 0.035937),
         0.85, 0.853, 0.842, 1.33),
    FULL("Regular Soy Milk", NARASIMHAN, (0.59223, 0.73866, 1.4693), (0.0019167, 0.0095833, 0.065167),
         0.873, 0.858, 0.832, 1.33),
    FULL("Lowfat Chocolate Milk", NARASIMHAN, (0.64925, 0.83916, 1.1057), (0.0115, 0.0368, 0.1564),
         0.934, 0.927, 0.916, 1.33),
    FULL("Regular Chocolate Milk", NARASIMHAN, (1.4585, 2.1289, 2.9527), (0.010063, 0.043125, 0.14375),
         0.862, 0.838, 0.806, 1.33),
    FULL("Coke", NARASIMHAN, (8.9053e-05, 8.372e-05, 0), (0.10014, 0.16503, 0.2468),
         0.965, 0.972, 0, 1.33),
    FULL("Pepsi", NARASIMHAN, (6.1697e-05, 4.2564e-05, 0), (0.091641, 0.14158, 0.20729),
         0.926, 0.979, 0, 1.33),
    FULL("Sprite", NARASIMHAN, (6.0306e-06, 6.4139e-06, 6.5504e-06), (0.001886, 0.0018308, 0.0020025),
         0.943, 0.953, 0.952, 1.33),
    FULL("Gatorade", NARASIMHAN, (0.0024574, 0.003007, 0.0037325), (0.024794, 0.019289, 0.008878),
         0.933, 0.933, 0.935, 1.33),
    FULL("Chardonnay", NARASIMHAN, (1.7982e-05, 1.3758e-05, 1.2023e-05), (0.010782, 0.011855, 0.023997),
         0.914, 0.958, 0.975, 1.33),
    FULL("White Zinfandel", NARASIMHAN, (1.7501e-05, 1.9069e-05, 1.288e-05), (0.012072, 0.016184, 0.019843),
         0.919, 0.943, 0.972, 1.33),
    FULL("Merlot", NARASIMHAN, (2.1129e-05, 0, 0), (0.11632, 0.25191, 0.29434),
         0.974, 0, 0, 1.33),
    FULL("Budweiser Beer", NARASIMHAN, (2.4356e-05, 2.4079e-05, 1.0564e-05), (0.011492, 0.024911, 0.057786),
         0.917, 0.956, 0.982, 1.33),
    FULL("Coors Light Beer", NARASIMHAN, (5.0922e-05, 4.301e-05, 0), (0.006164, 0.013984, 0.034983),
         0.918, 0.966, 0, 1.33),
    FULL("Clorox", NARASIMHAN, (0.0024035, 0.0031373, 0.003991), (0.0033542, 0.014892, 0.026297),
         0.912, 0.905, 0.892, 1.33),
    FULL("Apple Juice", NARASIMHAN, (0.00013612, 0.00015836, 0.000227), (0.012957, 0.023741, 0.052184),
         0.947, 0.949, 0.945, 1.33),
    FULL("Cranberry Juice", NARASIMHAN, (0.00010402, 0.00011646, 7.8139e-05), (0.039437, 0.094223, 0.12426),
         0.947, 0.951, 0.974, 1.33),
    FULL("Grape Juice", NARASIMHAN, (5.382e-05, 0, 0), (0.10404, 0.23958, 0.29325),
         0.961, 0, 0, 1.33),
    FULL("Ruby Grapefruit Juice", NARASIMHAN, (0.011002, 0.010927, 0.011036), (0.085867, 0.18314, 0.25262),
         0.929, 0.929, 0.931, 1.33),
    FULL("White Grapefruit Juice", NARASIMHAN, (0.22826, 0.23998, 0.32748), (0.0138, 0.018831, 0.056781),
         0.548, 0.545, 0.565, 1.33),
    FULL("Shampoo", NARASIMHAN, (0.0007176, 0.0008303, 0.0009016), (0.014107, 0.045693, 0.061717),
         0.91, 0.905, 0.92, 1.33),
    FULL("Strawberry Shampoo", NARASIMHAN, (0.00015671, 0.00015947, 1.518e-05), (0.01449, 0.05796, 0.075823),
         0.927, 0.935, 0.994, 1.33),
    FULL("Head & Shoulders Shampoo", NARASIMHAN, (0.023805, 0.028804, 0.034306), (0.084621, 0.15688, 0.20365),
         0.911, 0.896, 0.884, 1.33),
    FULL("Lemon Tea Powder", NARASIMHAN, (0.040224, 0.045264, 0.051081), (2.4288, 4.5757, 7.2127),
         0.946, 0.946, 0.949, 1.33),
    FULL("Orange Powder", NARASIMHAN, (0.00015617, 0.00017482, 0.0001762), (0.001449, 0.003441, 0.007863),
         0.919, 0.918, 0.922, 1.33),
    FULL("Pink Lemonade Powder", NARASIMHAN, (0.00012103, 0.00013073, 0.00012528), (0.001165, 0.002366, 0.003195),
         0.902, 0.902, 0.904, 1.33),
    FULL("Cappuccino Powder", NARASIMHAN, (1.8436, 2.5851, 2.1662), (35.844, 49.547, 61.084),
         0.849, 0.843, 0.926, 1.33),
    FULL("Salt Powder", NARASIMHAN, (0.027333, 0.032451, 0.031979), (0.28415, 0.3257, 0.34148),
         0.802, 0.793, 0.821, 1.33),
    FULL("Sugar Powder", NARASIMHAN, (0.00022272, 0.00025513, 0.000271), (0.012638, 0.031051, 0.050124),
         0.921, 0.919, 0.931, 1.33),
    FULL("Suisse Mocha Powder", NARASIMHAN, (2.7979, 3.5452, 4.3365), (17.502, 27.004, 35.433),
         0.907, 0.894, 0.888, 1.33),
    FULL("Pacific Ocean Surface Water", NARASIMHAN, (0.0001764, 0.00032095, 0.00019617), (0.031845, 0.031324, 0.030147),
         0.902, 0.825, 0.914, 1.33),
    FULL("Mustard", GKIOULEKAS, (13.8977, 15.3293, 4.19059), (0.057, 0.061, 0.451),
         0.155, 0.173, 0.351, 1.3),
    FULL("Shampoo (Gkioulekas)", GKIOULEKAS, (0.754323, 1.17044, 1.33245), (0.178, 0.328, 0.439),
         0.907, 0.882, 0.874, 1.3),
    FULL("Mixed Soap", GKIOULEKAS, (2.62841, 2.7242, 2.97608), (0.003, 0.005, 0.013),
         0.33, 0.322, 0.316, 1.3),
    FULL("Glycerine Soap", GKIOULEKAS, (0.009045, 0.010302, 0.012597), (0.001, 0.001, 0.002),
         0.955, 0.949, 0.943, 1.3),
};
/* clang-format on */

uint32_t parian_media_preset_count(void)
{
    return (uint32_t)(sizeof presets / sizeof presets[0]);
}

const parian_medium *parian_media_preset(uint32_t index)
{
    return index < parian_media_preset_count() ? &presets[index] : NULL;
}

static char next_letter(const char **at)
{
    while (**at == ' ' || **at == '-' || **at == '_') {
        (*at)++;
    }
    char letter = (char)tolower((unsigned char)**at);
    *at += letter != '\0';
    return letter;
}

static bool same_name(const char *a, const char *b)
{
    for (;;) {
        char x = next_letter(&a), y = next_letter(&b);
        if (x != y || x == '\0') {
            return x == y;
        }
    }
}

const parian_medium *parian_media_find(const char *name)
{
    for (uint32_t i = 0; name && i < parian_media_preset_count(); i++) {
        const parian_medium *preset = parian_media_preset(i);
        if (same_name(name, preset->name)) {
            return preset;
        }
    }
    return NULL;
}
