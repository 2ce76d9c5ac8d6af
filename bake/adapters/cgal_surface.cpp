/* cgal_surface.cpp - checks of a surface with CGAL.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/cgal_surface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include "bake/adapters/adapter_barrier.h"

namespace
{

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using surface_mesh = CGAL::Surface_mesh<kernel::Point_3>;
using face = surface_mesh::Face_index;

surface_mesh copy_in(const parian_mesh *mesh)
{
    surface_mesh out;
    out.reserve(mesh->vertex_count, mesh->vertex_count + mesh->triangle_count,
                mesh->triangle_count);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->position[v];
        out.add_vertex(kernel::Point_3(p[0], p[1], p[2]));
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        using vertex = surface_mesh::Vertex_index;
        const uint32_t *corner = mesh->triangle[t];
        if (out.add_face(vertex(corner[0]), vertex(corner[1]), vertex(corner[2])) ==
            surface_mesh::null_face()) {
            throw parian::failure(PARIAN_E_COMPUTE, "triangle " + std::to_string(t) +
                                                        " makes the surface non-manifold");
        }
    }
    return out;
}

struct enough {
};

/* An output iterator that counts and stops the search when it has seen enough. */
struct pair_counter {
    using iterator_category = std::output_iterator_tag;
    using value_type = void;
    using difference_type = void;
    using pointer = void;
    using reference = void;
    uint32_t *count;
    uint32_t maximum;
    pair_counter &operator=(const std::pair<face, face> &)
    {
        if (++*count >= maximum) {
            throw enough();
        }
        return *this;
    }
    pair_counter &operator*()
    {
        return *this;
    }
    pair_counter &operator++()
    {
        return *this;
    }
    pair_counter &operator++(int)
    {
        return *this;
    }
};

} // namespace

extern "C" parian_result parian_cgal_count_crossings(const parian_env *env, const parian_mesh *mesh,
                                                     uint32_t pair_max, uint32_t *pair_count)
{
    uint32_t count = 0;
    parian_result result = parian::guard(env, "CGAL, self-intersections", PARIAN_E_COMPUTE, [&] {
        surface_mesh surface = copy_in(mesh);
        try {
            CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(
                CGAL::faces(surface), surface, pair_counter{&count, pair_max});
        } catch (const enough &) {
            count = pair_max;
        }
        return PARIAN_OK;
    });
    if (result == PARIAN_OK) {
        *pair_count = count;
    }
    return result;
}
