/* gltf_import.cpp - walks the nodes of a glTF scene and gathers parts, materials and lights.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/gltf_import.h"
#include "bake/adapters/gltf_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace
{

using namespace parian;
using namespace parian::gltf;

constexpr size_t triangle_total_max = 20u * 1000u * 1000u;
constexpr uint32_t no_material = UINT32_MAX;

constexpr matrix identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

matrix multiply(const matrix &a, const matrix &b)
{
    matrix out;
    for (size_t column = 0; column < 4; column++) {
        for (size_t row = 0; row < 4; row++) {
            double sum = 0;
            for (size_t k = 0; k < 4; k++) {
                sum += a[4 * k + row] * b[4 * column + k];
            }
            out[4 * column + row] = sum;
        }
    }
    return out;
}

matrix local_transform(const tinygltf::Node &node)
{
    matrix out = identity;
    if (node.matrix.size() == 16) {
        std::copy(node.matrix.begin(), node.matrix.end(), out.begin());
        return out;
    }
    double q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, t[3] = {0, 0, 0};
    std::copy_n(node.rotation.begin(), node.rotation.size() == 4 ? 4 : 0, q);
    std::copy_n(node.scale.begin(), node.scale.size() == 3 ? 3 : 0, s);
    std::copy_n(node.translation.begin(), node.translation.size() == 3 ? 3 : 0, t);
    double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double &component : q) {
        component /= length > 0 ? length : 1;
    }
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double rotation[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
        2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
        2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
    for (size_t column = 0; column < 3; column++) {
        for (size_t row = 0; row < 3; row++) {
            out[4 * column + row] = rotation[3 * column + row] * s[column];
        }
        out[12 + column] = t[column];
    }
    return out;
}

/* The cofactors of the upper 3x3 (columns), which carry normals, and its determinant. */
double cofactors(const matrix &m, double (&out)[9])
{
    for (size_t c = 0; c < 3; c++) {
        size_t c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        for (size_t r = 0; r < 3; r++) {
            size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3;
            out[3 * c + r] = m[4 * c1 + r1] * m[4 * c2 + r2] - m[4 * c1 + r2] * m[4 * c2 + r1];
        }
    }
    return m[0] * out[0] + m[1] * out[1] + m[2] * out[2];
}

using point = std::array<double, 3>;

/* A part being gathered: one node, one material. */
struct part_builder {
    std::string name, mesh_name;
    int source_material = -1;
    bool has_normal = true, has_uv = false;
    std::vector<point> position;
    std::vector<std::array<uint32_t, 3>> triangle;
    std::vector<std::array<float, 3>> corner_normal;
    std::vector<std::array<float, 2>> corner_uv;
};

class scene_builder
{
  public:
    scene_builder(const parian_env *env, const document &file)
        : env_(env), file_(file), visited_(file.model.nodes.size(), false)
    {
    }
    void walk();
    void finish(parian_source_scene &scene);

  private:
    void add_mesh(const tinygltf::Node &node, size_t node_index, const matrix &world);
    void add_primitive(const primitive &source, const matrix &world, double determinant,
                       const double (&normal_matrix)[9], const std::string &where,
                       part_builder &part);
    part_builder &find_part(size_t first, const std::string &name, const tinygltf::Mesh &mesh,
                            int material);
    void fill_part(const part_builder &source, parian_source_part &target,
                   std::vector<parian_source_material> &materials, picture_table &pictures);
    uint32_t find_material(const part_builder &part, std::vector<parian_source_material> &materials,
                           picture_table &pictures);

    const parian_env *env_;
    const document &file_;
    std::vector<bool> visited_;
    std::vector<part_builder> parts_;
    std::vector<parian_light> lights_;
    std::vector<int> material_keys_; /* glTF material of each of ours */
    size_t triangle_total_ = 0;
};

std::vector<int> root_nodes(const tinygltf::Model &model)
{
    if (!model.scenes.empty()) {
        size_t scene = model.defaultScene >= 0 ? size_t(model.defaultScene) : 0;
        if (scene >= model.scenes.size()) {
            throw failure(PARIAN_E_FORMAT, "the default scene is " + std::to_string(scene) +
                                               " of " + std::to_string(model.scenes.size()));
        }
        return model.scenes[scene].nodes;
    }
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node &node : model.nodes) {
        for (int child : node.children) {
            if (child >= 0 && size_t(child) < is_child.size()) {
                is_child[size_t(child)] = true;
            }
        }
    }
    std::vector<int> roots;
    for (size_t i = 0; i < is_child.size(); i++) {
        if (!is_child[i]) {
            roots.push_back(int(i));
        }
    }
    return roots;
}

void scene_builder::walk()
{
    struct visit {
        int node;
        matrix parent;
    };
    std::vector<visit> pending;
    std::vector<int> roots = root_nodes(file_.model);
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
        pending.push_back({*root, identity});
    }
    while (!pending.empty()) {
        visit next = pending.back();
        pending.pop_back();
        if (next.node < 0 || size_t(next.node) >= visited_.size() || visited_[size_t(next.node)]) {
            throw failure(PARIAN_E_FORMAT, "node " + std::to_string(next.node) +
                                               " does not exist or is reached twice");
        }
        visited_[size_t(next.node)] = true;
        const tinygltf::Node &node = file_.model.nodes[size_t(next.node)];
        matrix world = multiply(next.parent, local_transform(node));
        parian_light light;
        if (read_light(env_, file_, node, world, light)) {
            lights_.push_back(light);
        }
        if (node.mesh >= 0) {
            add_mesh(node, size_t(next.node), world);
        }
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
            pending.push_back({*child, world});
        }
    }
}

part_builder &scene_builder::find_part(size_t first, const std::string &name,
                                       const tinygltf::Mesh &mesh, int material)
{
    for (size_t i = first; i < parts_.size(); i++) {
        if (parts_[i].source_material == material) {
            return parts_[i];
        }
    }
    parts_.emplace_back();
    parts_.back().name = name;
    parts_.back().mesh_name = mesh.name;
    parts_.back().source_material = material;
    return parts_.back();
}

void scene_builder::add_mesh(const tinygltf::Node &node, size_t node_index, const matrix &world)
{
    const tinygltf::Model &model = file_.model;
    if (size_t(node.mesh) >= model.meshes.size()) {
        throw failure(PARIAN_E_FORMAT, "node " + std::to_string(node_index) + " names mesh " +
                                           std::to_string(node.mesh) + " of " +
                                           std::to_string(model.meshes.size()));
    }
    const tinygltf::Mesh &mesh = model.meshes[size_t(node.mesh)];
    std::string name = !node.name.empty() ? node.name : !mesh.name.empty() ? mesh.name : "body";
    double normal_matrix[9];
    double determinant = cofactors(world, normal_matrix);
    size_t first = parts_.size();
    for (size_t i = 0; i < mesh.primitives.size(); i++) {
        const tinygltf::Primitive &source = mesh.primitives[i];
        std::string where =
            "node '" + name + "' mesh '" + mesh.name + "' primitive " + std::to_string(i);
        if (source.material >= 0 && size_t(source.material) >= model.materials.size()) {
            throw failure(PARIAN_E_FORMAT, where + " names material " +
                                               std::to_string(source.material) + " of " +
                                               std::to_string(model.materials.size()));
        }
        int material = source.material < 0 ? -1 : source.material;
        int uv_set =
            material < 0
                ? 0
                : model.materials[size_t(material)].pbrMetallicRoughness.baseColorTexture.texCoord;
        primitive data;
        if (!read_primitive(file_, source, uv_set, where, data)) {
            parian_log(env_, PARIAN_LOG_WARNING, "%s: %s is points or lines: left out",
                       file_.path.c_str(), where.c_str());
            continue;
        }
        add_primitive(data, world, determinant, normal_matrix, where,
                      find_part(first, name, mesh, material));
    }
}

void scene_builder::add_primitive(const primitive &source, const matrix &world, double determinant,
                                  const double (&normal_matrix)[9], const std::string &where,
                                  part_builder &part)
{
    triangle_total_ += source.triangle.size();
    if (triangle_total_ > triangle_total_max) {
        throw failure(PARIAN_E_LIMIT, "more than 20 million triangles in all instances together");
    }
    uint32_t base = uint32_t(part.position.size());
    for (const point &p : source.position) {
        point q;
        for (size_t row = 0; row < 3; row++) {
            q[row] =
                world[row] * p[0] + world[4 + row] * p[1] + world[8 + row] * p[2] + world[12 + row];
            if (!std::isfinite(q[row]) || std::fabs(q[row]) > 1e30) {
                throw failure(PARIAN_E_FORMAT, where + ": a transformed coordinate is not finite");
            }
        }
        part.position.push_back(q);
    }
    part.has_normal = part.has_normal && !source.normal.empty();
    part.has_uv = part.has_uv || !source.uv.empty();
    double sign = determinant < 0 ? -1 : 1;
    for (std::array<uint32_t, 3> corner : source.triangle) {
        if (determinant < 0) {
            std::swap(corner[1], corner[2]);
        }
        part.triangle.push_back({base + corner[0], base + corner[1], base + corner[2]});
        for (uint32_t index : corner) {
            std::array<float, 3> n = {0, 0, 0};
            for (size_t row = 0; row < 3 && !source.normal.empty(); row++) {
                const std::array<float, 3> &from = source.normal[index];
                double sum = 0;
                for (size_t column = 0; column < 3; column++) {
                    sum += normal_matrix[3 * column + row] * double(from[column]);
                }
                n[row] = float(sign * sum);
            }
            part.corner_normal.push_back(n);
            part.corner_uv.push_back(source.uv.empty() ? std::array<float, 2>{0, 0}
                                                       : source.uv[index]);
        }
    }
}

uint32_t scene_builder::find_material(const part_builder &part,
                                      std::vector<parian_source_material> &materials,
                                      picture_table &pictures)
{
    if (part.source_material < 0) {
        return no_material;
    }
    auto known = std::find(material_keys_.begin(), material_keys_.end(), part.source_material);
    if (known != material_keys_.end()) {
        return uint32_t(known - material_keys_.begin());
    }
    parian_source_material made = read_material(file_.model, size_t(part.source_material));
    made.base_color_picture = pictures.find(size_t(part.source_material));
    materials.push_back(made);
    material_keys_.push_back(part.source_material);
    return uint32_t(materials.size() - 1);
}

/* Unit normals; where the source has none that is usable, that of the triangle. */
void fill_normals(const part_builder &source, parian_mesh &mesh)
{
    for (size_t t = 0; t < source.triangle.size(); t++) {
        const point &a = source.position[source.triangle[t][0]];
        const point &b = source.position[source.triangle[t][1]];
        const point &c = source.position[source.triangle[t][2]];
        double flat[3], flat_length = 0;
        for (size_t k = 0; k < 3; k++) {
            size_t u = (k + 1) % 3, v = (k + 2) % 3;
            flat[k] = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
        }
        flat_length = std::hypot(flat[0], flat[1], flat[2]);
        for (size_t i = 0; i < 3; i++) {
            const std::array<float, 3> &n = source.corner_normal[3 * t + i];
            double length = std::hypot(double(n[0]), double(n[1]), double(n[2]));
            bool usable = std::isfinite(length) && length > 0;
            for (size_t k = 0; k < 3; k++) {
                double fallback = flat_length > 0 ? flat[k] / flat_length : k == 2 ? 1 : 0;
                mesh.corner_normal[t][i][k] = float(usable ? double(n[k]) / length : fallback);
            }
        }
    }
}

void scene_builder::fill_part(const part_builder &source, parian_source_part &target,
                              std::vector<parian_source_material> &materials,
                              picture_table &pictures)
{
    parian_mesh &mesh = target.mesh;
    copy_name(target.name, source.name);
    copy_name(target.mesh_name, source.mesh_name);
    target.material = find_material(source, materials, pictures);
    mesh.position = new_array<double[3]>(env_, source.position.size());
    mesh.triangle = new_array<uint32_t[3]>(env_, source.triangle.size());
    mesh.material = new_array<uint32_t>(env_, source.triangle.size());
    mesh.vertex_count = uint32_t(source.position.size());
    mesh.triangle_count = uint32_t(source.triangle.size());
    for (size_t i = 0; i < source.position.size(); i++) {
        std::copy_n(source.position[i].begin(), 3, mesh.position[i]);
    }
    for (size_t t = 0; t < source.triangle.size(); t++) {
        std::copy_n(source.triangle[t].begin(), 3, mesh.triangle[t]);
        mesh.material[t] = target.material;
    }
    if (source.has_normal) {
        mesh.corner_normal = new_array<float[3][3]>(env_, source.triangle.size());
        fill_normals(source, mesh);
    }
    if (source.has_uv) {
        mesh.corner_uv = new_array<float[3][2]>(env_, source.triangle.size());
        for (size_t i = 0; i < source.corner_uv.size(); i++) {
            for (size_t k = 0; k < 2; k++) {
                float x = source.corner_uv[i][k];
                mesh.corner_uv[i / 3][i % 3][k] = std::isfinite(x) ? x : 0;
            }
        }
    }
}

void scene_builder::finish(parian_source_scene &scene)
{
    if (triangle_total_ == 0) {
        throw failure(PARIAN_E_FORMAT, "the scene has no triangles, expected a mesh");
    }
    std::vector<parian_source_material> materials;
    picture_table pictures(env_, file_);
    auto empty = [](const part_builder &part) { return part.triangle.empty(); };
    parts_.erase(std::remove_if(parts_.begin(), parts_.end(), empty), parts_.end());
    scene.is_scene = true;
    scene.parts = new_array<parian_source_part>(env_, parts_.size());
    memset(scene.parts, 0, parts_.size() * sizeof *scene.parts);
    scene.part_count = uint32_t(parts_.size());
    for (size_t i = 0; i < parts_.size(); i++) {
        fill_part(parts_[i], scene.parts[i], materials, pictures);
        parts_[i] = part_builder();
    }
    scene.materials = new_array<parian_source_material>(env_, materials.size());
    std::copy(materials.begin(), materials.end(), scene.materials);
    scene.material_count = uint32_t(materials.size());
    scene.lights = new_array<parian_light>(env_, lights_.size());
    std::copy(lights_.begin(), lights_.end(), scene.lights);
    scene.light_count = uint32_t(lights_.size());
    pictures.release(scene);
}

} // namespace

extern "C" parian_result parian_gltf_read(const parian_env *env, const char *path,
                                          const uint8_t *data, size_t size,
                                          parian_source_scene *scene)
{
    parian_source_scene made = {};
    parian_result result = guard(env, path, PARIAN_E_FORMAT, [&] {
        document file;
        load(env, path, data, size, file);
        scene_builder builder(env, file);
        builder.walk();
        builder.finish(made);
        return PARIAN_OK;
    });
    if (result == PARIAN_OK) {
        *scene = made;
    } else {
        parian_source_scene_free(env, &made);
    }
    return result;
}
