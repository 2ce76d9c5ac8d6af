/* gltf_mesh.cpp - reads the accessors of a glTF primitive, every one checked against its buffer.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/gltf_parts.h"

#include <cmath>
#include <cstring>

namespace parian::gltf
{

namespace
{

constexpr size_t count_max = size_t(1) << 30;

/* A run of equally spaced elements inside a buffer view. */
struct element_run {
    const uint8_t *data;
    size_t stride;
};

size_t component_size(int type, const std::string &where)
{
    int size = tinygltf::GetComponentSizeInBytes(uint32_t(type));
    if (size <= 0 || size > 8) {
        throw failure(PARIAN_E_FORMAT, where + ": unknown component type " + std::to_string(type));
    }
    return size_t(size);
}

element_run locate(const tinygltf::Model &model, int view, size_t offset, size_t stride,
                   size_t element, size_t count, const std::string &where)
{
    byte_span bytes = view_bytes(model, view, where);
    stride = stride ? stride : element;
    bool fits = count == 0 || (element <= bytes.size && offset <= bytes.size - element &&
                               (count - 1) <= (bytes.size - element - offset) / stride);
    if (!fits) {
        throw failure(PARIAN_E_FORMAT, where + ": " + std::to_string(count) + " elements of " +
                                           std::to_string(stride) + " bytes from byte " +
                                           std::to_string(offset) + " do not fit a bufferView of " +
                                           std::to_string(bytes.size) + " bytes");
    }
    return {bytes.data + offset, stride};
}

template <class Type> double load_as(const uint8_t *at)
{
    Type value;
    memcpy(&value, at, sizeof value);
    return double(value);
}

double load_component(const uint8_t *at, int type, bool normalized)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return normalized ? std::fmax(load_as<int8_t>(at) / 127, -1) : load_as<int8_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return load_as<uint8_t>(at) / (normalized ? 255 : 1);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return normalized ? std::fmax(load_as<int16_t>(at) / 32767, -1) : load_as<int16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load_as<uint16_t>(at) / (normalized ? 65535 : 1);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return load_as<uint32_t>(at);
    case TINYGLTF_COMPONENT_TYPE_INT:
        return load_as<int32_t>(at);
    case TINYGLTF_COMPONENT_TYPE_DOUBLE:
        return load_as<double>(at);
    default:
        return load_as<float>(at);
    }
}

const tinygltf::Accessor &find_accessor(const tinygltf::Model &model, int index, size_t components,
                                        const std::string &where)
{
    if (index < 0 || size_t(index) >= model.accessors.size()) {
        throw failure(PARIAN_E_FORMAT, where + " names accessor " + std::to_string(index) + " of " +
                                           std::to_string(model.accessors.size()));
    }
    const tinygltf::Accessor &accessor = model.accessors[size_t(index)];
    int found = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
    if (found != int(components)) {
        throw failure(PARIAN_E_FORMAT, where + ": an accessor of " + std::to_string(found) +
                                           " components, expected " + std::to_string(components));
    }
    if (accessor.count > count_max) {
        throw failure(PARIAN_E_LIMIT, where + ": " + std::to_string(accessor.count) +
                                          " elements, expected at most 2^30");
    }
    return accessor;
}

template <class Scalar, size_t N>
void apply_sparse(const tinygltf::Model &model, const tinygltf::Accessor &accessor,
                  const std::string &where, std::vector<std::array<Scalar, N>> &out)
{
    const auto &sparse = accessor.sparse;
    if (sparse.count < 0 || size_t(sparse.count) > accessor.count ||
        sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
        throw failure(PARIAN_E_FORMAT, where + ": a sparse count of " +
                                           std::to_string(sparse.count) + " among " +
                                           std::to_string(accessor.count));
    }
    size_t count = size_t(sparse.count), size = component_size(accessor.componentType, where);
    element_run indices =
        locate(model, sparse.indices.bufferView, size_t(sparse.indices.byteOffset), 0,
               component_size(sparse.indices.componentType, where), count, where);
    element_run values = locate(model, sparse.values.bufferView, size_t(sparse.values.byteOffset),
                                0, size * N, count, where);
    for (size_t i = 0; i < count; i++) {
        double index =
            load_component(indices.data + i * indices.stride, sparse.indices.componentType, false);
        if (!(index >= 0 && index < double(out.size()))) {
            throw failure(PARIAN_E_FORMAT, where + ": a sparse index behind the last element");
        }
        for (size_t k = 0; k < N; k++) {
            out[size_t(index)][k] =
                Scalar(load_component(values.data + i * values.stride + k * size,
                                      accessor.componentType, accessor.normalized));
        }
    }
}

template <class Scalar, size_t N>
void read_vectors(const tinygltf::Model &model, int index, const std::string &where,
                  std::vector<std::array<Scalar, N>> &out)
{
    const tinygltf::Accessor &accessor = find_accessor(model, index, N, where);
    size_t size = component_size(accessor.componentType, where);
    if (accessor.bufferView < 0 && !accessor.sparse.isSparse) {
        throw failure(PARIAN_E_FORMAT, where + ": an accessor without a bufferView");
    }
    if (accessor.bufferView >= 0) {
        size_t stride = size_t(accessor.bufferView) < model.bufferViews.size()
                            ? model.bufferViews[size_t(accessor.bufferView)].byteStride
                            : 0;
        element_run run = locate(model, accessor.bufferView, accessor.byteOffset, stride, size * N,
                                 accessor.count, where);
        out.resize(accessor.count);
        for (size_t i = 0; i < accessor.count; i++) {
            for (size_t k = 0; k < N; k++) {
                out[i][k] = Scalar(load_component(run.data + i * run.stride + k * size,
                                                  accessor.componentType, accessor.normalized));
            }
        }
    } else if (accessor.count > (size_t(1) << 24)) {
        throw failure(PARIAN_E_LIMIT, where + ": a sparse accessor of more than 2^24 elements");
    } else {
        out.assign(accessor.count, {});
    }
    if (accessor.sparse.isSparse) {
        apply_sparse(model, accessor, where, out);
    }
}

std::vector<uint32_t> read_indices(const tinygltf::Model &model, int index, size_t vertex_count,
                                   const std::string &where)
{
    std::vector<std::array<double, 1>> numbers;
    read_vectors(model, index, where, numbers);
    std::vector<uint32_t> indices(numbers.size());
    for (size_t i = 0; i < numbers.size(); i++) {
        double number = numbers[i][0];
        if (!(number >= 0 && number < double(vertex_count)) || number != std::floor(number)) {
            throw failure(PARIAN_E_FORMAT, where + ": index " + std::to_string(i) +
                                               " names vertex " + std::to_string(int64_t(number)) +
                                               " of " + std::to_string(vertex_count));
        }
        indices[i] = uint32_t(number);
    }
    return indices;
}

void make_triangles(const std::vector<uint32_t> &index, int mode, primitive &out)
{
    size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
    for (size_t i = 0; i + 2 < index.size(); i += step) {
        bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
        if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            out.triangle.push_back({index[0], index[i + 1], index[i + 2]});
        } else {
            out.triangle.push_back({index[i], index[i + 1 + odd], index[i + 2 - odd]});
        }
    }
}

int attribute_id(const tinygltf::Value &attributes, const std::string &name)
{
    if (!attributes.IsObject() || !attributes.Has(name) || !attributes.Get(name).IsNumber()) {
        return -1;
    }
    return attributes.Get(name).GetNumberAsInt();
}

void read_draco(const document &file, const tinygltf::Value &extension, const std::string &uv_name,
                const std::string &where, primitive &out)
{
    if (!extension.IsObject() || !extension.Has("bufferView") ||
        !extension.Get("bufferView").IsNumber() || !extension.Has("attributes")) {
        throw failure(PARIAN_E_FORMAT,
                      where + ": a Draco extension without bufferView and attributes");
    }
    const tinygltf::Value &attributes = extension.Get("attributes");
    draco_ids ids;
    ids.position = attribute_id(attributes, "POSITION");
    ids.normal = attribute_id(attributes, "NORMAL");
    ids.uv = attribute_id(attributes, uv_name);
    decode_draco(view_bytes(file.model, extension.Get("bufferView").GetNumberAsInt(), where), ids,
                 where, out);
}

void read_plain(const document &file, const tinygltf::Primitive &source, const std::string &uv_name,
                const std::string &where, primitive &out)
{
    auto attribute = [&](const std::string &name) {
        auto found = source.attributes.find(name);
        return found == source.attributes.end() ? -1 : found->second;
    };
    if (attribute("POSITION") < 0) {
        throw failure(PARIAN_E_FORMAT, where + " has no POSITION");
    }
    read_vectors(file.model, attribute("POSITION"), where + " POSITION", out.position);
    if (attribute("NORMAL") >= 0) {
        read_vectors(file.model, attribute("NORMAL"), where + " NORMAL", out.normal);
    }
    if (attribute(uv_name) >= 0) {
        read_vectors(file.model, attribute(uv_name), where + " " + uv_name, out.uv);
    }
    std::vector<uint32_t> index;
    if (source.indices >= 0) {
        index = read_indices(file.model, source.indices, out.position.size(), where + " indices");
    } else {
        for (size_t i = 0; i < out.position.size(); i++) {
            index.push_back(uint32_t(i));
        }
    }
    make_triangles(index, source.mode, out);
}

} // namespace

bool read_primitive(const document &file, const tinygltf::Primitive &source, int uv_set,
                    const std::string &where, primitive &out)
{
    int mode = source.mode < 0 ? TINYGLTF_MODE_TRIANGLES : source.mode;
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
        mode != TINYGLTF_MODE_TRIANGLE_FAN) {
        return false;
    }
    std::string uv_name = "TEXCOORD_" + std::to_string(uv_set);
    auto draco = source.extensions.find("KHR_draco_mesh_compression");
    if (draco != source.extensions.end()) {
        read_draco(file, draco->second, uv_name, where, out);
    } else {
        tinygltf::Primitive plain = source;
        plain.mode = mode;
        read_plain(file, plain, uv_name, where, out);
    }
    for (size_t i = 0; i < out.position.size(); i++) {
        for (double x : out.position[i]) {
            if (!std::isfinite(x)) {
                throw failure(PARIAN_E_FORMAT, where + ": vertex " + std::to_string(i) +
                                                   " has a coordinate that is not finite");
            }
        }
    }
    bool paired = (out.normal.empty() || out.normal.size() >= out.position.size()) &&
                  (out.uv.empty() || out.uv.size() >= out.position.size());
    if (!paired) {
        throw failure(PARIAN_E_FORMAT,
                      where + ": fewer normals or texture coordinates than positions");
    }
    return true;
}

} // namespace parian::gltf
