// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_octahedral_shared.h"
#include "eevee_shadow_shared.h"
#include "gpu/gpu_testing.hh"
#include "shadows/shadow_octahedral_store.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>

#include <cmath>
#include <functional>
#include <random>

/** A lamp's cube made from closed forms, its octahedral layers, and lookups in them. */
namespace gnomon::test {

/** Radial distance of the first caster, metres; infinite if there is none. */
using DistanceOf = std::function<double(const glm::dvec3 &direction)>;

/** Inverse of shared::cube_face_project for (u, v, 1); not a unit vector. */
inline glm::dvec3 face_direction(int face, double u, double v)
{
  switch (face) {
    case 0: return {1, -v, -u};
    case 1: return {-1, -v, u};
    case 2: return {u, 1, v};
    case 3: return {u, -1, -v};
    case 4: return {u, -v, 1};
    default: return {-u, -v, -1};
  }
}

struct CubeDepths {
  int size_px = 0;
  float near = 0.0F;
  float uv_scale = 1.0F;
  std::array<std::vector<float>, 6> faces;

  /** Radial distance of the caster that the cube shows along the unit vector \a direction, at most \a range. */
  [[nodiscard]] double distance(const glm::dvec3 &direction, double range) const
  {
    const int face = shared::cube_face(glm::vec3(direction));
    const glm::dvec3 p = projected(face, direction);
    const glm::dvec2 texel = (glm::dvec2(p) / p.z * (0.5 * uv_scale) + 0.5) * double(size_px);
    const glm::ivec2 at = glm::clamp(glm::ivec2(texel), 0, size_px - 1);
    const glm::dvec2 middle = ((glm::dvec2(at) + 0.5) / double(size_px) * 2.0 - 1.0) / double(uv_scale);
    const double depth = faces[std::size_t(face)][std::size_t(at.y) * std::size_t(size_px) + std::size_t(at.x)];
    return std::min(near / std::max(depth, 1e-300) * std::sqrt(glm::dot(middle, middle) + 1.0), range);
  }

  static glm::dvec3 projected(int face, const glm::dvec3 &v)
  {
    glm::dvec3 p(0.0);
    for (int i = 0; i < 3; i++) {
      // The rows of the projection are unit vectors.
      const glm::vec3 column = shared::cube_face_project(face, glm::vec3(i == 0, i == 1, i == 2));
      p += glm::dvec3(column) * v[i];
    }
    return p;
  }
};

/** Depths as by a rasteriser: the caster at the centre of each texel. */
inline CubeDepths cube_depths(int size_px, float near, const DistanceOf &distance_of, float uv_scale = 1.0F)
{
  CubeDepths cube{size_px, near, uv_scale, {}};
  for (int face = 0; face < 6; face++) {
    std::vector<float> &texels = cube.faces[std::size_t(face)];
    for (int y = 0; y < size_px; y++) {
      for (int x = 0; x < size_px; x++) {
        const double u = ((x + 0.5) / size_px * 2.0 - 1.0) / uv_scale;
        const double v = ((y + 0.5) / size_px * 2.0 - 1.0) / uv_scale;
        const glm::dvec3 direction = face_direction(face, u, v);
        const double norm = glm::length(direction);
        texels.push_back(float(near / (distance_of(direction / norm) / norm)));
      }
    }
  }
  return cube;
}

/** A receiver, from the lamp, and its plane. */
struct Receiver {
  glm::vec3 from_light{0.0F};
  glm::vec3 normal{0.0F, 0.0F, 1.0F};
  int index = 0;
};

inline constexpr const char *fullscreen_vert = R"(
void main()
{
  gl_Position = vec4(vec2(VERTEX_INDEX & 1, VERTEX_INDEX >> 1) * 4.0 - 1.0, 0.0, 1.0);
})";

/** A store on a device, its programs, and one array of cubes. */
class EsmStage {
 public:
  EsmStage(gpu::Device &device, std::span<const eevee::EsmLamp> lamps) : device_(device)
  {
    sync(lamps);
  }
  /** Identifies each lamp by its index. */
  void sync(std::span<const eevee::EsmLamp> lamps)
  {
    std::vector<eevee::EsmLamp> identified(lamps.begin(), lamps.end());
    for (std::size_t i = 0; i < identified.size(); i++) {
      identified[i].key = i;
    }
    store.sync(device_, shaders_, identified);
  }

  /** Uploads \a cube as cube \a cube_index of an array of two. */
  void upload(const CubeDepths &cube, int cube_index = 0)
  {
    if (!cubes_ || cubes_.desc().width != cube.size_px) {
      cubes_ = device_.create_texture({.name = "cubes",
                                       .kind = gpu::TextureKind::Array,
                                       .format = gpu::Format::Depth32F,
                                       .width = cube.size_px,
                                       .height = cube.size_px,
                                       .layers = 12});
    }
    for (int face = 0; face < 6; face++) {
      device_.upload(cubes_, 6 * cube_index + face, std::as_bytes(std::span(cube.faces[std::size_t(face)])));
    }
  }
  void record(std::size_t index, const CubeDepths &cube, int cube_index = 0, unsigned face_mask = 0x3F)
  {
    gpu::CommandList list;
    store.record(list, index, {cubes_, 6 * cube_index, cube.near, face_mask, cube.uv_scale});
    device_.submit(list);
  }

  /** The layer as stored, border included, metres: rows of data(index).size + 2. */
  std::vector<float> layer(std::size_t index)
  {
    const shared::EsmData &data = store.data(index);
    const gpu::Texture &texture = store.texture(index);
    const std::vector<glm::vec4> all = decoded_texels(device_, texture, data.layer);
    const int edge = data.size + 2 * ESM_BORDER;
    std::vector<float> values;
    for (int y = 0; y < edge; y++) {
      for (int x = 0; x < edge; x++) {
        const float stored = all[std::size_t(y) * std::size_t(texture.desc().width) + std::size_t(x)].x;
        values.push_back(shared::esm_decoded(stored, data.range, data.format));
      }
    }
    return values;
  }

  /** Distances of the \a count taps of a disk kernel before filtering, metres: one row of taps for each texel. */
  std::vector<float> tap_distances(std::size_t index, const CubeDepths &cube, int count)
  {
    const int size = store.data(index).size;
    const gpu::Shader shader = make_shader(device_, "taps", fullscreen_vert,
                                           fmt::format(R"(
#include "eevee/eevee_esm_cube_lib.glsl"
layout(location = 0) out float result;
void main()
{{
  EsmData data = esm.lamps[lamp];
  int texel = int(gl_FragCoord.y);
  float sine = sin(0.5 * data.filter_angle);
  vec3 axis = map_direction(ivec2(texel % data.size, texel / data.size), data.size);
  result = cube_distance(esm_cone_direction(axis, esm_disk_point(int(gl_FragCoord.x), {}), 2.0 * sine * sine), data.range);
}})",
                                                       count));
    const gpu::Texture picture =
        device_.create_texture({.name = "taps", .format = gpu::Format::R32F, .width = count, .height = size * size});
    const gpu::Framebuffer framebuffer = device_.create_framebuffer({"taps", {{&picture}}, {}});
    draw::Pass pass("taps", gpu::State::WriteColor);
    draw::ShadingGroup &group = pass.group(shader);
    store.bind(group);
    nearest_ = device_.create_sampler({.name = "nearest"});
    group.bind_texture("shadow_cubes", cubes_, nearest_);
    group.constant("lamp", int(index));
    group.constant("first_layer", 0);
    group.constant("face_mask", 0x3F);
    group.constant("near", cube.near);
    group.constant("uv_scale", cube.uv_scale);
    group.constant("cube_size_px", cube.size_px);
    group.call_procedural();
    gpu::CommandList list;
    list.begin_pass("taps", framebuffer, {});
    pass.record({}, list);
    list.end_pass();
    device_.submit(list);
    return gpu::read_as<float>(device_, picture);
  }

  /** Results of shadow_esm_visibility on the driver. */
  std::vector<float> visibilities(std::span<const Receiver> receivers)
  {
    constexpr int width = 256;
    const int height = int(receivers.size() + width - 1) / width;
    const auto picture = [&](const char *name) {
      return device_.create_texture({.name = name, .format = gpu::Format::RGBA32F, .width = width, .height = height});
    };
    const std::array<gpu::Texture, 3> pictures = {picture("positions"), picture("normals"), picture("result")};
    std::vector<glm::vec4> positions(std::size_t(width) * std::size_t(height));
    std::vector<glm::vec4> normals(positions.size());
    for (std::size_t i = 0; i < receivers.size(); i++) {
      positions[i] = glm::vec4(receivers[i].from_light, float(receivers[i].index));
      normals[i] = glm::vec4(receivers[i].normal, 0.0F);
    }
    device_.upload(pictures[0], 0, std::as_bytes(std::span(positions)));
    device_.upload(pictures[1], 0, std::as_bytes(std::span(normals)));
    if (!lookup_ || has_variance_ != store.has_variance()) {
      has_variance_ = store.has_variance();
      lookup_ = make_shader(device_, "lookup", fullscreen_vert,
                            std::string(has_variance_ ? "#define USE_SHADOW_EVSM\n" : "") + R"(
#include "eevee/eevee_esm_lib.glsl"
layout(binding = 22) uniform sampler2D positions;
layout(binding = 23) uniform sampler2D normals;
layout(location = 0) out vec4 result;
void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 receiver = texelFetch(positions, pixel, 0);
  result = vec4(shadow_esm_visibility(int(receiver.w), receiver.xyz, texelFetch(normals, pixel, 0).xyz));
})");
      nearest_ = device_.create_sampler({.name = "nearest"});
    }
    const gpu::Framebuffer framebuffer = device_.create_framebuffer({"result", {{&pictures[2]}}, {}});
    draw::Pass pass("lookup", gpu::State::WriteColor);
    draw::ShadingGroup &group = pass.group(lookup_);
    store.bind(group);
    group.bind_texture("positions", pictures[0], nearest_);
    group.bind_texture("normals", pictures[1], nearest_);
    group.call_procedural();
    gpu::CommandList list;
    list.begin_pass("lookup", framebuffer, {});
    pass.record({}, list);
    list.end_pass();
    device_.submit(list);
    std::vector<float> values;
    for (const glm::vec4 &texel : gpu::read_as<glm::vec4>(device_, pictures[2])) {
      values.push_back(texel.x);
    }
    values.resize(receivers.size());
    return values;
  }

 private:
  gpu::Device &device_;
  eevee::ShaderCache shaders_;
  gpu::Texture cubes_;
  gpu::Shader lookup_;
  bool has_variance_ = false;
  gpu::Sampler nearest_;

 public:
  eevee::OctahedralStore store;
};

inline glm::dvec3 random_direction(std::mt19937 &random)
{
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

/** Distance to a sphere that surrounds the lamp, off its middle. */
inline double around_distance(const glm::dvec3 &direction, const glm::dvec3 &center, double radius)
{
  const double along = glm::dot(direction, center);
  return along + std::sqrt(std::max(along * along - glm::dot(center, center) + radius * radius, 0.0));
}

/** Distance to a ball that does not contain the lamp; infinite beside it. */
inline double ball_distance(const glm::dvec3 &direction, const glm::dvec3 &center, double radius)
{
  const double along = glm::dot(direction, center);
  const double inside = along * along - glm::dot(center, center) + radius * radius;
  return inside >= 0.0 && along > 0.0 ? along - std::sqrt(inside) : std::numeric_limits<double>::infinity();
}

/** Distance to the walls of a box around the lamp. */
inline double room_distance(const glm::dvec3 &direction, const glm::dvec3 &low, const glm::dvec3 &high)
{
  double nearest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; axis++) {
    if (direction[axis] != 0.0) {
      nearest = std::min(nearest, (direction[axis] > 0.0 ? high[axis] : low[axis]) / direction[axis]);
    }
  }
  return nearest;
}

/** Balls in a room. */
inline double furnished_distance(const glm::dvec3 &direction)
{
  double nearest = room_distance(direction, {-4, -3, -5}, {5, 2.5, 4});
  const std::array<glm::dvec4, 6> balls = {glm::dvec4(2, 1, 2, 0.7), {-2, -1, 1, 0.5},   {0.5, -1.5, -2.5, 0.6},
                                           {-1.5, 1.2, -1.8, 0.3},   {2.5, -1, -1, 0.9}, {0, 0.2, 2.5, 0.4}};
  for (const glm::dvec4 &ball : balls) {
    nearest = std::min(nearest, ball_distance(direction, glm::dvec3(ball), ball.w));
  }
  return nearest;
}

}  // namespace gnomon::test
