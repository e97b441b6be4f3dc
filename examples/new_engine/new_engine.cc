// SPDX-License-Identifier: MIT
// An engine of one's own on the draw manager: it colours each surface by the direction that it faces.
//   new_engine SCENE PICTURE.ppm
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include "draw_pass.hh"
#include "draw_target_pass.hh"
#include "draw_view_shared.h"
#include "render_camera.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <set>
#include <string_view>

using namespace gnomon;

/** The library's files, and the two of this engine. Blocks and attributes have the library's names and slots. */
static std::optional<std::string_view> shader_file(std::string_view path)
{
  if (path == "facing_vert.glsl") {
    return R"(#version 450 core
#include "draw/draw_object_lib.glsl"
#include "draw/draw_view_lib.glsl"
layout(location = ATTRIBUTE_NORMAL) in vec3 normal;
layout(location = 0) out vec3 normal_ws;
void main()
{
  normal_ws = to_normal_ws(normal);
  gl_Position = view.clip_from_world * vertex_position_ws();
})";
  }
  if (path == "facing_frag.glsl") {
    return R"(#version 450 core
layout(location = 0) in vec3 normal_ws;
layout(location = 0) out vec4 radiance;
void main()
{
  radiance = vec4(0.5 + 0.5 * normalize(normal_ws), 1.0);
})";
  }
  return shaders::file(path);
}

class FacingEngine final : public draw::Engine {
 public:
  explicit FacingEngine(render_scene::RenderScene &scene) : scene_(scene) {}

  std::string_view name() const override
  {
    return "facing";
  }

  /** Create the resources that do not depend on objects. All of it is destroyed with the viewport, or by remove_engine.
   */
  void init(draw::Viewport &viewport) override
  {
    Data &data = viewport.engine_data<Data>(*this);
    gpu::Device &device = viewport.device();
    if (!data.view_block) {
      data.surface_shader = shader(device, "facing", "facing_vert.glsl", "facing_frag.glsl");
      data.target_shader = shader(device, "target", "draw/draw_fullscreen_vert.glsl", "draw/draw_target_frag.glsl");
      data.nearest = device.create_sampler({.name = "nearest"});
      data.view_block = device.create_buffer({"view", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
    }
    if (!data.framebuffer) {
      const glm::ivec2 size_px = viewport.drawn_size_px();
      data.radiance = device.create_texture(
          {.name = "radiance", .format = gpu::Format::RGBA16F, .width = size_px.x, .height = size_px.y});
      data.framebuffer = device.create_framebuffer({"facing", {{&data.radiance}}, {&viewport.depth_texture()}});
    }
  }

  void cache_init(draw::Viewport &viewport) override
  {
    viewport.engine_data<Data>(*this).objects.clear();
  }
  void cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer & /*all*/, draw::ObjectIndex object) override
  {
    // After cache_init all objects, otherwise those that have changed.
    viewport.engine_data<Data>(*this).objects.insert(object);
  }
  void cache_finish(draw::Viewport &viewport) override
  {
    // An engine with costlier pictures compares the revisions of the render scene first.
    viewport.restart();
  }

  void draw_scene(draw::Viewport &viewport, const draw::View &view) override
  {
    Data &data = viewport.engine_data<Data>(*this);
    gpu::CommandList list;
    // Also after a failure, which may have lost resources that were made before.
    if (viewport.samples_drawn() == 0) {
      init(viewport);
      record(data);
      shared::ViewData block{};
      block.clip_from_world = view.clip_from_world();
      viewport.device().update(data.view_block, block);
      list.begin_pass("facing", data.framebuffer, {});
      data.surfaces->record(view, list);
      list.end_pass();
    }
    if (const draw::Target &target = viewport.target()) {
      data.target_pass.set(
          data.copy, target,
          {.radiance = data.radiance, .radiance_origin_px = viewport.guard_px(), .size_px = viewport.size_px()},
          data.target_shader, data.nearest);
      draw::begin_pass(list, "target", target, viewport.size_px(), viewport.region(),
                       {.color_load = gpu::LoadAction::Load});
      data.copy.record(view, list);
      list.end_pass();
    }
    viewport.device().submit(list);
  }

 private:
  struct Data final : draw::EngineViewportData {
    void resized() override
    {
      framebuffer = {};
      radiance = {};
    }
    std::set<draw::ObjectIndex> objects;
    gpu::Shader surface_shader;
    gpu::Shader target_shader;
    gpu::Buffer view_block;
    gpu::Sampler nearest;
    gpu::Texture radiance;
    gpu::Framebuffer framebuffer;
    std::optional<draw::Pass> surfaces;
    draw::Pass copy{"copy", gpu::State::WriteColor};
    draw::TargetPass target_pass;
  };

  /** Pass > group > calls. Names of bindings are those of the shader. */
  void record(Data &data)
  {
    scene_.upload(render_scene::MaterialClass::Plain);
    data.surfaces.emplace("surfaces", gpu::State::WriteColor | gpu::State::WriteDepth | gpu::State::DepthNearerEqual,
                          &scene_.objects());
    draw::ShadingGroup &group = data.surfaces->group(data.surface_shader);
    group.bind_uniform("view_block", data.view_block);
    for (const draw::ObjectIndex object : data.objects) {
      group.call(scene_.batch(scene_.object(object).mesh, render_scene::MeshStreams::Shape), object);
    }
  }

  static gpu::Shader shader(gpu::Device &device, const char *name, const char *vertex_path, const char *fragment_path)
  {
    gpu::ShaderDesc desc;
    desc.name = name;
    desc.vertex_path = vertex_path;
    desc.fragment_path = fragment_path;
    return device.create_shader(desc, shader_file, shader_check::reflect);
  }

  render_scene::RenderScene &scene_;
};

int main(int argc, char **argv)
try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: new_engine SCENE PICTURE.ppm\n");
    return 2;
  }
  constexpr glm::ivec2 size_px(320, 180);
  const scene::Scene scene = gltf::import_gltf(argv[1]);
  const auto device = gpu::create_gl_device();
  render_scene::RenderScene render_scene(*device, scene);
  // A host with several engines creates them by name.
  draw::EngineRegistry registry;
  registry.add({"facing", [&] { return std::make_unique<FacingEngine>(render_scene); }});
  const std::unique_ptr<draw::Engine> engine = registry.create("facing");
  const std::array<draw::Engine *, 1> engines = {engine.get()};

  draw::Viewport viewport(*device, size_px);
  render_scene.update();
  viewport.sync(engines, render_scene.objects());
  const draw::TargetTexture picture(*device, "picture", gpu::Format::RGBA8, size_px);
  draw::Target target = picture.target();
  target.view_transform = draw::ViewTransform::Raw;
  viewport.draw(engines, render_scene::view_of(scene.placed_cameras().front(), size_px, render_scene.origin_ws()),
                target);
  write_ppm(argv[2], size_px.x, size_px.y, device->read(picture.texture()));
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "new_engine: %s\n", error.what());
  return 1;
}
