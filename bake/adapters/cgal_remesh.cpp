/* cgal_remesh.cpp - isotropic remeshing of a triangle mesh, by CGAL's Polygon Mesh Processing.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/cgal_remesh.h"

#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bake/adapters/adapter_barrier.h"

namespace
{

namespace pmp = CGAL::Polygon_mesh_processing;
using kernel = CGAL::Simple_cartesian<double>;
using surface = CGAL::Surface_mesh<kernel::Point_3>;
using vertex = surface::Vertex_index;
using edge = surface::Edge_index;
using halfedge = surface::Halfedge_index;
using edge_flags = surface::Property_map<edge, bool>;
using vertex_flags = surface::Property_map<vertex, bool>;

enum kind : char { KIND_UNKNOWN, KIND_SHARP, KIND_ROUNDED };
using edge_kinds = surface::Property_map<edge, char>;

} // namespace

struct parian_remesher {
    surface mesh;
    edge_flags feature;
    edge_kinds kind;     /* of the features; unknown for those that a round has made */
    vertex_flags corner; /* where features meet, end or turn */
};

namespace
{

void copy_in(const parian_mesh *from, surface &to)
{
    to.reserve(from->vertex_count, 3 * size_t(from->triangle_count) / 2, from->triangle_count);
    for (uint32_t v = 0; v < from->vertex_count; v++) {
        const double *p = from->position[v];
        to.add_vertex(kernel::Point_3(p[0], p[1], p[2]));
    }
    for (uint32_t t = 0; t < from->triangle_count; t++) {
        const uint32_t *c = from->triangle[t];
        if (to.add_face(vertex(c[0]), vertex(c[1]), vertex(c[2])) == surface::null_face()) {
            throw parian::failure(PARIAN_E_COMPUTE,
                                  "triangle " + std::to_string(t) +
                                      " does not fit: expected an oriented 2-manifold");
        }
    }
    for (vertex v : to.vertices()) {
        if (to.is_isolated(v)) {
            to.remove_vertex(v);
        }
    }
    to.collect_garbage();
}

double edge_length(const surface &mesh, edge e)
{
    return std::sqrt(
        CGAL::squared_distance(mesh.point(mesh.vertex(e, 0)), mesh.point(mesh.vertex(e, 1))));
}

/* The area-weighted normal of the faces that can be reached from one without crossing a crease, up
 * to an area; the zero vector where creases enclose less than that. */
kernel::Vector_3 side_normal(const surface &mesh, const edge_flags &crease,
                             surface::Face_index start, double area_wanted,
                             std::vector<surface::Face_index> &reached)
{
    kernel::Vector_3 sum(0.0, 0.0, 0.0);
    double area = 0.0;
    reached.assign(1, start);
    for (size_t i = 0; i < reached.size() && area < area_wanted; i++) {
        auto h = mesh.halfedge(reached[i]);
        const kernel::Point_3 &a = mesh.point(mesh.source(h)), &b = mesh.point(mesh.target(h));
        kernel::Vector_3 n =
            0.5 * CGAL::cross_product(b - a, mesh.point(mesh.target(mesh.next(h))) - a);
        sum += n;
        area += std::sqrt(n.squared_length());
        for (int k = 0; k < 3; k++, h = mesh.next(h)) {
            auto across = mesh.face(mesh.opposite(h));
            if (across != surface::null_face() && !crease[mesh.edge(h)] &&
                std::find(reached.begin(), reached.end(), across) == reached.end()) {
                reached.push_back(across);
            }
        }
    }
    return area < area_wanted ? kernel::Vector_3(0.0, 0.0, 0.0) : sum;
}

/* Keep the creases between two sides that each have an area, and whose average normals differ by
 * the crease angle too: what slivers and noise raise are none. */
void drop_noise_creases(const surface &mesh, double angle_deg, double area, const edge_kinds &kind,
                        edge_flags &feature)
{
    double cosine = std::cos(angle_deg * CGAL_PI / 180.0);
    std::vector<edge> noise;
    std::vector<surface::Face_index> reached;
    for (edge e : mesh.edges()) {
        if (!feature[e] || kind[e] != KIND_UNKNOWN) {
            continue;
        }
        auto h = mesh.halfedge(e);
        auto n = side_normal(mesh, feature, mesh.face(h), area, reached);
        auto m = side_normal(mesh, feature, mesh.face(mesh.opposite(h)), area, reached);
        double lengths = std::sqrt(n.squared_length() * m.squared_length());
        if (lengths == 0.0 || n * m > cosine * lengths) {
            noise.push_back(e);
        }
    }
    for (edge e : noise) {
        feature[e] = false;
    }
}

/* Collect the creases connected to one, and their length. */
double gather_chain(const surface &mesh, const edge_flags &feature, edge start,
                    std::vector<bool> &seen, std::vector<edge> &chain)
{
    double length = 0.0;
    chain.assign(1, start);
    seen[start] = true;
    for (size_t i = 0; i < chain.size(); i++) {
        length += edge_length(mesh, chain[i]);
        for (int end = 0; end < 2; end++) {
            for (auto h : mesh.halfedges_around_target(mesh.halfedge(chain[i], end))) {
                edge next = mesh.edge(h);
                if (feature[next] && !seen[next]) {
                    seen[next] = true;
                    chain.push_back(next);
                }
            }
        }
    }
    return length;
}

void drop_short_creases(const surface &mesh, double length_min, const edge_kinds &kind,
                        edge_flags &feature)
{
    std::vector<bool> seen(mesh.number_of_edges(), false);
    std::vector<edge> chain;
    for (edge e : mesh.edges()) {
        if (!feature[e] || seen[e]) {
            continue;
        }
        if (gather_chain(mesh, feature, e, seen, chain) < length_min) {
            for (edge noise : chain) {
                feature[noise] = kind[noise] != KIND_UNKNOWN;
            }
        }
    }
}

/* Add what is between two sides to the features. */
void add_side_changes(const surface &mesh, const double (*side)[3], edge_flags &feature)
{
    for (edge e : mesh.edges()) {
        if (!mesh.is_border(e) && !feature[e]) {
            const double *a = side[mesh.face(mesh.halfedge(e, 0))];
            const double *b = side[mesh.face(mesh.halfedge(e, 1))];
            feature[e] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < 0.0;
        }
    }
}

void name_features(const surface &mesh, const edge_flags &feature, char name, edge_kinds &kind)
{
    for (edge e : mesh.edges()) {
        if (feature[e] && kind[e] == KIND_UNKNOWN) {
            kind[e] = name;
        }
    }
}

/* Sharp creases first: a rounded ridge next to one is none. */
void find_features(parian_remesher *remesher, const parian_remesher_desc *desc)
{
    surface &mesh = remesher->mesh;
    pmp::detect_sharp_edges(mesh, desc->crease_deg, remesher->feature);
    for (edge e : mesh.edges()) {
        remesher->kind[e] = mesh.is_border(e) ? KIND_SHARP : KIND_UNKNOWN;
    }
    drop_noise_creases(mesh, desc->crease_deg, desc->feature_area, remesher->kind,
                       remesher->feature);
    drop_short_creases(mesh, desc->feature_length, remesher->kind, remesher->feature);
    name_features(mesh, remesher->feature, KIND_SHARP, remesher->kind);
    if (desc->side) {
        add_side_changes(mesh, desc->side, remesher->feature);
        drop_noise_creases(mesh, desc->ridge_deg, desc->ridge_area, remesher->kind,
                           remesher->feature);
        drop_short_creases(mesh, desc->feature_length, remesher->kind, remesher->feature);
        name_features(mesh, remesher->feature, KIND_ROUNDED, remesher->kind);
    }
}

/* The two features at a vertex, as half-edges that lead away from it; false if there are not just
 * two. */
bool find_two_features(const parian_remesher *remesher, vertex v, halfedge away[2])
{
    const surface &mesh = remesher->mesh;
    int count = 0;
    for (halfedge h : mesh.halfedges_around_target(mesh.halfedge(v))) {
        if (remesher->feature[mesh.edge(h)] || mesh.is_border(mesh.edge(h))) {
            if (count < 2) {
                away[count] = mesh.opposite(h);
            }
            count++;
        }
    }
    return count == 2;
}

/* Where one gets to along a feature after some length, or at its end. */
kernel::Point_3 follow_feature(const parian_remesher *remesher, halfedge h, double length)
{
    const surface &mesh = remesher->mesh;
    vertex start = mesh.source(h);
    for (length -= edge_length(mesh, mesh.edge(h)); length > 0.0;
         length -= edge_length(mesh, mesh.edge(h))) {
        halfedge away[2];
        vertex at = mesh.target(h);
        if (at == start || !find_two_features(remesher, at, away)) {
            break;
        }
        h = mesh.target(away[0]) == mesh.source(h) ? away[1] : away[0];
    }
    return mesh.point(mesh.target(h));
}

bool is_turn(const kernel::Point_3 &a, const kernel::Point_3 &b, const kernel::Point_3 &c)
{
    const double turn_cosine = std::sqrt(0.5); /* 45 degrees */
    kernel::Vector_3 ab = b - a, bc = c - b;
    return ab * bc < turn_cosine * std::sqrt(ab.squared_length() * bc.squared_length());
}

/* Features meet or end at a corner, or sharp ones turn there both from edge to edge and seen from
 * some way off: the border of a scan is jagged, but does not turn. */
bool is_corner(const parian_remesher *remesher, vertex v, double length)
{
    const surface &mesh = remesher->mesh;
    halfedge away[2];
    if (!find_two_features(remesher, v, away)) {
        return true;
    }
    char kind = remesher->kind[mesh.edge(away[0])];
    if (kind != remesher->kind[mesh.edge(away[1])]) {
        return true;
    }
    if (kind == KIND_ROUNDED) {
        return false;
    }
    return is_turn(mesh.point(mesh.target(away[0])), mesh.point(v),
                   mesh.point(mesh.target(away[1]))) &&
           is_turn(follow_feature(remesher, away[0], length), mesh.point(v),
                   follow_feature(remesher, away[1], length));
}

bool touches_feature(const parian_remesher *remesher, vertex v)
{
    const surface &mesh = remesher->mesh;
    for (auto h : mesh.halfedges_around_target(mesh.halfedge(v))) {
        if (remesher->feature[mesh.edge(h)] || mesh.is_border(mesh.edge(h))) {
            return true;
        }
    }
    return false;
}

/* Hand the kinds of features on to those that a round has made; between corners it is the same. */
void spread_kinds(parian_remesher *remesher)
{
    const surface &mesh = remesher->mesh;
    std::vector<edge> known;
    for (edge e : mesh.edges()) {
        if (!remesher->feature[e]) {
            remesher->kind[e] = KIND_UNKNOWN;
        } else if (remesher->kind[e] != KIND_UNKNOWN) {
            known.push_back(e);
        }
    }
    for (size_t i = 0; i < known.size(); i++) {
        for (int end = 0; end < 2; end++) {
            vertex v = mesh.vertex(known[i], end);
            halfedge away[2];
            if (remesher->corner[v] || !find_two_features(remesher, v, away)) {
                continue;
            }
            for (halfedge h : away) {
                if (remesher->feature[mesh.edge(h)] &&
                    remesher->kind[mesh.edge(h)] == KIND_UNKNOWN) {
                    remesher->kind[mesh.edge(h)] = remesher->kind[known[i]];
                    known.push_back(mesh.edge(h));
                }
            }
        }
    }
}

/* The neighbours along a rounded ridge. */
void find_along(const parian_remesher *remesher, vertex v, uint32_t along[2])
{
    const surface &mesh = remesher->mesh;
    halfedge away[2];
    bool rounded = !remesher->corner[v] && find_two_features(remesher, v, away);
    for (int i = 0; i < 2 && rounded; i++) {
        rounded = remesher->kind[mesh.edge(away[i])] == KIND_ROUNDED;
    }
    for (int i = 0; i < 2; i++) {
        along[i] = rounded ? uint32_t(mesh.target(away[i])) : uint32_t(PARIAN_NO_NEIGHBOUR);
    }
}

void copy_out(const parian_remesher *remesher, parian_mesh *to)
{
    const surface &mesh = remesher->mesh;
    for (vertex v : mesh.vertices()) {
        const kernel::Point_3 &p = mesh.point(v);
        double *out = to->position[v];
        out[0] = p.x(), out[1] = p.y(), out[2] = p.z();
    }
    for (surface::Face_index f : mesh.faces()) {
        uint32_t *out = to->triangle[f];
        for (vertex v : mesh.vertices_around_face(mesh.halfedge(f))) {
            *out++ = v;
        }
    }
}

} // namespace

parian_result parian_remesher_create(const parian_env *env, const parian_mesh *mesh,
                                     const parian_remesher_desc *desc, parian_remesher **remesher)
{
    return parian::guard(env, "CGAL remeshing", PARIAN_E_COMPUTE, [&] {
        auto made = std::make_unique<parian_remesher>();
        copy_in(mesh, made->mesh);
        made->feature = made->mesh.add_property_map<edge, bool>("e:feature", false).first;
        made->kind = made->mesh.add_property_map<edge, char>("e:kind", KIND_UNKNOWN).first;
        find_features(made.get(), desc);
        made->corner = made->mesh.add_property_map<vertex, bool>("v:corner", false).first;
        for (vertex v : made->mesh.vertices()) {
            made->corner[v] =
                touches_feature(made.get(), v) && is_corner(made.get(), v, desc->corner_length);
        }
        *remesher = made.release();
        return PARIAN_OK;
    });
}

void parian_remesher_destroy(parian_remesher *remesher)
{
    delete remesher;
}

parian_result parian_remesher_run(const parian_env *env, parian_remesher *remesher,
                                  double edge_length)
{
    return parian::guard(env, "CGAL remeshing", PARIAN_E_COMPUTE, [&] {
        surface &mesh = remesher->mesh;
        pmp::isotropic_remeshing(mesh.faces(), edge_length, mesh,
                                 pmp::parameters::edge_is_constrained_map(remesher->feature)
                                     .vertex_is_constrained_map(remesher->corner)
                                     .number_of_iterations(1)
                                     .number_of_relaxation_steps(0)
                                     .do_project(false));
        mesh.collect_garbage();
        spread_kinds(remesher);
        return PARIAN_OK;
    });
}

parian_result parian_remesher_repair(const parian_env *env, parian_remesher *remesher)
{
    const double cap_cosine = std::cos(140.0 * CGAL_PI / 180.0), needle_ratio = 3.0;
    return parian::guard(env, "CGAL repair of slivers", PARIAN_E_COMPUTE, [&] {
        pmp::experimental::remove_almost_degenerate_faces(
            remesher->mesh, cap_cosine, needle_ratio, 0.0,
            pmp::parameters::edge_is_constrained_map(remesher->feature)
                .vertex_is_constrained_map(remesher->corner));
        remesher->mesh.collect_garbage();
        spread_kinds(remesher);
        return PARIAN_OK;
    });
}

uint32_t parian_remesher_vertex_count(const parian_remesher *remesher)
{
    return remesher->mesh.number_of_vertices();
}

parian_result parian_remesher_copy(const parian_env *env, const parian_remesher *remesher,
                                   parian_mesh *mesh, parian_remesher_features *features)
{
    parian_mesh made = {};
    parian_remesher_features found = {};
    parian_result result = parian::guard(env, "CGAL remeshing", PARIAN_E_COMPUTE, [&] {
        made.vertex_count = remesher->mesh.number_of_vertices();
        made.triangle_count = remesher->mesh.number_of_faces();
        made.position = parian::new_array<double[3]>(env, made.vertex_count);
        made.triangle = parian::new_array<uint32_t[3]>(env, made.triangle_count);
        copy_out(remesher, &made);
        found.on = parian::new_array<bool>(env, made.vertex_count);
        found.along = parian::new_array<uint32_t[2]>(env, made.vertex_count);
        for (vertex v : remesher->mesh.vertices()) {
            found.on[v] = touches_feature(remesher, v);
            find_along(remesher, v, found.along[v]);
        }
        *features = found;
        *mesh = made;
        return PARIAN_OK;
    });
    if (result != PARIAN_OK) {
        parian_mesh_free(env, &made);
        parian_remesher_features_free(env, &found);
    }
    return result;
}

void parian_remesher_features_free(const parian_env *env, parian_remesher_features *features)
{
    parian_free(env, features->on);
    parian_free(env, features->along);
    *features = {};
}

void parian_remesher_move(parian_remesher *remesher, const double (*position)[3])
{
    for (vertex v : remesher->mesh.vertices()) {
        const double *p = position[v];
        remesher->mesh.point(v) = kernel::Point_3(p[0], p[1], p[2]);
    }
}
