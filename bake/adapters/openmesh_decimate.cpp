/* openmesh_decimate.cpp - simplification of a triangle mesh by quadric errors, by OpenMesh's
 * decimater.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/openmesh_decimate.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <string>

#include "bake/adapters/adapter_barrier.h"

namespace
{

struct traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using surface = OpenMesh::TriMesh_ArrayKernelT<traits>;

void copy_in(const parian_mesh *from, const bool *locked, surface &to)
{
    to.reserve(from->vertex_count, 3 * size_t(from->triangle_count) / 2, from->triangle_count);
    to.request_vertex_status();
    to.request_edge_status();
    to.request_face_status();
    to.request_face_normals();
    for (uint32_t v = 0; v < from->vertex_count; v++) {
        const double *p = from->position[v];
        auto handle = to.add_vertex(OpenMesh::Vec3d(p[0], p[1], p[2]));
        to.status(handle).set_locked(locked[v]);
    }
    for (uint32_t t = 0; t < from->triangle_count; t++) {
        const uint32_t *c = from->triangle[t];
        auto handle =
            to.add_face(to.vertex_handle(c[0]), to.vertex_handle(c[1]), to.vertex_handle(c[2]));
        if (!handle.is_valid()) {
            throw parian::failure(PARIAN_E_COMPUTE,
                                  "triangle " + std::to_string(t) +
                                      " does not fit: expected an oriented 2-manifold");
        }
    }
    to.update_face_normals();
}

void decimate(surface &mesh, uint32_t vertex_target)
{
    using namespace OpenMesh::Decimater;
    DecimaterT<surface> decimater(mesh);
    ModQuadricT<surface>::Handle quadric;
    ModNormalFlippingT<surface>::Handle flipping;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    decimater.add(flipping);
    decimater.module(flipping).set_max_normal_deviation(45.0f);
    decimater.initialize();
    decimater.decimate_to(vertex_target);
}

void copy_out(const surface &from, parian_mesh *to)
{
    to->triangle_count = 0;
    for (auto face : from.all_faces()) {
        if (from.status(face).deleted()) {
            continue;
        }
        uint32_t *out = to->triangle[to->triangle_count++];
        for (auto v : from.fv_range(face)) {
            *out++ = uint32_t(v.idx());
        }
    }
}

} // namespace

parian_result parian_decimate(const parian_env *env, parian_mesh *mesh, const bool *locked,
                              uint32_t vertex_target)
{
    return parian::guard(env, "OpenMesh decimation", PARIAN_E_COMPUTE, [&] {
        surface work;
        copy_in(mesh, locked, work);
        decimate(work, vertex_target);
        copy_out(work, mesh);
        return PARIAN_OK;
    });
}
