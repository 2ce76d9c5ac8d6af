/* cgal_closest.cpp - closest points of a triangle mesh, by CGAL's AABB tree.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/cgal_closest.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "bake/adapters/adapter_barrier.h"

namespace
{

using kernel = CGAL::Simple_cartesian<double>;
using point = kernel::Point_3;

constexpr uint32_t none = 0xFFFFFFFFu;
constexpr size_t block_size = 256; // queries that one thread answers in a row

struct vec {
    double x, y, z;
};

vec operator-(const vec &a, const vec &b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

double dot(const vec &a, const vec &b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

vec cross(const vec &a, const vec &b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

vec load(const double *p)
{
    return {p[0], p[1], p[2]};
}

struct mesh_triangle {
    const parian_mesh *mesh;
    uint32_t index;
};

/* A triangle by its corners in the mesh, as CGAL wants it. */
struct primitive : mesh_triangle {
    using Id = uint32_t;
    using Point = point;
    using Datum = kernel::Triangle_3;

    primitive() = default;
    primitive(const parian_mesh *of, uint32_t triangle) : mesh_triangle{of, triangle}
    {
    }
    explicit primitive(std::vector<mesh_triangle>::const_iterator from) : mesh_triangle(*from)
    {
    }
    const double *corner(int k) const
    {
        return mesh->position[mesh->triangle[index][k]];
    }
    point at(int k) const
    {
        const double *p = corner(k);
        return point(p[0], p[1], p[2]);
    }
    Id id() const
    {
        return index;
    }
    Datum datum() const
    {
        return Datum(at(0), at(1), at(2));
    }
    Point reference_point() const
    {
        return at(0);
    }
};

using tree = CGAL::AABB_tree<CGAL::AABB_traits<kernel, primitive>>;
using node = CGAL::AABB_node<CGAL::AABB_traits<kernel, primitive>>;

/* Barycentrics of the point of triangle abc that is closest to p; [Ericson04] section 5.1.5. */
void closest_in_triangle(const vec &p, const vec &a, const vec &b, const vec &c, double out[3])
{
    vec ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp);
    double d5 = dot(ab, cp), d6 = dot(ac, cp);
    auto set = [out](double u, double v, double w) { out[0] = u, out[1] = v, out[2] = w; };
    if (d1 <= 0.0 && d2 <= 0.0) {
        return set(1.0, 0.0, 0.0);
    }
    if (d3 >= 0.0 && d4 <= d3) {
        return set(0.0, 1.0, 0.0);
    }
    double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        double t = d1 / (d1 - d3);
        return set(1.0 - t, t, 0.0);
    }
    if (d6 >= 0.0 && d5 <= d6) {
        return set(0.0, 0.0, 1.0);
    }
    double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        double t = d2 / (d2 - d6);
        return set(1.0 - t, 0.0, t);
    }
    double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return set(0.0, 1.0 - t, t);
    }
    double scale = 1.0 / (va + vb + vc);
    set(1.0 - vb * scale - vc * scale, vb * scale, vc * scale);
}

vec unit_normal(const parian_mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangle[triangle];
    vec a = load(mesh->position[t[0]]);
    vec n = cross(load(mesh->position[t[1]]) - a, load(mesh->position[t[2]]) - a);
    double length = std::sqrt(dot(n, n));
    return length > 0.0 ? vec{n.x / length, n.y / length, n.z / length} : vec{0.0, 0.0, 0.0};
}

/* One search through the tree: nearer boxes first, the closest candidate so far bounds the rest. Of
 * candidates at the same distance the one with the smallest index wins, so that hints change
 * nothing. */
class search
{
  public:
    using Priority = double;

    search(const std::vector<vec> &normals, const double *normal, double cosine_min, double radius)
        : normals_(normals), normal_(normal), cosine_min_(cosine_min)
    {
        best_.triangle = none;
        best_.distance = radius * radius;
    }
    bool go_further() const
    {
        return true;
    }
    bool do_intersect(const vec &query, const node &box) const
    {
        return do_intersect_with_priority(query, box).first;
    }
    std::pair<bool, Priority> do_intersect_with_priority(const vec &q, const node &box) const
    {
        const auto &b = box.bbox();
        double x = std::max(0.0, std::max(b.xmin() - q.x, q.x - b.xmax()));
        double y = std::max(0.0, std::max(b.ymin() - q.y, q.y - b.ymax()));
        double z = std::max(0.0, std::max(b.zmin() - q.z, q.z - b.zmax()));
        double d = x * x + y * y + z * z;
        return {d <= best_.distance * slack, -d};
    }
    void intersection(const vec &query, const primitive &candidate)
    {
        if (normal_ && dot(normals_[candidate.index], load(normal_)) <= cosine_min_) {
            return;
        }
        vec a = load(candidate.corner(0)), b = load(candidate.corner(1));
        vec c = load(candidate.corner(2));
        double w[3];
        closest_in_triangle(query, a, b, c, w);
        vec p = {w[0] * a.x + w[1] * b.x + w[2] * c.x, w[0] * a.y + w[1] * b.y + w[2] * c.y,
                 w[0] * a.z + w[1] * b.z + w[2] * c.z};
        vec d = query - p;
        double squared = dot(d, d);
        if (squared < best_.distance ||
            (squared == best_.distance && candidate.index < best_.triangle)) {
            best_ = {candidate.index, {w[0], w[1], w[2]}, {p.x, p.y, p.z}, squared};
        }
    }
    bool found() const
    {
        return best_.triangle != none;
    }
    /* With the square root taken. */
    parian_closest_hit result() const
    {
        parian_closest_hit hit = best_;
        hit.distance = std::sqrt(hit.distance);
        return hit;
    }

  private:
    /* Rounding of a box's distance must not hide a candidate at exactly the best distance. */
    static constexpr double slack = 1.0 + 1e-12;
    const std::vector<vec> &normals_;
    const double *normal_;
    double cosine_min_;
    parian_closest_hit best_{};
};

} // namespace

struct parian_closest {
    const parian_mesh *mesh;
    std::vector<vec> normals;
    tree boxes;
};

namespace
{

struct find_job {
    const parian_closest *closest;
    const parian_closest_query *query;
    parian_closest_hit *hit;
};

void find_one(const find_job &job, size_t i, uint32_t hint)
{
    const double infinity = std::numeric_limits<double>::infinity();
    const parian_closest_query &q = *job.query;
    vec at = load(q.point[i]);
    double radius = q.normal && q.radius > 0.0 ? q.radius : infinity;
    search near(job.closest->normals, q.normal ? q.normal[i] : nullptr, q.cosine_min, radius);
    if (hint != none) {
        near.intersection(at, primitive(job.closest->mesh, hint));
    }
    job.closest->boxes.traversal_with_priority(at, near);
    if (near.found() || !q.normal) {
        job.hit[i] = near.result();
        return;
    }
    search any(job.closest->normals, nullptr, 0.0, infinity);
    job.closest->boxes.traversal_with_priority(at, any);
    job.hit[i] = any.result();
}

void find_block(void *context, size_t block)
{
    const find_job &job = *static_cast<const find_job *>(context);
    size_t end = std::min(job.query->count, (block + 1) * block_size);
    uint32_t hint = none;
    for (size_t i = block * block_size; i < end; i++) {
        find_one(job, i, hint);
        hint = job.hit[i].triangle;
    }
}

parian_closest *build(const parian_mesh *mesh)
{
    auto closest = std::make_unique<parian_closest>();
    std::vector<mesh_triangle> all;
    closest->mesh = mesh;
    closest->normals.reserve(mesh->triangle_count);
    all.reserve(mesh->triangle_count);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        closest->normals.push_back(unit_normal(mesh, t));
        all.push_back({mesh, t});
    }
    closest->boxes.insert(all.cbegin(), all.cend());
    closest->boxes.build();
    return closest.release();
}

} // namespace

parian_result parian_closest_create(const parian_env *env, const parian_mesh *mesh,
                                    parian_closest **closest)
{
    return parian::guard(env, "CGAL AABB tree", PARIAN_E_COMPUTE, [&] {
        *closest = build(mesh);
        return PARIAN_OK;
    });
}

void parian_closest_destroy(parian_closest *closest)
{
    delete closest;
}

parian_result parian_closest_find(const parian_env *env, const parian_closest *closest,
                                  const parian_closest_query *query, parian_closest_hit *hit)
{
    return parian::guard(env, "CGAL closest points", PARIAN_E_COMPUTE, [&] {
        find_job job = {closest, query, hit};
        parian_par(env, (query->count + block_size - 1) / block_size, find_block, &job);
        return PARIAN_OK;
    });
}
