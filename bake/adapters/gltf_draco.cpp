/* gltf_draco.cpp - decodes Draco-compressed primitives with the Draco library.
 *
 * tinygltf has a decoder of its own, but it uses attribute and view numbers of the file unchecked.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/gltf_parts.h"

#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>

namespace parian::gltf
{

namespace
{

template <size_t N, class Scalar>
void read_attribute(const draco::Mesh &mesh, int id, const char *name, const std::string &where,
                    std::vector<std::array<Scalar, N>> &out)
{
    const draco::PointAttribute *attribute = mesh.GetAttributeByUniqueId(uint32_t(id));
    if (id < 0 || !attribute || attribute->num_components() != int(N)) {
        throw failure(PARIAN_E_FORMAT, where + ": the Draco mesh has no " + name + " attribute " +
                                           std::to_string(id) + " of " + std::to_string(N) +
                                           " components");
    }
    out.resize(mesh.num_points());
    for (uint32_t i = 0; i < mesh.num_points(); i++) {
        draco::AttributeValueIndex index = attribute->mapped_index(draco::PointIndex(i));
        if (index.value() >= attribute->size() ||
            !attribute->ConvertValue<Scalar, N>(index, out[i].data())) {
            throw failure(PARIAN_E_FORMAT,
                          where + ": the Draco mesh's " + name + " cannot be read");
        }
    }
}

} // namespace

void decode_draco(byte_span bytes, const draco_ids &ids, const std::string &where, primitive &out)
{
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char *>(bytes.data), bytes.size);
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok() || !decoded.value()) {
        throw failure(PARIAN_E_FORMAT, where + ": Draco: " + decoded.status().error_msg_string());
    }
    const draco::Mesh &mesh = *decoded.value();
    read_attribute<3>(mesh, ids.position, "POSITION", where, out.position);
    if (ids.normal >= 0) {
        read_attribute<3>(mesh, ids.normal, "NORMAL", where, out.normal);
    }
    if (ids.uv >= 0) {
        read_attribute<2>(mesh, ids.uv, "TEXCOORD", where, out.uv);
    }
    for (uint32_t f = 0; f < mesh.num_faces(); f++) {
        const draco::Mesh::Face &face = mesh.face(draco::FaceIndex(f));
        out.triangle.push_back({face[0].value(), face[1].value(), face[2].value()});
    }
}

} // namespace parian::gltf
