// SPDX-License-Identifier: MIT
// The shadow map of one spot lamp, on the draw manager: a depth pass with a depth bias, and a pass that looks it up,
// with and without PCF.
//   shadow_mapping [--backend auto|gl|vulkan] [--bias CONSTANT SLOPE] SCENE FOLDER
// FOLDER gets hard.ppm and pcf.ppm, distances.ppm with the map's distances on a quad, and default.ppm: the picture of
// the engine, whose shadows need no bias, because each lookup moves the receiver along its plane.
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include "draw_pass.hh"
#include "draw_target.hh"
#include "gpu_create_device.hh"
#include "render_camera.hh"
#include "shader_check_reflection.hh"
#include "shader_check_spirv.hh"
#include "shader_files.hh"

#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <vector>

using namespace gnomon;

/** The content of `frame_block`. World space, metres; the origin is that of the render scene. */
struct FrameData {
  glm::mat4 clip_from_world;
  glm::mat4 lamp_clip_from_world;
  /** w: cosine of half the angle of the cone. */
  glm::vec4 lamp_position;
  /** Against the direction of the light. w: 1 over the width of the cone's soft edge, as a difference of cosines. */
  glm::vec4 lamp_back;
  /** Radiant intensity, W/sr. w: distance of the near plane. */
  glm::vec4 lamp_intensity;
};

static constexpr const char *frame_lib = R"(
#include "shared/slots_shared.h"
layout(std140, binding = VIEW_BLOCK_SLOT) uniform frame_block
{
  mat4 clip_from_world;
  mat4 lamp_clip_from_world;
  vec4 lamp_position;
  vec4 lamp_back;
  vec4 lamp_intensity;
};
)";

static constexpr const char *depth_vert = R"(#version 450 core
#include "draw/draw_object_lib.glsl"
#include "frame_lib.glsl"
void main()
{
  gl_Position = lamp_clip_from_world * vertex_position_ws();
})";

static constexpr const char *depth_frag = R"(#version 450 core
void main() {}
)";

static constexpr const char *lit_vert = R"(#version 450 core
#include "draw/draw_object_lib.glsl"
#include "frame_lib.glsl"
layout(location = ATTRIBUTE_NORMAL) in vec3 normal;
layout(location = 0) out vec3 position_ws;
layout(location = 1) out vec3 normal_ws;
void main()
{
  position_ws = vertex_position_ws().xyz;
  normal_ws = to_normal_ws(normal);
  gl_Position = clip_from_world * vec4(position_ws, 1.0);
})";

static constexpr const char *lit_frag = R"(#version 450 core
#include "frame_lib.glsl"
SPECIALIZATION_CONSTANT(0) const bool use_pcf = true;
layout(binding = SHADOW_MAPS_SLOT) uniform sampler2DShadow shadow_map;
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 base_color;
};
layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;
layout(location = 0) out vec4 radiance;

/** The share of the lookups that see the lamp. A lookup is 1 if the receiver is at least as near as the map. */
float visibility()
{
  vec4 clip = lamp_clip_from_world * vec4(position_ws, 1.0);
  vec3 place = clip.xyz / clip.w;
  vec2 texel = 1.0 / vec2(textureSize(shadow_map, 0));
  int radius = use_pcf ? 1 : 0;
  float sum = 0.0;
  for (int y = -radius; y <= radius; y++) {
    for (int x = -radius; x <= radius; x++) {
      sum += texture(shadow_map, vec3(0.5 + 0.5 * place.xy + texel * vec2(x, y), place.z));
    }
  }
  return sum / float((2 * radius + 1) * (2 * radius + 1));
}

void main()
{
  // From the point in world space: the lamp is in world space, too.
  vec3 to_lamp = lamp_position.xyz - position_ws;
  float distance_squared = dot(to_lamp, to_lamp);
  vec3 direction = to_lamp * inversesqrt(distance_squared);
  float cone = smoothstep(0.0, 1.0, (dot(direction, lamp_back.xyz) - lamp_position.w) * lamp_back.w);
  float cosine = max(dot(normalize(normal_ws), direction), 0.0);
  // Outside of the cone, which the map encloses, nothing is looked up.
  float seen = cone * cosine > 0.0 ? cone * cosine * visibility() : 0.0;
  const float pi = 3.14159265;
  radiance = vec4(base_color.rgb / pi * lamp_intensity.rgb * seen / distance_squared, 1.0);
})";

static constexpr const char *quad_frag = R"(#version 450 core
#include "frame_lib.glsl"
layout(binding = SHADOW_MAPS_SLOT) uniform sampler2D shadow_map;
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Distance along the lamp's axis that is white, and the edge of the quad in pixels. */
  vec2 scale;
};
layout(location = 0) out vec4 grey;
void main()
{
  // The far plane is infinitely far away: depth is the distance of the near plane over that of the surface.
  float depth = texture(shadow_map, gl_FragCoord.xy / scale.y).r;
  grey = vec4(vec3(depth > 0.0 ? lamp_intensity.w / depth / scale.x : 1.0), 1.0);
})";

static std::optional<std::string_view> shader_file(std::string_view path)
{
  return path == "frame_lib.glsl"    ? frame_lib
         : path == "depth_vert.glsl" ? depth_vert
         : path == "depth_frag.glsl" ? depth_frag
         : path == "lit_vert.glsl"   ? lit_vert
         : path == "lit_frag.glsl"   ? lit_frag
         : path == "quad_frag.glsl"  ? quad_frag
                                     : shaders::file(path);
}

static gpu::Shader make_shader(gpu::Device &device, const char *name, const char *vertex_path,
                               const char *fragment_path, std::vector<gpu::ShaderConstant> constants = {})
{
  gpu::ShaderDesc desc;
  desc.name = name;
  desc.vertex_path = vertex_path;
  desc.fragment_path = fragment_path;
  desc.constants = std::move(constants);
  return device.create_shader(desc, shader_file, shader_check::reflect);
}

/**
 * The bias without which a plane shadows itself. Its depth changes by at most the slope from one texel to the next, in
 * x and in y. A lookup reads the middle of a texel, half a texel away from the receiver in x and in y, and PCF one
 * texel further: slopes of 2 * 0.5 and 2 * 1.5. The constant, in last digits of a depth, is for rounding: planes that
 * face the lamp showed none with one digit, at coordinates of some metres.
 */
static gpu::DepthBias least_bias(bool use_pcf)
{
  return {.constant = -4, .slope = use_pcf ? -3.0F : -1.0F};
}

/** Leaves one lamp alight: the first spot. If there is none, the first lamp becomes one, above the scene. */
static void keep_one_spot(scene::Scene &scene)
{
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  if (lamps.empty()) {
    throw gpu::Error("the scene has no lamp");
  }
  const auto spot = std::ranges::find(lamps, scene::LampKind::Spot, &scene::PlacedLamp::kind);
  const scene::PlacedLamp &kept = spot == lamps.end() ? lamps.front() : *spot;
  for (const scene::PlacedLamp &lamp : lamps) {
    const scene::Handle<scene::Lamp> handle = scene.nodes()[lamp.node].lamp;
    scene.edit(handle, [&](scene::Lamp &edited) {
      edited.kind = scene::LampKind::Spot;
      edited.radius = 0;
      edited.range = 0;
      edited.intensity = lamp.node == kept.node ? edited.intensity : 0.0F;
    });
  }
  if (spot == lamps.end()) {
    const glm::dvec3 middle = scene.bounds().center();
    const glm::dvec3 above = middle + glm::dvec3(2, 6, 3);
    scene.set_parent(kept.node, {});
    scene.set_transform(kept.node, glm::inverse(glm::lookAt(above, middle, glm::dvec3(0, 0, -1))));
  }
}

/** Draws one scene: its shadow map, and pictures that look it up. */
class ShadowMapping {
 public:
  ShadowMapping(gpu::Device &device, const scene::Scene &scene, glm::ivec2 size_px)
      : device_(device), render_scene_(device, scene), size_px_(size_px)
  {
    render_scene_.update();
    render_scene_.upload(render_scene::MaterialClass::Plain);
    const scene::PlacedCamera camera = scene.placed_cameras().at(0);
    camera_ = render_scene::view_of(camera, size_px, render_scene_.origin_ws());
    set_lamp();
  }

  /** Returns the pixels of the lit scene. */
  std::vector<std::byte> lit(bool use_pcf, const gpu::DepthBias &bias)
  {
    const gpu::Shader shader = make_shader(device_, use_pcf ? "lit with PCF" : "lit", "lit_vert.glsl", "lit_frag.glsl",
                                           {{"use_pcf", use_pcf ? 1 : 0}});
    draw::Pass pass("lit", gpu::State::WriteColor | gpu::State::WriteDepth | gpu::State::DepthNearerEqual,
                    &render_scene_.objects());
    add_objects(pass, shader);
    gpu::CommandList list;
    draw_depth(list, bias);
    list.begin_pass("lit", picture_framebuffer_, {.is_srgb_encoded = true});
    pass.record(camera_, list);
    list.end_pass();
    device_.submit(list);
    return device_.read(picture_);
  }

  /** Returns the pixels of a quad that shows the distances of the map. White is the scene's furthest point. */
  std::vector<std::byte> distances()
  {
    const gpu::Shader shader = make_shader(device_, "quad", "draw/draw_fullscreen_vert.glsl", "quad_frag.glsl");
    const gpu::Sampler nearest = device_.create_sampler({.name = "nearest"});
    draw::Pass pass("quad", gpu::State::WriteColor);
    draw::ShadingGroup &group = pass.group(shader);
    group.bind_uniform("frame_block", frame_block_);
    group.bind_texture("shadow_map", map_, nearest);
    const int edge_px = std::min(size_px_.x, size_px_.y);
    group.constant("scale", glm::vec2(furthest_, edge_px));
    group.call_procedural();
    gpu::CommandList list;
    draw_depth(list, {});
    list.begin_pass("quad", picture_framebuffer_, {.viewport = {.size_px = glm::ivec2(edge_px)}});
    pass.record(camera_, list);
    list.end_pass();
    device_.submit(list);
    return device_.read(picture_);
  }

 private:
  static constexpr int map_size = 1024;
  static constexpr float near = 0.05F;

  void set_lamp()
  {
    const std::span<const scene::PlacedLamp> lamps = render_scene_.lamps();
    const scene::PlacedLamp &lamp = *std::ranges::find_if(lamps, [](const auto &l) { return l.intensity > 0; });
    // The map encloses the cone, and two texels more, where PCF looks up.
    const float half_width = std::tan(lamp.spot_outer_angle) * float(map_size) / float(map_size - 4);
    lamp_ = draw::View(glm::mat4(glm::affineInverse(lamp.world_from_lamp)),
                       draw::perspective(half_width, half_width, near, std::numeric_limits<float>::infinity()));
    const float cosine = std::cos(lamp.spot_outer_angle);
    const float edge = std::max((1.0F - cosine) * lamp.spot_blend, 1e-6F);
    const FrameData frame{
        camera_.clip_from_world(), lamp_.clip_from_world(), glm::vec4(glm::vec3(lamp.world_from_lamp[3]), cosine),
        glm::vec4(glm::vec3(lamp.world_from_lamp[2]), 1.0F / edge), glm::vec4(lamp.color * lamp.intensity, near)};
    device_.update(frame_block_, frame);
    const scene::Bounds &bounds = render_scene_.bounds();
    const glm::vec3 position(lamp.world_from_lamp[3]);
    furthest_ = float(glm::length(glm::max(glm::abs(bounds.min - position), glm::abs(bounds.max - position))));
  }

  void draw_depth(gpu::CommandList &list, const gpu::DepthBias &bias)
  {
    draw::Pass pass("depth", gpu::State::WriteDepth | gpu::State::DepthNearerEqual, &render_scene_.objects());
    add_objects(pass, depth_shader_);
    list.begin_pass("depth", map_framebuffer_, {.depth_bias = bias});
    pass.record(lamp_, list);
    list.end_pass();
  }

  /** Objects of one material are a group, whose push constants have its colour. */
  void add_objects(draw::Pass &pass, const gpu::Shader &shader)
  {
    for (draw::ObjectIndex i = 0; i < render_scene_.objects().index_end(); i++) {
      if (i == draw::object_identity || !render_scene_.objects().is_live(i)) {
        continue;
      }
      const render_scene::RenderObject &object = render_scene_.object(i);
      const scene::Scene &scene = render_scene_.scene();
      draw::ShadingGroup &group = pass.group(shader);
      group.bind_uniform("frame_block", frame_block_);
      group.bind_texture("shadow_map", map_, comparison_);
      group.constant("base_color", glm::vec4(scene.material_of(scene.meshes()[object.mesh]).base_color, 1.0F));
      group.call(render_scene_.batch(object.mesh, render_scene::MeshStreams::Shape), i);
    }
  }

  gpu::Device &device_;
  render_scene::RenderScene render_scene_;
  glm::ivec2 size_px_;
  draw::View camera_;
  draw::View lamp_;
  /** Metres from the lamp. */
  float furthest_ = 0;
  gpu::Shader depth_shader_ = make_shader(device_, "depth", "depth_vert.glsl", "depth_frag.glsl");
  gpu::Buffer frame_block_ = device_.create_buffer({"frame", gpu::BufferKind::Uniform, sizeof(FrameData)});
  gpu::Sampler comparison_ = device_.create_sampler({.name = "comparison", .is_depth_comparison = true});
  gpu::Texture map_ = device_.create_texture(
      {.name = "shadow map", .format = gpu::Format::Depth32F, .width = map_size, .height = map_size});
  gpu::Framebuffer map_framebuffer_ = device_.create_framebuffer({"shadow map", {}, {&map_}});
  gpu::Texture picture_ = device_.create_texture(
      {.name = "picture", .format = gpu::Format::SRGB8A8, .width = size_px_.x, .height = size_px_.y});
  gpu::Texture depth_ = device_.create_texture(
      {.name = "depth", .format = gpu::Format::Depth32F, .width = size_px_.x, .height = size_px_.y});
  gpu::Framebuffer picture_framebuffer_ = device_.create_framebuffer({"picture", {{&picture_}}, {&depth_}});
};

int main(int argc, char **argv)
try {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::string backend = "auto";
  std::optional<gpu::DepthBias> bias;
  if (arguments.size() >= 2 && arguments[0] == "--backend") {
    backend = arguments[1];
    arguments.erase(arguments.begin(), arguments.begin() + 2);
  }
  if (arguments.size() >= 3 && arguments[0] == "--bias") {
    bias = gpu::DepthBias{std::stof(arguments[1]), std::stof(arguments[2])};
    arguments.erase(arguments.begin(), arguments.begin() + 3);
  }
  if (arguments.size() != 2) {
    std::fprintf(stderr, "usage: shadow_mapping [--backend auto|gl|vulkan] [--bias CONSTANT SLOPE] SCENE FOLDER\n");
    return 2;
  }
  constexpr glm::ivec2 size_px(480, 270);
  scene::Scene scene = gltf::import_gltf(arguments[0]);
  keep_one_spot(scene);
  const auto device =
      gpu::create_device({.backend = gpu::backend_of(backend), .compile_spirv = shader_check::compile_spirv});
  const auto write = [&](const char *name, const std::vector<std::byte> &pixels) {
    write_ppm(arguments[1] + "/" + name, size_px.x, size_px.y, pixels);
  };
  {
    ShadowMapping shadow_mapping(*device, scene, size_px);
    write("hard.ppm", shadow_mapping.lit(false, bias.value_or(least_bias(false))));
    write("pcf.ppm", shadow_mapping.lit(true, bias.value_or(least_bias(true))));
    write("distances.ppm", shadow_mapping.distances());
  }
  eevee::SceneRenderer renderer(*device, scene, size_px, {.sample_count = 1});
  renderer.sync();
  const draw::TargetTexture picture(*device, "picture", gpu::Format::RGBA8, size_px);
  renderer.draw(scene.placed_cameras().at(0), {}, picture.target());
  write("default.ppm", device->read(picture.texture()));
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "shadow_mapping: %s\n", error.what());
  return 1;
}
