// SPDX-License-Identifier: MIT
#include "unlit_engine.hh"

#include "internal/unlit_engine_data.hh"
#include "unlit_depth_camera.hh"
#include "unlit_interfaces.hh"

#include "draw_view_shared.h"
#include "gpu_framebuffer_stack.hh"
#include "render_camera.hh"
#include "shader_files.hh"

#include <algorithm>
#include <map>
#include <span>

namespace gnomon::unlit {

using gpu::State;
using render_scene::MaterialClass;

namespace {

gpu::Buffer create_view_block(gpu::Device &device, const char *name)
{
  return device.create_buffer({name, gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
}

/** Writes clip_from_world and clip_planes. A texture_lod_bias of 0 suits one sample; only lit surfaces read the other
 * members. */
void update_view_block(gpu::Device &device, const gpu::Buffer &block, const draw::View &view, glm::ivec2 size_px)
{
  shared::ViewData data{};
  data.clip_from_world = view.clip_from_world();
  draw::set_clip_planes(data, view, {{0, 0}, size_px});
  device.update(block, data);
}

}  // namespace

static PictureKey picture_key(render_scene::RenderScene &scene, std::uint64_t settings, const Data &data)
{
  return {.scene = scene.revision(), .settings = settings, .display = data.display};
}

Engine::Engine(render_scene::RenderScene &scene, const Settings &settings) : scene_(scene), settings_(settings) {}

Engine::~Engine() = default;

const gpu::Shader &Engine::shader(gpu::Device &device, ShaderId id, Feature features)
{
  const ShaderDeclaration &declaration = shader_declarations()[std::size_t(id)];
  const Feature variant = features & declaration.features;
  std::shared_ptr<gpu::SharedShader> &shared = shaders_[{id, variant}];
  if (!shared || !shared->shader) {
    const gpu::ShaderDesc desc = shader_desc(declaration, variant);
    shared = device.shared_shader(desc, {}, [&](gpu::SharedShader &made) {
      made.shader =
          device.create_shader(desc, shaders::file, [&](std::string_view, const std::vector<gpu::ShaderSource> &) {
            return interface_tables()[std::size_t(id)].interface_of(std::uint32_t(variant));
          });
    });
  }
  return shared->shader;
}

void Engine::set_display(draw::Viewport &viewport, const Display &display)
{
  if (display.is_wireframe && !viewport.device().limits().has_wireframe) {
    throw gpu::Error("unlit: the device draws no edges of triangles: its Vulkan has no fillModeNonSolid");
  }
  viewport.engine_data<Data>(*this).display = display;
}

void Engine::init(draw::Viewport &viewport)
{
  if (settings_.depth_size_px.x < 1 || settings_.depth_size_px.y < 1) {
    throw gpu::Error("unlit: a depth camera's picture of {}x{} pixels is not at least 1x1", settings_.depth_size_px.x,
                     settings_.depth_size_px.y);
  }
  viewport.engine_data<Data>(*this);
}

void Engine::cache_init(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  data.objects.clear();
  data.is_collecting = true;
}

void Engine::cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object)
{
  Data &data = viewport.engine_data<Data>(*this);
  if (data.is_collecting) {
    data.objects.push_back(object);
  }
  else if (object < data.is_mirrored.size()) {
    data.is_winding_changed |= data.is_mirrored[object] != objects.is_mirrored(object);
  }
}

void Engine::cache_finish(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  data.is_collecting = false;
  const PictureKey picture = picture_key(scene_, settings_revision_, data);
  if (data.synced_picture != picture) {
    data.synced_picture = picture;
    viewport.scene_changed();
  }
}

void Engine::draw_scene(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  if (!data.synced_picture) {
    throw gpu::Error("unlit: nothing to draw, as the viewport was not synced");
  }
  if (!scene_.is_up_to_date()) {
    throw gpu::Error(
        "unlit: the scene was edited since the last update: call RenderScene::update and "
        "draw::Viewport::sync before draw");
  }
  if (data.synced_picture != picture_key(scene_, settings_revision_, data)) {
    throw gpu::Error(
        "unlit: the scene or the settings changed since the last sync of the viewport: call "
        "draw::Viewport::sync before draw");
  }
  if (viewport.samples_drawn() == 0) {
    draw_sample(viewport, data, view);
  }
  const draw::Target &target = viewport.target();
  if (!target) {
    return;
  }
  const Feature features = target.depth ? Feature::TargetDepth : Feature::None;
  data.target_pass.set(data.target, target,
                       {.radiance = data.radiance,
                        .radiance_origin_px = viewport.guard_px(),
                        .size_px = viewport.size_px(),
                        .depth = &viewport.depth_texture(),
                        .depth_origin_px = viewport.guard_px(),
                        .clip_from_view = view.clip_from_view(),
                        .has_blended = !data.blended.empty()},
                       shader(viewport.device(), ShaderId::Target, features), data.nearest);
  // A picture without visible objects is transparent black. Every view transform keeps black, so that a clear suffices.
  const gpu::LoadAction load = data.is_seen ? gpu::LoadAction::Load : gpu::LoadAction::Clear;
  gpu::CommandList list;
  draw::begin_pass(
      list, "unlit target", target, viewport.size_px(), viewport.region(),
      {.color_load = load,
       .depth_load = target.depth ? load : gpu::LoadAction::Load,
       .clear_depth = target.depth ? draw::depth_map(view.clip_from_view(), *target.depth).background : 0.0F});
  if (data.is_seen) {
    data.target.record(view, list);
  }
  list.end_pass();
  viewport.device().submit(list);
}

/** If the depth camera's render texture is out of date, it is drawn as a nested pass within the viewport's pass. */
void Engine::draw_sample(draw::Viewport &viewport, Data &data, const draw::View &view)
{
  gpu::Device &device = viewport.device();
  if (!data.framebuffer) {
    data.radiance = device.create_texture({.name = "unlit_radiance",
                                           .format = gpu::Format::RGBA16F,
                                           .width = viewport.drawn_size_px().x,
                                           .height = viewport.drawn_size_px().y});
    data.framebuffer = device.create_framebuffer(
        {.name = "unlit_fb", .colors = {{&data.radiance}}, .depth = {&viewport.depth_texture()}});
    data.view_block = create_view_block(device, "unlit_view_block");
    data.nearest = device.create_sampler({.name = "unlit_nearest"});
    data.recorded = {};
  }
  data.visible.update(view, scene_.objects());
  data.is_seen =
      std::ranges::any_of(data.objects, [&](draw::ObjectIndex object) { return data.visible.contains(object); });
  gpu::CommandList list;
  gpu::FramebufferStack stack(list);
  DepthKey depth{
      scene_.objects().revision(), scene_.passes_revision(), device.loss_count(), scene_.content_revision(), {}};
  bool is_depth_drawn = false;
  if (data.is_seen) {
    update_depth_camera(device, data.objects);
    data.is_clipped = !view.clip_planes().empty();
    record(data, device);
    update_view_block(device, data.view_block, view, viewport.drawn_size_px());
    if (depth_camera_) {
      depth.view = depth_camera_->view;
      is_depth_drawn = depth_camera_->drawn != depth;
    }
  }
  stack.push("unlit", data.framebuffer, {.scissor = viewport.drawn_region()});
  if (is_depth_drawn) {
    stack.push("unlit depth camera", depth_camera_->framebuffer, {});
    depth_camera_->casters->record(depth_camera_->view, list);
    stack.pop();
  }
  if (data.is_seen) {
    data.surfaces->record(view, data.visible, list);
    order_blended(data, view);
    data.blended_surfaces->record(view, data.visible, list);
  }
  stack.pop();
  device.submit(list);
  if (is_depth_drawn) {
    depth_camera_->drawn = depth;
  }
}

/** The view of the depth camera: that of the settings, or of the first lamp that has one. */
static std::optional<draw::View> depth_view(const render_scene::RenderScene &scene, const Settings &settings)
{
  if (settings.has_shadow && settings.depth_camera) {
    return render_scene::view_of(*settings.depth_camera, settings.depth_size_px, scene.origin_ws());
  }
  if (settings.has_shadow) {
    // Lamps and bounds are already relative to the origin of the render scene.
    for (const scene::PlacedLamp &lamp : scene.lamps()) {
      if (const auto camera = depth_camera_of(lamp, scene.bounds())) {
        return render_scene::view_of(*camera, settings.depth_size_px);
      }
    }
  }
  return std::nullopt;
}

/** Record the casters among \a objects. */
void Engine::record_casters(gpu::Device &device, std::span<const draw::ObjectIndex> objects)
{
  DepthCamera &camera = *depth_camera_;
  camera.casters.emplace("unlit depth camera", State::WriteDepth | State::DepthNearerEqual, &scene_.objects());
  std::map<std::pair<MaterialClass, render_scene::TextureSet>, draw::ShadingGroup *> groups;
  for (const draw::ObjectIndex index : objects) {
    const render_scene::RenderObject &object = scene_.object(index);
    const scene::Mesh &mesh = scene_.scene().meshes()[object.mesh];
    if (!object.casts_shadow || mesh.topology != scene::Topology::Triangles ||
        render_scene::lets_light_through(scene_.scene(), mesh)) {
      continue;
    }
    const MaterialClass cut_out = render_scene::mask_class(scene_.scene(), mesh);
    const render_scene::TextureSet textures = render_scene::textures_of(
        scene_.scene(), mesh, cut_out == MaterialClass::Plain ? cut_out : MaterialClass::BaseColor);
    draw::ShadingGroup *&group = groups[{cut_out, textures}];
    if (!group) {
      group = &camera.casters->group(shader(device, ShaderId::Depth, mask_features(cut_out)));
      group->bind_uniform("view_block", camera.view_block);
      camera.blocks.bind(*group);
      render_scene::bind_textures(*group, scene_, cut_out, textures);
    }
    group->call(scene_.batch(object.mesh, render_scene::streams_of(cut_out)), index);
  }
}

/** Update the view, the texture and the passes of the depth camera as far as their inputs changed. */
void Engine::update_depth_camera(gpu::Device &device, std::span<const draw::ObjectIndex> objects)
{
  const std::optional<draw::View> view = depth_view(scene_, settings_);
  if (!view) {
    depth_camera_.reset();
    return;
  }
  if (!depth_camera_) {
    depth_camera_ = std::make_unique<DepthCamera>();
  }
  DepthCamera &camera = *depth_camera_;
  camera.view = *view;
  const glm::ivec2 size_px = settings_.depth_size_px;
  if (!camera.texture || camera.texture.desc().width != size_px.x || camera.texture.desc().height != size_px.y) {
    camera.drawn.reset();
    camera.framebuffer = {};
    camera.texture = device.create_texture(
        {.name = "unlit_depth_camera", .format = gpu::Format::Depth32F, .width = size_px.x, .height = size_px.y});
    camera.framebuffer =
        device.create_framebuffer({.name = "unlit_depth_camera_fb", .colors = {}, .depth = {&camera.texture}});
    camera.view_block = create_view_block(device, "unlit_depth_view_block");
  }
  update_view_block(device, camera.view_block, camera.view, size_px);
  const PassesKey key{.structure = scene_.objects().structure_revision(),
                      .passes = scene_.passes_revision(),
                      .settings = settings_revision_,
                      .losses = device.loss_count(),
                      .depth_texture = camera.texture.id()};
  if (camera.recorded == key) {
    return;
  }
  camera.recorded = {};
  record_casters(device, objects);
  camera.recorded = key;
}

const gpu::Texture &Engine::radiance(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  if (!data.radiance) {
    throw gpu::Error("unlit: the viewport has no picture: call draw::Viewport::draw before radiance");
  }
  return data.radiance;
}

const gpu::Texture *Engine::depth_camera_texture() const
{
  return depth_camera_ ? &depth_camera_->texture : nullptr;
}

draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings)
{
  return {"unlit", [&scene, settings] { return std::make_unique<Engine>(scene, settings); }};
}

}  // namespace gnomon::unlit
