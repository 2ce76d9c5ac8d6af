/* gltf_parts.h - what the sources of the glTF adapter share. C++ only, internal to the adapter.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLTF_PARTS_H
#define PARIAN_BAKE_GLTF_PARTS_H

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

#include <array>
#include <string>
#include <vector>

#include "bake/adapters/adapter_barrier.h"
#include "bake/stages/import.h"

namespace parian::gltf
{

/* A picture's coded bytes: a file, a data URI, or a view of a buffer. */
struct image_source {
    std::string uri;
    int buffer_view = -1;
};

/* A checked file: every buffer view lies inside its buffer. */
struct document {
    std::string path, folder;
    tinygltf::Model model;
    std::vector<image_source> images;
};

/* gltf_load.cpp: check and parse. Throws parian::failure. */
void load(const parian_env *env, const char *path, const uint8_t *data, size_t size,
          document &file);

/* The bytes of a buffer view. Throws where there is no such view. */
struct byte_span {
    const uint8_t *data;
    size_t size;
};
byte_span view_bytes(const tinygltf::Model &model, int view, const std::string &where);

/* The triangles of one primitive in mesh space. */
struct primitive {
    std::vector<std::array<double, 3>> position;
    std::vector<std::array<float, 3>> normal; /* as many as positions, or none */
    std::vector<std::array<float, 2>> uv;     /* as many as positions, or none */
    std::vector<std::array<uint32_t, 3>> triangle;
};

/* gltf_mesh.cpp: read accessors, sparse ones too, or the Draco mesh; false for a mode that is no
 * triangles. */
bool read_primitive(const document &file, const tinygltf::Primitive &source, int uv_set,
                    const std::string &where, primitive &out);

/* gltf_draco.cpp: a compressed primitive. Attribute ids of -1 are absent. */
struct draco_ids {
    int position = -1, normal = -1, uv = -1;
};
void decode_draco(byte_span bytes, const draco_ids &ids, const std::string &where, primitive &out);

/* gltf_picture.cpp: decode PNG or JPEG; false with a reason where that fails. */
bool decode_picture(const parian_env *env, byte_span bytes, parian_picture &picture,
                    std::string &reason);

/* gltf_material.cpp. */
parian_source_material read_material(const tinygltf::Model &model, size_t index);
void copy_name(char (&target)[PARIAN_NAME_MAX], const std::string &name);
/* The decoded base colour textures, each once. */
class picture_table
{
  public:
    picture_table(const parian_env *env, const document &file);
    ~picture_table();
    picture_table(const picture_table &) = delete;
    picture_table &operator=(const picture_table &) = delete;
    int32_t find(size_t material); /* index of its base colour picture, or -1 */
    void release(parian_source_scene &scene);

  private:
    int32_t load(int image);
    const parian_env *env_;
    const document &file_;
    std::vector<int32_t> known_; /* per image: -2 not tried */
    std::vector<parian_picture> pictures_;
    uint64_t pixel_total_ = 0;
};

/* A node's transform: columns as in glTF. */
using matrix = std::array<double, 16>;
/* gltf_light.cpp: the light of a node; false where the node has none or it is unusable (with a
 * warning). */
bool read_light(const parian_env *env, const document &file, const tinygltf::Node &node,
                const matrix &world, parian_light &light);

} // namespace parian::gltf

#endif
