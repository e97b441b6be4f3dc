// SPDX-License-Identifier: MIT
#include "internal/eevee_depth.hh"

#include "shadows/shadows.hh"

#include "eevee_gbuffer_shared.h"
#include "render_surfaces.hh"

namespace gnomon::eevee {

using gpu::State;

namespace {

/**
 * Whether the G-buffer can hold the inputs of a surface's lighting: the surface is opaque and has no textures or other
 * inputs.
 */
bool allows_deferred(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return render_scene::MaterialTable::place_of(scene, mesh.material) <= shared::GBUFFER_MATERIAL_MAX &&
         render_scene::material_class(scene, mesh) == render_scene::MaterialClass::Plain &&
         !render_scene::has_surface_function(scene, scene.material_of(mesh)) && !render_scene::is_blended(scene, mesh);
}

/**
 * Whether the scene has deferred lighting: at least half of its meshes allow it. Where forward objects hide deferred
 * ones, pixels are lit twice. Objects are not counted, so that edits of them do not change the programs.
 */
bool is_deferred_scene(const scene::Scene &scene, Feature features)
{
  if (!has(features, Feature::Light) || has(features, Feature::ShadowEsm)) {
    return false;
  }
  std::size_t allowed = 0;
  for (const auto &[handle, mesh] : scene.meshes()) {
    allowed += allows_deferred(scene, mesh) ? 1 : 0;
  }
  return 2 * allowed >= scene.meshes().size();
}

/** All rows, of which this part may light only some. Cascades are fitted to the depths of the whole picture. */
gpu::Rectangle depth_region(const FrameSample &sample)
{
  return sample.awaits_depths || sample.is_transmission_seen ? gpu::Rectangle() : sample.viewport.drawn_region();
}

/** The first pass with the depth texture clears it. */
gpu::LoadAction depth_load(const FrameSample &sample)
{
  return sample.skips_converged ? gpu::LoadAction::Load : gpu::LoadAction::Clear;
}

std::string_view why_in_gbuffer(const FrameState & /*state*/)
{
  return why_forward;
}

}  // namespace

DepthPasses::DepthPasses(draw::ObjectBuffer &objects, const RenderBuffers &buffers, const Shadows &shadows)
    : buffers_(buffers),
      shadows_(shadows),
      depth_pass_("depth_pass", State::WriteDepth | State::DepthNearerEqual, &objects),
      depth_pass_cull_("depth_pass_cull", State::WriteDepth | State::DepthNearerEqual | State::CullBack, &objects),
      gbuffer_pass_("gbuffer_pass", State::WriteColor | State::WriteDepth | State::DepthNearerEqual, &objects)
{
}

bool DepthPasses::awaits(const draw::View &view) const
{
  return shadows_.reads_depths() && !feedback_.is_of(view);
}

void DepthPasses::clear(const scene::Scene &scene, Feature features)
{
  for (draw::Pass *pass : {&depth_pass_, &depth_pass_cull_, &gbuffer_pass_}) {
    pass->clear();
  }
  is_scene_deferred_ = is_deferred_scene(scene, features);
}

bool DepthPasses::is_deferred(const scene::Scene &scene, const render_scene::RenderObject &object) const
{
  return is_scene_deferred_ && object.receives_shadow && allows_deferred(scene, scene.meshes()[object.mesh]);
}

void DepthPasses::record_lighting(gpu::Device &device, ShaderCache &shaders, Feature features, const BindLit &bind)
{
  lighting_pass_.clear();
  if (!has_gbuffer()) {
    return;
  }
  draw::ShadingGroup &group = lighting_pass_.group(shaders.get(device, ShaderId::DeferredLit, features));
  bind(group);
  group.bind_texture("gbuffer", buffers_.radiance, buffers_.nearest);
  group.call_procedural();
}

std::vector<FramePass> DepthPasses::passes() const
{
  return {{&depth_pass_, "two-sided materials",
           [](const FrameState &) { return "no object with a two-sided material outside of the G-buffer"; }},
          {&depth_pass_cull_, "one-sided materials",
           [](const FrameState &) { return "no object with a one-sided material outside of the G-buffer"; }},
          {&gbuffer_pass_, "opaque objects without textures", why_in_gbuffer}};
}

Need DepthPasses::need_gbuffer(const FrameState &state) const
{
  return !state.is_seen  ? Need{false, nothing_seen}
         : has_gbuffer() ? Need{true, "each pixel is lit once"}
                         : Need{false, why_forward};
}

Need DepthPasses::need_prepass(const FrameState &state) const
{
  return !state.is_seen                              ? Need{false, nothing_seen}
         : has_gbuffer() && !shadows_.reads_depths() ? Need{false, "the G-buffer has its own depths"}
                                                     : Need{true, "each pixel is lit once"};
}

Need DepthPasses::need_forward(const FrameState &state) const
{
  const Need need = need_gbuffer(state);
  if (!need.is_needed) {
    return need;
  }
  return depth_pass_.is_empty() && depth_pass_cull_.is_empty() ? Need{false, all_in_gbuffer}
                                                               : Need{true, "objects that are not in the G-buffer"};
}

FrameStep DepthPasses::gbuffer_step()
{
  return {.name = "gbuffer",
          .summary =
              "Normals, materials and depths of plain objects, if at least half of the meshes are plain ([decision "
              "0030](decisions/0030-deferred-lighting.md)).",
          .part = FrameStep::Part::First,
          .need = [this](const FrameState &state) { return need_gbuffer(state); },
          .reads = {"view_block"},
          .writes = {"depth", "radiance"},
          .passes = {passes()[2]},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.main_fb,
                            {.depth_load = depth_load(sample), .scissor = depth_region(sample)});
              },
          .is_read_back = true};
}

FrameStep DepthPasses::prepass_step()
{
  return {.name = "depth_prepass",
          .summary = "Depths of objects outside of the G-buffer, if there is none or cascades are fitted.",
          .part = FrameStep::Part::First,
          .need = [this](const FrameState &state) { return need_prepass(state); },
          .reads = {"view_block"},
          .writes = {"depth"},
          .passes = {passes()[0], passes()[1]},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.depth_fb,
                            {.depth_load = has_gbuffer() ? gpu::LoadAction::Load : depth_load(sample),
                             .scissor = depth_region(sample)});
                if (sample.awaits_depths) {
                  feedback_.request(sample.view);
                }
              },
          .submitted =
              [this](FrameSample &sample) {
                if (sample.awaits_depths) {
                  feedback_.read_back(sample.viewport.device(), sample.viewport.depth_texture());
                }
              },
          .is_read_back = true};
}

FrameStep DepthPasses::lighting_step()
{
  return {.name = "deferred_lit",
          .summary = "Shades the pixels of the G-buffer.",
          .part = FrameStep::Part::Rows,
          .need =
              [this](const FrameState &state) {
                const Need need = need_gbuffer(state);
                return need.is_needed ? Need{true, "pixels of the G-buffer"} : need;
              },
          .reads = deferred_reads(),
          .writes = {"radiance"},
          .passes = {{&lighting_pass_, "pixels of the G-buffer", why_in_gbuffer}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                gpu::PassActions actions = drawn_over(sample.read_region());
                actions.reads_attachments = true;
                record_pass(sample, list, buffers_.main_fb, actions);
              }};
}

FrameStep DepthPasses::forward_step()
{
  return {.name = "forward_depth",
          .summary = "The depth prepass of objects outside of the G-buffer.",
          .part = FrameStep::Part::Rows,
          .need = [this](const FrameState &state) { return need_forward(state); },
          .reads = {"view_block"},
          .writes = {"depth"},
          .passes = {passes()[0], passes()[1]},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.depth_fb,
                            {.depth_load = gpu::LoadAction::Load, .scissor = sample.read_region()});
              }};
}

}  // namespace gnomon::eevee
