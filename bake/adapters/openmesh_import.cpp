/* openmesh_import.cpp - reads OBJ, PLY, STL and OFF through OpenMesh as a soup of polygons.
 *
 * OpenMesh's own meshes refuse faces at non-manifold edges; the importer here records every face,
 * and the surface stage decides.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include <cmath>
#include <cstring>
#include <istream>
#include <mutex>
#include <streambuf>
#include <vector>

#include "bake/adapters/adapter_barrier.h"
#include "bake/adapters/openmesh_import.h"

namespace
{

using namespace OpenMesh;

/* A stream over bytes that somebody else owns. */
class memory_buffer : public std::streambuf
{
  public:
    memory_buffer(const void *data, size_t size)
    {
        char *begin = const_cast<char *>(static_cast<const char *>(data));
        setg(begin, begin, begin + size);
    }

  protected:
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override
    {
        char *base = from == std::ios_base::beg   ? eback()
                     : from == std::ios_base::cur ? gptr()
                                                  : egptr();
        if (offset < eback() - base || offset > egptr() - base) {
            return pos_type(off_type(-1));
        }
        setg(eback(), base + offset, egptr());
        return pos_type(gptr() - eback());
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode mode) override
    {
        return seekoff(off_type(position), std::ios_base::beg, mode);
    }
};

/* Records vertices and faces; every other attribute that a reader offers is passed over. */
class soup_importer : public IO::BaseImporter
{
  public:
    std::vector<Vec3f> points;
    std::vector<uint32_t> offsets{0};
    std::vector<uint32_t> corners;

    VertexHandle add_vertex(const Vec3f &point) override
    {
        points.push_back(point);
        return VertexHandle(static_cast<int>(points.size()) - 1);
    }
    VertexHandle add_vertex() override
    {
        return add_vertex(Vec3f(0.0f));
    }
    void set_point(VertexHandle vertex, const Vec3f &point) override
    {
        points.at(static_cast<size_t>(vertex.idx())) = point;
    }
    FaceHandle add_face(const VHandles &face) override
    {
        for (VertexHandle vertex : face) {
            corners.push_back(static_cast<uint32_t>(vertex.idx()));
        }
        if (corners.size() > INT32_MAX) {
            throw parian::failure(PARIAN_E_LIMIT, "more than 2^31 face corners");
        }
        offsets.push_back(static_cast<uint32_t>(corners.size()));
        return FaceHandle(static_cast<int>(offsets.size()) - 2);
    }
    size_t n_vertices() const override
    {
        return points.size();
    }
    size_t n_faces() const override
    {
        return offsets.size() - 1;
    }
    size_t n_edges() const override
    {
        return 0;
    }

    using Status = Attributes::StatusInfo;
    // clang-format off
    HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
    FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f> &) override {}
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f> &) override {}
    void set_face_texindex(FaceHandle, int) override {}
    void set_halfedge(VertexHandle, HalfedgeHandle) override {}
    void set_normal(VertexHandle, const Vec3f &) override {}
    void set_normal(VertexHandle, const Vec3d &) override {}
    void set_normal(FaceHandle, const Vec3f &) override {}
    void set_normal(FaceHandle, const Vec3d &) override {}
    void set_color(VertexHandle, const Vec3uc &) override {}
    void set_color(VertexHandle, const Vec4uc &) override {}
    void set_color(VertexHandle, const Vec3f &) override {}
    void set_color(VertexHandle, const Vec4f &) override {}
    void set_color(EdgeHandle, const Vec3uc &) override {}
    void set_color(EdgeHandle, const Vec4uc &) override {}
    void set_color(EdgeHandle, const Vec3f &) override {}
    void set_color(EdgeHandle, const Vec4f &) override {}
    void set_color(FaceHandle, const Vec3uc &) override {}
    void set_color(FaceHandle, const Vec4uc &) override {}
    void set_color(FaceHandle, const Vec3f &) override {}
    void set_color(FaceHandle, const Vec4f &) override {}
    void set_texcoord(VertexHandle, const Vec2f &) override {}
    void set_texcoord(VertexHandle, const Vec3f &) override {}
    void set_texcoord(HalfedgeHandle, const Vec2f &) override {}
    void set_texcoord(HalfedgeHandle, const Vec3f &) override {}
    void set_status(VertexHandle, const Status &) override {}
    void set_status(HalfedgeHandle, const Status &) override {}
    void set_status(EdgeHandle, const Status &) override {}
    void set_status(FaceHandle, const Status &) override {}
    void set_next(HalfedgeHandle, HalfedgeHandle) override {}
    void set_face(HalfedgeHandle, FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void add_texture_information(int, std::string) override {}
    // clang-format on
};

/* While it lives, OpenMesh's own talk to standard output and error is off. */
class quiet_openmesh
{
  public:
    quiet_openmesh()
    {
        omlog().disable();
        omout().disable();
        omerr().disable();
    }
    ~quiet_openmesh()
    {
        omlog().enable();
        omout().enable();
        omerr().enable();
    }
};

std::mutex &reader_mutex()
{
    static std::mutex mutex;
    return mutex;
}

void check_soup(const soup_importer &soup)
{
    for (size_t i = 0; i < soup.points.size(); i++) {
        for (int k = 0; k < 3; k++) {
            if (!std::isfinite(soup.points[i][k])) {
                throw parian::failure(PARIAN_E_FORMAT, "vertex " + std::to_string(i) +
                                                           " has a coordinate that is not finite");
            }
        }
    }
    for (uint32_t corner : soup.corners) {
        if (corner >= soup.points.size()) {
            throw parian::failure(PARIAN_E_FORMAT, "a face names vertex " + std::to_string(corner) +
                                                       " of " + std::to_string(soup.points.size()));
        }
    }
}

void copy_out(const parian_env *env, const soup_importer &soup, parian_polygons *polygons)
{
    parian_polygons made = {};
    made.vertex_count = static_cast<uint32_t>(soup.points.size());
    made.polygon_count = static_cast<uint32_t>(soup.n_faces());
    try {
        made.position = parian::new_array<double[3]>(env, soup.points.size());
        made.offset = parian::new_array<uint32_t>(env, soup.offsets.size());
        made.corner = parian::new_array<uint32_t>(env, soup.corners.size());
    } catch (...) {
        parian_polygons_free(env, &made);
        throw;
    }
    for (size_t i = 0; i < soup.points.size(); i++) {
        for (int k = 0; k < 3; k++) {
            made.position[i][k] = soup.points[i][k];
        }
    }
    std::memcpy(made.offset, soup.offsets.data(), soup.offsets.size() * sizeof(uint32_t));
    if (!soup.corners.empty()) {
        std::memcpy(made.corner, soup.corners.data(), soup.corners.size() * sizeof(uint32_t));
    }
    *polygons = made;
}

} // namespace

extern "C" void parian_polygons_free(const parian_env *env, parian_polygons *polygons)
{
    if (!polygons) {
        return;
    }
    parian_free(env, polygons->position);
    parian_free(env, polygons->offset);
    parian_free(env, polygons->corner);
    *polygons = parian_polygons();
}

extern "C" parian_result parian_openmesh_read(const parian_env *env, const char *name,
                                              const char *format, bool binary, const void *data,
                                              size_t size, parian_polygons *polygons)
{
    return parian::guard(env, name, PARIAN_E_FORMAT, [&] {
        std::lock_guard<std::mutex> lock(reader_mutex());
        quiet_openmesh quiet;
        memory_buffer buffer(data, size);
        std::istream stream(&buffer);
        IO::Options options;
        if (binary) {
            options += IO::Options::Binary;
        }
        soup_importer soup;
        if (!IO::IOManager().read(stream, format, soup, options)) {
            throw parian::failure(PARIAN_E_FORMAT,
                                  std::string("OpenMesh cannot read this as ") + format);
        }
        check_soup(soup);
        copy_out(env, soup, polygons);
        return PARIAN_OK;
    });
}
