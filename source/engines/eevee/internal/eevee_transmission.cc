// SPDX-License-Identifier: MIT
#include "internal/eevee_transmission.hh"
#include "internal/eevee_resource_report.hh"

#include <algorithm>
#include <bit>

namespace gnomon::eevee {

Need need_of_transmission(const FrameState &state, bool is_needed, std::string_view why, std::string_view why_not)
{
  if (!state.is_seen) {
    return {false, nothing_seen};
  }
  if (!state.is_transmission_seen) {
    return {false, !state.has_transmission ? "no material that is drawn transmits light"
                                           : "nothing in the view transmits light"};
  }
  return {is_needed, is_needed ? why : why_not};
}

Transmission::Transmission(draw::ObjectBuffer &objects, const RenderBuffers &buffers)
    : buffers_(buffers),
      depth_pass_("transmission_depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual, &objects),
      pass_("transmission_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects)
{
}

void Transmission::make(draw::Viewport &viewport, bool is_rough)
{
  const glm::ivec2 size_px = viewport.drawn_size_px();
  const int levels = is_rough ? std::bit_width(unsigned(std::max(size_px.x, size_px.y))) : 1;
  if (behind_ && behind_.desc().mip_levels == levels) {
    return;
  }
  gpu::Device &device = viewport.device();
  behind_ = device.create_texture({.name = "behind",
                                   .format = buffers_.radiance.desc().format,
                                   .width = size_px.x,
                                   .height = size_px.y,
                                   .mip_levels = levels});
  behind_depth_ = create_target(device, "behind_depth", viewport.depth_texture().desc().format, size_px);
  sampler_ =
      device.create_sampler({.name = "behind_sampler", .filter = gpu::Filter::Linear, .mip = gpu::MipFilter::Nearest});
}

void Transmission::free()
{
  behind_ = {};
  behind_depth_ = {};
  bodies_.free();
}

void Transmission::update(const render_scene::RenderScene &scene, std::span<const TransmissiveObject> objects,
                          const Settings &settings, const SceneWorld &world)
{
  if (behind_) {
    bodies_.update(scene, objects, hidden_, settings, world, {behind_.id(), sampler_.id()});
  }
}

void Transmission::clear()
{
  depth_pass_.clear();
  pass_.clear();
}

void Transmission::bind(draw::ShadingGroup &group) const
{
  if (behind_) {
    group.bind_texture("behind", behind_, sampler_);
    group.bind_texture("behind_depth", behind_depth_, buffers_.nearest);
    bodies_.bind(group);
  }
}

static std::string_view why_empty(const FrameState & /*state*/)
{
  return "no object that is not blended transmits light";
}

FramePass Transmission::depths() const
{
  return {&depth_pass_, "the nearest surface alone is seen", why_empty};
}

FrameStep Transmission::copy_step()
{
  return {.name = "behind",
          .summary = "Copies of the radiance, with mip levels, and of the depth, if a visible surface transmits light.",
          .part = FrameStep::Part::Rows,
          .need =
              [](const FrameState &state) {
                return need_of_transmission(state, true, "what is behind surfaces that transmit light", "");
              },
          .reads = {"radiance", "depth"},
          .writes = {"behind", "behind_depth"},
          .work =
              [this](FrameSample &sample) {
                gpu::Device &device = sample.viewport.device();
                device.copy_layers(buffers_.radiance, behind_);
                device.copy_layers(sample.viewport.depth_texture(), behind_depth_);
                if (behind_.desc().mip_levels > 1) {
                  device.generate_mipmaps(behind_);
                }
              }};
}

FrameStep Transmission::step()
{
  return {.name = "transmission",
          .summary = "The nearest surfaces that transmit light show the copy at the ends of their rays.",
          .part = FrameStep::Part::Rows,
          .need =
              [this](const FrameState &state) {
                return need_of_transmission(state, !pass_.is_empty(), "surfaces that transmit light",
                                            "all that transmits light is blended");
              },
          .reads = forward_reads({"behind", "behind_depth"}),
          .writes = {"depth", "radiance"},
          .passes = {depths(), {&pass_, "objects in the view", why_empty}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.main_fb, drawn_over(sample.viewport.part_region()));
              }};
}

void Transmission::report(ResourceReport &report) const
{
  report.add_target(behind_, "behind", "what is seen through surfaces", report.why_no_feature(Feature::Transmission));
  report.add_target(behind_depth_, "behind_depth", "where rays end", report.why_no_feature(Feature::Transmission));
  bodies_.report(report);
}

}  // namespace gnomon::eevee
