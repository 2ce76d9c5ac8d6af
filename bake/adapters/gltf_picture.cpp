/* gltf_picture.cpp - decodes PNG and JPEG textures with stb_image.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_MAX_DIMENSIONS 16384
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <cstring>

#include "bake/adapters/gltf_parts.h"

namespace parian::gltf
{

constexpr int64_t pixel_max = 64 * 1024 * 1024;

bool decode_picture(const parian_env *env, byte_span bytes, parian_picture &picture,
                    std::string &reason)
{
    int width = 0, height = 0, channels = 0;
    if (bytes.size > INT32_MAX ||
        !stbi_info_from_memory(bytes.data, int(bytes.size), &width, &height, &channels)) {
        reason = "it is no PNG or JPEG";
        return false;
    }
    if (int64_t(width) * height > pixel_max) {
        reason = "it has more than 64 million pixels";
        return false;
    }
    stbi_uc *pixels =
        stbi_load_from_memory(bytes.data, int(bytes.size), &width, &height, &channels, 4);
    if (!pixels) {
        reason = std::string("stb_image: ") + stbi_failure_reason();
        return false;
    }
    size_t count = size_t(width) * size_t(height);
    void *copy = parian_alloc(env, count, 4);
    if (copy) {
        memcpy(copy, pixels, count * 4);
    }
    stbi_image_free(pixels);
    if (!copy) {
        throw std::bad_alloc();
    }
    picture.width = uint32_t(width);
    picture.height = uint32_t(height);
    picture.pixel = static_cast<uint8_t(*)[4]>(copy);
    return true;
}

} // namespace parian::gltf
