/* gltf_material.cpp - reads glTF materials with their volume extensions, and base colour textures.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/gltf_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

namespace parian::gltf
{

namespace
{

constexpr uint64_t pixel_total_max = 256u * 1024u * 1024u;
constexpr size_t picture_file_max = size_t(1) << 30;

const tinygltf::Value *find_extension(const tinygltf::Material &material, const char *name)
{
    auto found = material.extensions.find(name);
    return found != material.extensions.end() && found->second.IsObject() ? &found->second
                                                                          : nullptr;
}

bool read_number(const tinygltf::Value *object, const char *key, double &value)
{
    if (!object || !object->Has(key) || !object->Get(key).IsNumber()) {
        return false;
    }
    value = object->Get(key).GetNumberAsDouble();
    return true;
}

bool read_color(const tinygltf::Value *object, const char *key, double (&color)[3])
{
    if (!object || !object->Has(key)) {
        return false;
    }
    const tinygltf::Value &value = object->Get(key);
    if (!value.IsArray() || value.ArrayLen() < 3) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        if (!value.Get(k).IsNumber()) {
            return false;
        }
    }
    for (int k = 0; k < 3; k++) {
        color[k] = value.Get(k).GetNumberAsDouble();
    }
    return true;
}

void fill(double (&color)[3], double value)
{
    color[0] = color[1] = color[2] = value;
}

void read_volume(const tinygltf::Material &source, parian_source_material &material)
{
    const tinygltf::Value *volume = find_extension(source, "KHR_materials_volume");
    material.has_volume = volume != nullptr;
    material.attenuation_distance = std::numeric_limits<double>::infinity();
    fill(material.attenuation_color, 1);
    read_number(volume, "attenuationDistance", material.attenuation_distance);
    read_color(volume, "attenuationColor", material.attenuation_color);
    material.ior = 1.5;
    read_number(find_extension(source, "KHR_materials_ior"), "ior", material.ior);
}

/* Both drafts and every spelling. The strength scales the multiple-scattering albedo: none is 1. */
void read_scatter(const tinygltf::Material &source, parian_source_material &material)
{
    const tinygltf::Value *unified = find_extension(source, "KHR_materials_scatter");
    const tinygltf::Value *volume = find_extension(source, "KHR_materials_volume_scatter");
    const tinygltf::Value *scatter = unified ? unified : volume;
    material.has_scatter = scatter != nullptr;
    material.new_draft = unified != nullptr;
    fill(material.multiscatter_color, unified ? 1 : 0);
    if (!read_color(scatter, "multiscatterColorFactor", material.multiscatter_color)) {
        read_color(scatter, "multiscatterColor", material.multiscatter_color);
    }
    double strength = 1;
    if (!read_number(scatter, "scatterStrengthFactor", strength)) {
        read_number(scatter, "scatterFactor", strength);
    }
    for (double &channel : material.multiscatter_color) {
        channel *= strength;
    }
    read_number(scatter, "scatterAnisotropy", material.scatter_anisotropy);
}

int hex_digit(char letter)
{
    return letter >= '0' && letter <= '9'   ? letter - '0'
           : letter >= 'a' && letter <= 'f' ? letter - 'a' + 10
           : letter >= 'A' && letter <= 'F' ? letter - 'A' + 10
                                            : -1;
}

std::string decode_uri(const std::string &uri)
{
    std::string out;
    for (size_t i = 0; i < uri.size(); i++) {
        int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        if (uri[i] == '%' && low >= 0) {
            out.push_back(char(high * 16 + low));
            i += 2;
        } else {
            out.push_back(uri[i]);
        }
    }
    return out;
}

/* The bytes of an image that is no buffer view; false where they cannot be had. */
bool fetch(const document &file, const std::string &uri, std::vector<unsigned char> &bytes)
{
    if (uri.compare(0, 5, "data:") == 0) {
        std::string type;
        return tinygltf::DecodeDataURI(&bytes, type, uri, 0, false);
    }
    std::string path = decode_uri(uri);
    path = !path.empty() && path[0] == '/' ? path : file.folder + "/" + path;
    FILE *stream = fopen(path.c_str(), "rb");
    if (!stream) {
        return false;
    }
    unsigned char block[65536];
    size_t got;
    while ((got = fread(block, 1, sizeof block, stream)) > 0 && bytes.size() < picture_file_max) {
        bytes.insert(bytes.end(), block, block + got);
    }
    fclose(stream);
    return !bytes.empty();
}

} // namespace

void copy_name(char (&target)[PARIAN_NAME_MAX], const std::string &name)
{
    size_t length = std::min(name.size(), size_t(PARIAN_NAME_MAX - 1));
    while (length > 0 && length < name.size() && (name[length] & 0xC0) == 0x80) {
        length--; /* not inside a UTF-8 character */
    }
    memset(target, 0, sizeof target);
    memcpy(target, name.data(), length);
}

parian_source_material read_material(const tinygltf::Model &model, size_t index)
{
    const tinygltf::Material &source = model.materials[index];
    parian_source_material material = {};
    copy_name(material.name,
              source.name.empty() ? "material " + std::to_string(index) : source.name);
    for (size_t k = 0; k < 4; k++) {
        const std::vector<double> &factor = source.pbrMetallicRoughness.baseColorFactor;
        material.base_color[k] =
            k < factor.size() && std::isfinite(factor[k]) ? float(factor[k]) : 1.0f;
    }
    material.base_color_picture = -1;
    read_volume(source, material);
    read_scatter(source, material);
    return material;
}

picture_table::picture_table(const parian_env *env, const document &file)
    : env_(env), file_(file), known_(file.images.size(), -2)
{
}

picture_table::~picture_table()
{
    for (parian_picture &picture : pictures_) {
        parian_free(env_, picture.pixel);
    }
}

int32_t picture_table::find(size_t material)
{
    const tinygltf::Model &model = file_.model;
    int texture = model.materials[material].pbrMetallicRoughness.baseColorTexture.index;
    if (texture < 0) {
        return -1;
    }
    int image =
        size_t(texture) < model.textures.size() ? model.textures[size_t(texture)].source : -1;
    if (image < 0 || size_t(image) >= file_.images.size()) {
        parian_log(env_, PARIAN_LOG_WARNING,
                   "%s: texture %d has no picture that is known here: left out", file_.path.c_str(),
                   texture);
        return -1;
    }
    if (known_[size_t(image)] == -2) {
        known_[size_t(image)] = load(image);
    }
    return known_[size_t(image)];
}

int32_t picture_table::load(int image)
{
    const image_source &source = file_.images[size_t(image)];
    std::vector<unsigned char> bytes;
    byte_span span{nullptr, 0};
    std::string reason;
    parian_picture picture = {};
    bool loaded = false;
    if (source.buffer_view >= 0) {
        span = view_bytes(file_.model, source.buffer_view, "image " + std::to_string(image));
    } else if (fetch(file_, source.uri, bytes)) {
        span = {bytes.data(), bytes.size()};
    } else {
        reason = "it cannot be read";
    }
    if (reason.empty()) {
        loaded = decode_picture(env_, span, picture, reason);
    }
    if (loaded) {
        pictures_.push_back(picture);
        pixel_total_ += uint64_t(picture.width) * picture.height;
        if (pixel_total_ > pixel_total_max) {
            throw failure(PARIAN_E_LIMIT, "textures of more than 256 million pixels together");
        }
        return int32_t(pictures_.size()) - 1;
    }
    std::string name = source.uri.compare(0, 5, "data:") == 0 ? "(data)" : source.uri.substr(0, 80);
    parian_log(env_, PARIAN_LOG_WARNING, "%s: image %d %s is left out: %s", file_.path.c_str(),
               image, name.c_str(), reason.c_str());
    return -1;
}

void picture_table::release(parian_source_scene &scene)
{
    scene.pictures = new_array<parian_picture>(env_, pictures_.size());
    std::copy(pictures_.begin(), pictures_.end(), scene.pictures);
    scene.picture_count = uint32_t(pictures_.size());
    pictures_.clear();
}

} // namespace parian::gltf
