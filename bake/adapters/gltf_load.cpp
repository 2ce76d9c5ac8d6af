/* gltf_load.cpp - checks a glTF file's container and document, then parses it with tinygltf.
 *
 * tinygltf trusts indices and offsets in many places, so what it is handed is checked before:
 * nesting, required extensions, buffer views. Pictures are taken out of the document: a texture
 * that is missing must not fail the model, and they are decoded only where a base colour needs
 * them.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#define TINYGLTF_IMPLEMENTATION
#include "bake/adapters/gltf_parts.h"

#include <cstring>

namespace parian::gltf
{

namespace
{

using nlohmann::json;

enum { NESTING_MAX = 128, GLB_HEADER = 12, CHUNK_HEADER = 8 };

constexpr uint32_t glb_magic = 0x46546C67, chunk_json = 0x4E4F534A, chunk_bin = 0x004E4942;

uint32_t read_u32(const uint8_t *at)
{
    return at[0] | uint32_t(at[1]) << 8 | uint32_t(at[2]) << 16 | uint32_t(at[3]) << 24;
}

[[noreturn]] void refuse(const std::string &line)
{
    throw failure(PARIAN_E_FORMAT, line);
}

struct container {
    byte_span text{nullptr, 0}, binary{nullptr, 0};
};

byte_span read_chunk(const uint8_t *data, size_t size, size_t &at, uint32_t kind, const char *name)
{
    if (size - at < CHUNK_HEADER) {
        refuse(std::string("the file ends before its ") + name + " chunk");
    }
    size_t length = read_u32(data + at);
    if (read_u32(data + at + 4) != kind) {
        refuse(std::string("expected a ") + name + " chunk at byte " + std::to_string(at));
    }
    at += CHUNK_HEADER;
    if (length > size - at) {
        refuse(std::string("the ") + name + " chunk is " + std::to_string(length) +
               " bytes, but only " + std::to_string(size - at) + " follow: the file is cut short");
    }
    byte_span chunk{data + at, length};
    at += std::min(size - at, (length + 3) / 4 * 4);
    return chunk;
}

container open_glb(const uint8_t *data, size_t size)
{
    if (size < GLB_HEADER) {
        refuse("a GLB of " + std::to_string(size) + " bytes, expected at least 12");
    }
    if (read_u32(data + 4) != 2) {
        throw failure(PARIAN_E_UNSUPPORTED,
                      "GLB version " + std::to_string(read_u32(data + 4)) + ", expected 2");
    }
    size_t length = read_u32(data + 8);
    if (length > size) {
        refuse("the header announces " + std::to_string(length) + " bytes, the file has " +
               std::to_string(size) + ": it is cut short");
    }
    container found;
    size_t at = GLB_HEADER;
    found.text = read_chunk(data, length < GLB_HEADER ? size : length, at, chunk_json, "JSON");
    if (at < length) {
        found.binary = read_chunk(data, length, at, chunk_bin, "BIN");
    }
    return found;
}

/* tinygltf walks the document recursively: bound its depth. */
void check_nesting(byte_span text)
{
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < text.size; i++) {
        uint8_t c = text.data[i];
        if (quoted) {
            i += c == '\\';
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > NESTING_MAX) {
                refuse("JSON nested deeper than " + std::to_string(int(NESTING_MAX)));
            }
        } else if (c == '}' || c == ']') {
            depth--;
        }
    }
}

const char *const known_extensions[] = {
    "KHR_draco_mesh_compression", "KHR_mesh_quantization", "KHR_materials_volume",
    "KHR_materials_scatter", "KHR_materials_volume_scatter", "KHR_materials_ior",
    "KHR_materials_transmission", "KHR_materials_diffuse_transmission", "KHR_materials_dispersion",
    "KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_variants",
    /* appearance that a bake does not use */
    "KHR_materials_specular", "KHR_materials_clearcoat", "KHR_materials_sheen",
    "KHR_materials_iridescence", "KHR_materials_anisotropy", "KHR_materials_emissive_strength",
    "KHR_materials_unlit"};

void check_extensions(const parian_env *env, const char *path, const json &root)
{
    for (const char *list : {"extensionsRequired", "extensionsUsed"}) {
        if (!root.contains(list) || !root[list].is_array()) {
            continue;
        }
        for (const json &entry : root[list]) {
            std::string name = entry.is_string() ? entry.get<std::string>() : "?";
            bool known = false;
            for (const char *candidate : known_extensions) {
                known = known || name == candidate;
            }
            if (!known && strcmp(list, "extensionsRequired") == 0) {
                throw failure(PARIAN_E_UNSUPPORTED,
                              "the required extension " + name + " is not supported");
            }
            if (name == "KHR_texture_transform" && strcmp(list, "extensionsUsed") == 0) {
                parian_log(env, PARIAN_LOG_WARNING,
                           "%s: KHR_texture_transform is not applied; textures may be shifted",
                           path);
            }
        }
    }
}

/* A member that is a whole number in [0, 2^53), or the fallback where it is absent. */
uint64_t whole(const json &object, const char *key, uint64_t fallback, const std::string &where)
{
    if (!object.is_object()) {
        refuse(where + " is not an object");
    }
    auto found = object.find(key);
    if (found == object.end()) {
        return fallback;
    }
    if (!found->is_number() || !(found->get<double>() >= 0) || found->get<double>() > 9e15) {
        refuse(where + ": " + key + " is not a whole number");
    }
    return static_cast<uint64_t>(found->get<double>());
}

void check_views(const json &root)
{
    const json none = json::array();
    const json &buffers = root.contains("buffers") ? root["buffers"] : none;
    const json &views = root.contains("bufferViews") ? root["bufferViews"] : none;
    if (!buffers.is_array() || !views.is_array()) {
        refuse("buffers or bufferViews is not an array");
    }
    for (size_t i = 0; i < views.size(); i++) {
        std::string where = "bufferView " + std::to_string(i);
        uint64_t buffer = whole(views[i], "buffer", UINT64_MAX, where);
        uint64_t offset = whole(views[i], "byteOffset", 0, where);
        uint64_t length = whole(views[i], "byteLength", 0, where);
        uint64_t stride = whole(views[i], "byteStride", 0, where);
        if (buffer >= buffers.size()) {
            refuse(where + " names buffer " + std::to_string(buffer) + " of " +
                   std::to_string(buffers.size()));
        }
        uint64_t room = whole(buffers[buffer], "byteLength", 0, "buffer " + std::to_string(buffer));
        if (length > room || offset > room - length || stride > 65536) {
            refuse(where + " spans bytes " + std::to_string(offset) + " to " +
                   std::to_string(offset + length) + " of a buffer of " + std::to_string(room));
        }
    }
}

/* tinygltf drops a primitive without attributes in silence, and wants a buffer view for the indices
 * of a Draco primitive, which needs none: its triangles come from the compressed mesh. */
void check_primitives(json &root)
{
    if (!root.contains("meshes") || !root["meshes"].is_array()) {
        return;
    }
    for (json &mesh : root["meshes"]) {
        if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) {
            refuse("a mesh without primitives");
        }
        for (json &primitive : mesh["primitives"]) {
            if (!primitive.is_object() || !primitive.contains("attributes") ||
                !primitive["attributes"].is_object()) {
                refuse("a primitive without attributes");
            }
            if (primitive.contains("extensions") && primitive["extensions"].is_object() &&
                primitive["extensions"].contains("KHR_draco_mesh_compression")) {
                primitive.erase("indices");
            }
        }
    }
}

std::vector<image_source> take_images(json &root)
{
    std::vector<image_source> images;
    if (root.contains("images") && root["images"].is_array()) {
        for (const json &entry : root["images"]) {
            image_source source;
            if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string()) {
                source.uri = entry["uri"].get<std::string>();
            } else if (entry.is_object() && entry.contains("bufferView") &&
                       entry["bufferView"].is_number_unsigned()) {
                source.buffer_view = static_cast<int>(
                    std::min<uint64_t>(entry["bufferView"].get<uint64_t>(), INT32_MAX));
            }
            images.push_back(source);
        }
    }
    for (const char *unused : {"images", "animations", "skins", "cameras"}) {
        root.erase(unused);
    }
    return images;
}

std::vector<uint8_t> write_glb(const std::string &text, byte_span binary)
{
    std::vector<uint8_t> out;
    auto put = [&](uint32_t value) {
        for (int k = 0; k < 4; k++) {
            out.push_back(uint8_t(value >> (8 * k)));
        }
    };
    size_t text_size = (text.size() + 3) / 4 * 4, binary_size = (binary.size + 3) / 4 * 4;
    put(glb_magic);
    put(2);
    put(uint32_t(GLB_HEADER + CHUNK_HEADER + text_size +
                 (binary.size ? CHUNK_HEADER + binary_size : 0)));
    put(uint32_t(text_size));
    put(chunk_json);
    out.insert(out.end(), text.begin(), text.end());
    out.resize(GLB_HEADER + CHUNK_HEADER + text_size, ' ');
    if (binary.size) {
        put(uint32_t(binary_size));
        put(chunk_bin);
        out.insert(out.end(), binary.data, binary.data + binary.size);
        out.resize(out.size() + binary_size - binary.size, 0);
    }
    return out;
}

std::string first_line(const std::string &text)
{
    return text.substr(0, text.find('\n'));
}

void parse(const json &root, byte_span binary, document &file)
{
    tinygltf::TinyGLTF parser;
    std::string error, warning;
    std::string text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    bool parsed;
    if (binary.size) {
        std::vector<uint8_t> glb = write_glb(text, binary);
        if (glb.size() > UINT32_MAX) {
            throw failure(PARIAN_E_LIMIT, "a GLB of more than 4 GiB");
        }
        parsed = parser.LoadBinaryFromMemory(&file.model, &error, &warning, glb.data(),
                                             unsigned(glb.size()), file.folder);
    } else {
        parsed = parser.LoadASCIIFromString(&file.model, &error, &warning, text.data(),
                                            unsigned(text.size()), file.folder);
    }
    if (!parsed) {
        refuse("tinygltf: " + first_line(error.empty() ? "cannot read this file" : error));
    }
}

} // namespace

byte_span view_bytes(const tinygltf::Model &model, int view, const std::string &where)
{
    if (view < 0 || size_t(view) >= model.bufferViews.size()) {
        refuse(where + " names bufferView " + std::to_string(view) + " of " +
               std::to_string(model.bufferViews.size()));
    }
    const tinygltf::BufferView &found = model.bufferViews[size_t(view)];
    if (found.buffer < 0 || size_t(found.buffer) >= model.buffers.size()) {
        refuse(where + ": bufferView " + std::to_string(view) + " has no buffer");
    }
    const std::vector<unsigned char> &bytes = model.buffers[size_t(found.buffer)].data;
    if (found.byteLength > bytes.size() || found.byteOffset > bytes.size() - found.byteLength) {
        refuse(where + ": bufferView " + std::to_string(view) + " ends behind its buffer of " +
               std::to_string(bytes.size()) + " bytes");
    }
    return {bytes.data() + found.byteOffset, found.byteLength};
}

void load(const parian_env *env, const char *path, const uint8_t *data, size_t size, document &file)
{
    file.path = path;
    size_t slash = file.path.rfind('/');
    file.folder = slash == std::string::npos ? "." : file.path.substr(0, slash + 1);
    container found;
    if (size >= 4 && read_u32(data) == glb_magic) {
        found = open_glb(data, size);
    } else {
        found.text = {data, size};
    }
    check_nesting(found.text);
    json root = json::parse(found.text.data, found.text.data + found.text.size);
    if (!root.is_object()) {
        refuse("the document is not a JSON object");
    }
    check_extensions(env, path, root);
    check_views(root);
    check_primitives(root);
    file.images = take_images(root);
    parse(root, found.binary, file);
}

} // namespace parian::gltf
