/* gltf_light.cpp - reads the lights of KHR_lights_punctual.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/adapters/gltf_parts.h"

#include <algorithm>
#include <cmath>

namespace parian::gltf
{

namespace
{

constexpr double degrees = 57.295779513082320877;
constexpr float inner_min_deg = 0.1f, outer_max_deg = 89.9f;

bool read_type(const std::string &name, parian_light &light)
{
    if (name == "point") {
        light.type = PARIAN_LIGHT_POINT;
    } else if (name == "directional") {
        light.type = PARIAN_LIGHT_DIRECTIONAL;
    } else if (name == "spot") {
        light.type = PARIAN_LIGHT_SPOT;
    } else {
        return false;
    }
    return true;
}

/* A light stands at its node's origin and shines along the node's -z. */
bool place(const matrix &world, parian_light &light)
{
    double length = std::hypot(world[8], world[9], world[10]);
    for (size_t k = 0; k < 3; k++) {
        light.position[k] = float(world[12 + k]);
        light.direction[k] = length > 0 ? float(-world[8 + k] / length) : k == 2 ? -1.0f : 0.0f;
        light.up[k] = float(world[4 + k]);
        if (!std::isfinite(light.position[k]) || !std::isfinite(light.direction[k]) ||
            !std::isfinite(light.up[k])) {
            return false;
        }
    }
    return true;
}

} // namespace

bool read_light(const parian_env *env, const document &file, const tinygltf::Node &node,
                const matrix &world, parian_light &light)
{
    auto found = node.extensions.find("KHR_lights_punctual");
    if (found == node.extensions.end() || !found->second.IsObject() ||
        !found->second.Has("light") || !found->second.Get("light").IsNumber()) {
        return false;
    }
    int index = found->second.Get("light").GetNumberAsInt();
    if (index < 0 || size_t(index) >= file.model.lights.size()) {
        throw failure(PARIAN_E_FORMAT, "node '" + node.name + "' names light " +
                                           std::to_string(index) + " of " +
                                           std::to_string(file.model.lights.size()));
    }
    const tinygltf::Light &source = file.model.lights[size_t(index)];
    light = parian_light();
    bool usable = read_type(source.type, light) && place(world, light);
    for (size_t k = 0; k < 3; k++) {
        double color = k < source.color.size() ? source.color[k] : 1;
        light.color[k] = float(color * source.intensity);
        usable = usable && std::isfinite(light.color[k]) && light.color[k] >= 0;
    }
    if (light.type == PARIAN_LIGHT_SPOT) {
        double outer = source.spot.outerConeAngle * degrees,
               inner = source.spot.innerConeAngle * degrees;
        usable = usable && std::isfinite(outer) && std::isfinite(inner) && outer > 0;
        light.outer_deg = std::clamp(float(outer), inner_min_deg, outer_max_deg);
        light.inner_deg = std::clamp(float(inner), inner_min_deg, light.outer_deg);
    }
    if (!usable) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "%s: light %d is left out: its type or numbers are unusable", file.path.c_str(),
                   index);
    }
    return usable;
}

} // namespace parian::gltf
