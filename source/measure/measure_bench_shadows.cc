// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include "eevee_shaders.hh"
#include "shadows/shadow_casters.hh"
#include "shadows/shadow_cube.hh"
#include "shadows/shadow_plan.hh"
#include "shadows/shadows.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cmath>
#include <memory>

namespace gnomon::measure {

namespace {

constexpr std::array<LayerPassVariant, 4> variants = {{
    {"culled", "one pass for each face, whose view culls all casters (no face masks)", eevee::LayerPass::Single, true},
    {"six", "--cube-pass six: one pass for each face, with face masks computed once for each lamp",
     eevee::LayerPass::Single},
    {"geometry", "--cube-pass geometry: one pass, the geometry shader selects the layer", eevee::LayerPass::Geometry},
    {"layered", "--cube-pass layered: one pass, the vertex shader selects the layer", eevee::LayerPass::Layered},
}};

/** Casters on a grid, a metre apart, and a point lamp in their middle, drawn by one variant. */
class LampBench {
 public:
  LampBench(gpu::Device &device, const std::vector<gpu::Batch> &batches, int caster_count,
            const LayerPassVariant &variant)
      : device_(device), variant_(variant)
  {
    settings_.layer_pass = variant.layer_pass;
    lamp_.name = "lamp";
    lamp_.kind = scene::LampKind::Point;
    add_casters(batches, caster_count);
    prepare(0);
    if (variant_.is_culled_by_view) {
      create_faces();
    }
  }

  /** Moves the lamp, so that all its layers must be drawn. Not measured: the cost is the same for all variants. */
  void prepare(int round)
  {
    lamp_.world_from_lamp[3].x = round % 2 == 0 ? 0.0 : double(1e-3F);
    if (variant_.is_culled_by_view) {
      return;
    }
    const std::span<const scene::PlacedLamp> placed(&lamp_, 1);
    eevee::Lamps lamps = eevee::make_lamps(placed);
    scene_shadows_.sync(device_.limits(), eevee::shadow_lamps(placed, lamps), {}, lamps.lights, settings_);
    scene_shadows_.allocate(device_, shaders_);
    shadows_.allocate(device_);
    for (const eevee::Caster &caster : casters_) {
      scene_shadows_.add_caster(caster);
    }
    scene_shadows_.finish();
  }

  /** Draws the layers. Measured. */
  void draw()
  {
    gpu::CommandList list;
    if (variant_.is_culled_by_view) {
      record_faces(list);
    }
    else {
      shadows_.update(device_, view_, 1e-3F, pass_, list);
    }
    device_.submit(list);
    shadows_.submitted();
  }

 private:
  void add_casters(const std::vector<gpu::Batch> &batches, int caster_count)
  {
    using eevee::ShaderId;
    const ShaderId id = variant_.layer_pass == eevee::LayerPass::Layered    ? ShaderId::ShadowLayered
                        : variant_.layer_pass == eevee::LayerPass::Geometry ? ShaderId::ShadowGeometry
                                                                            : ShaderId::Shadow;
    draw::ShadingGroup &group = pass_.group(shaders_.get(device_, id));
    group.bind_storage_ref("object_block", &object_block_);
    group.bind_uniform_ref("shadow_render_block",
                           variant_.is_culled_by_view ? &face_block_ : scene_shadows_.render_block());
    std::vector<draw::InstanceCall *> calls;
    if (!variant_.is_culled_by_view) {
      for (const gpu::Batch &batch : batches) {
        calls.push_back(&group.instances(batch));
      }
    }
    const int edge = int(std::ceil(std::cbrt(double(caster_count))));
    for (int i = 0; i < caster_count; i++) {
      // Relative to the middle of each axis. The offset keeps casters away from the lamp.
      const glm::vec3 cell(i % edge, i / edge % edge, i / edge / edge);
      const glm::vec3 position = cell - 0.5F * float(edge - 1) + glm::vec3(0.25F, 0.35F, 0.45F);
      const draw::ObjectIndex object = objects_.add(glm::translate(glm::mat4(1.0F), position));
      eevee::Caster &caster = casters_.emplace_back();
      caster.bounds_ws.extend(position - 0.3F);
      caster.bounds_ws.extend(position + 0.3F);
      caster.object = object;
      caster.fingerprint = std::uint64_t(i);
      // Casters of one mesh are consecutive, so that their calls become one draw with culling, too.
      const auto mesh = std::size_t(std::int64_t(i) * bench_mesh_count / caster_count);
      if (variant_.is_culled_by_view) {
        group.call(batches[mesh], object, {position, caster.bounds_ws.radius()});
      }
      else {
        caster.instances = calls[mesh];
      }
    }
    objects_.upload(device_);
    object_block_ = {objects_.buffer().id()};
    // The view contains all casters, so that no face is skipped.
    const float reach = 2.0F * float(edge);
    view_ = draw::View(glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, -reach)),
                       draw::orthographic(reach, reach, 0.0F, 2.0F * reach));
  }

  void create_faces()
  {
    faces_ = device_.create_texture({.name = "faces",
                                     .kind = gpu::TextureKind::Array,
                                     .format = gpu::Format::Depth32F,
                                     .width = settings_.cube_size_px,
                                     .height = settings_.cube_size_px,
                                     .layers = 6});
    for (int face = 0; face < 6; face++) {
      framebuffers_.push_back(
          device_.create_framebuffer({.name = "face", .colors = {}, .depth = {.texture = &faces_, .layer = face}}));
    }
    const std::uint32_t alignment = device_.limits().uniform_offset_alignment;
    stride_ = (std::uint32_t(sizeof(shared::ShadowRenderBlock)) + alignment - 1) / alignment * alignment;
    face_blocks_ = device_.create_buffer({"face_blocks", gpu::BufferKind::Storage, std::size_t(6) * stride_});
  }

  void record_faces(gpu::CommandList &list)
  {
    const glm::vec3 position_ws(lamp_.world_from_lamp[3]);
    const auto views = eevee::shadow_cube_views(position_ws, 0.05F, settings_.cube_size_px);
    for (std::uint32_t face = 0; face < 6; face++) {
      face_block_ = {face_blocks_.id(), face * stride_, sizeof(shared::ShadowRenderBlock)};
      shared::ShadowRenderBlock block{};
      block.clip_from_world[0] = views[face].clip_from_world();
      block.size_px = float(settings_.cube_size_px);
      list.update(face_blocks_, face_block_.offset_bytes, std::as_bytes(std::span(&block, 1)));
      list.begin_pass("face", framebuffers_[face], {});
      pass_.record(views[face], list);
      list.end_pass();
    }
  }

  gpu::Device &device_;
  const LayerPassVariant &variant_;
  eevee::ShadowSettings settings_;
  scene::PlacedLamp lamp_;
  eevee::ShaderCache shaders_;
  eevee::SceneShadows scene_shadows_;
  eevee::Shadows shadows_{scene_shadows_};
  draw::ObjectBuffer objects_;
  gpu::BufferRange object_block_;
  // The state of the engine's shadow pass.
  draw::Pass pass_{"shadow_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::DepthClamp};
  draw::View view_;
  std::vector<eevee::Caster> casters_;
  gpu::Texture faces_;
  std::vector<gpu::Framebuffer> framebuffers_;
  gpu::Buffer face_blocks_;
  gpu::BufferRange face_block_;
  std::uint32_t stride_ = 0;
};

}  // namespace

std::span<const LayerPassVariant> layer_pass_variants()
{
  return variants;
}

std::vector<LayerPassCost> measure_layer_passes(gpu::Device &device, int caster_count, int rounds, Clock clock)
{
  const std::vector<gpu::Batch> batches = column_batches(device);
  std::vector<std::unique_ptr<LampBench>> benches;
  std::vector<LayerPassCost> rows;
  for (const LayerPassVariant &variant : variants) {
    const bool is_there = variant.layer_pass == eevee::LayerPass::Layered    ? device.limits().has_vertex_layer
                          : variant.layer_pass == eevee::LayerPass::Geometry ? device.limits().has_geometry_shader
                                                                             : true;
    if (is_there) {
      benches.push_back(std::make_unique<LampBench>(device, batches, caster_count, variant));
      rows.push_back({&variant, {}, {}});
    }
  }
  // The first warms up.
  for (int round = 0; round <= rounds; round++) {
    for (std::size_t i = 0; i < rows.size(); i++) {
      benches[i]->prepare(round + 1);
      device.finish();
      const gpu::Counters before = device.counters();
      const double start = now(clock);
      benches[i]->draw();
      device.finish();
      if (round > 0) {
        rows[i].seconds.push_back(now(clock) - start);
      }
      const gpu::Counters &after = device.counters();
      rows[i].counters.passes = after.passes - before.passes;
      rows[i].counters.draws = after.draws - before.draws;
      rows[i].counters.instances = after.instances - before.instances;
    }
  }
  return rows;
}

}  // namespace gnomon::measure
