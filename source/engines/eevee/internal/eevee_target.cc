// SPDX-License-Identifier: MIT
#include "internal/eevee_target.hh"
#include "internal/eevee_resource_report.hh"

namespace gnomon::eevee {

void TargetOutput::resized()
{
  picture_depth_fb_ = {};
  picture_depth_ = {};
  target_pass_.reset();
}

void TargetOutput::clear()
{
  pass_.clear();
  target_pass_.reset();
}

void TargetOutput::record(draw::Viewport &viewport, const draw::View &view, ShaderCache &shaders,
                          const Settings &settings, bool has_blended)
{
  gpu::Device &device = viewport.device();
  const bool has_own_depth = target_.depth && settings.sample_count != 1;
  if (has_own_depth && !picture_depth_) {
    picture_depth_ = create_target(device, "picture_depth", gpu::Format::Depth32F, viewport.drawn_size_px());
    picture_depth_fb_ =
        device.create_framebuffer({.name = "picture_depth_fb", .colors = {}, .depth = {&picture_depth_}});
  }
  target_pass_.set(pass_, target_,
                   {.radiance = film_.texture(),
                    .size_px = viewport.size_px(),
                    .scale = film_.scale(settings, film_.sample_count()),
                    .depth = has_own_depth ? &picture_depth_ : &viewport.depth_texture(),
                    .depth_origin_px = viewport.guard_px(),
                    .clip_from_view = view.clip_from_view(),
                    .has_blended = has_blended},
                   shaders.get(device, ShaderId::Tonemap, target_.depth ? Feature::TargetDepth : Feature::None),
                   buffers_.nearest);
}

Need TargetOutput::need_depth(const FrameState &state) const
{
  if (!target_.depth) {
    return {false, "no target takes depth"};
  }
  if (state.settings.sample_count == 1) {
    return {false, "the depth of the only sample is that of the picture"};
  }
  return !state.is_seen       ? Need{false, nothing_seen}
         : has_picture_depth_ ? Need{false, "it is up to date"}
                              : Need{true, "the target takes depth, without the samples' offsets"};
}

Need TargetOutput::need(const FrameState &state) const
{
  if (!target_) {
    return {false, "no target was given"};
  }
  if (state.is_seen) {
    return {true, "a target was given"};
  }
  return target_.composition == draw::Composition::Over
             ? Need{false, nothing_seen}
             : Need{true, "nothing is seen: the target's rectangle is cleared"};
}

void TargetOutput::draw_depth(FrameSample &sample, gpu::CommandList &list)
{
  const shared::ViewData block =
      view_data(sample.view, sample.viewport, sample.settings, sample.index, sample.bounds_ws);
  list.update(buffers_.view_block, 0, std::as_bytes(std::span(&block, 1)));
  list.begin_pass("picture_depth", picture_depth_fb_, {.scissor = sample.viewport.drawn_region()});
  record_calls(sample, sample.view, list);
  list.end_pass();
}

void TargetOutput::draw(FrameSample &sample, gpu::CommandList &list) const
{
  // A picture without visible objects is transparent black. Every view transform keeps black, so that a clear suffices.
  const gpu::LoadAction load = sample.is_seen ? gpu::LoadAction::Load : gpu::LoadAction::Clear;
  draw::begin_pass(
      list, "tonemap", target_, sample.viewport.size_px(), sample.viewport.region(),
      {.color_load = load,
       .depth_load = target_.depth ? load : gpu::LoadAction::Load,
       .clear_depth = target_.depth ? draw::depth_map(sample.view.clip_from_view(), *target_.depth).background : 0.0F});
  record_calls(sample, sample.view, list);
  list.end_pass();
}

FrameStep TargetOutput::depth_step(std::vector<FramePass> passes)
{
  return {.name = "picture_depth",
          .summary = "Depths without the sample's offset, if the target takes depth.",
          .when = FrameStep::When::EachTarget,
          .part = FrameStep::Part::Each,
          .need = [this](const FrameState &state) { return need_depth(state); },
          .writes = {"view_block", "picture_depth"},
          .passes = std::move(passes),
          .record = [this](FrameSample &sample, gpu::CommandList &list) { draw_depth(sample, list); },
          .submitted = [this](FrameSample &) { has_picture_depth_ = true; }};
}

FrameStep TargetOutput::step()
{
  return {.name = "tonemap",
          .summary = "Exposure, view transform and depth in the target's rectangle.",
          .when = FrameStep::When::EachTarget,
          .part = FrameStep::Part::Each,
          .need = [this](const FrameState &state) { return need(state); },
          .reads = {"film",
                    {"depth",
                     {},
                     [this](const FrameState &state) { return target_.depth && state.settings.sample_count == 1; }},
                    {"picture_depth",
                     {},
                     [this](const FrameState &state) { return target_.depth && state.settings.sample_count != 1; }}},
          .writes = {"target"},
          .passes = {{&pass_, "a target was given"}},
          .record = [this](FrameSample &sample, gpu::CommandList &list) { draw(sample, list); }};
}

void TargetOutput::report(ResourceReport &report) const
{
  report.targets.push_back({.what = "target",
                            .is_made = bool(target_),
                            .why = target_ ? "the target of the last draw" : "no target was given"});
  report.add_target(picture_depth_, "picture_depth", "the target takes depth",
                    "no target takes the depth of several samples");
}

}  // namespace gnomon::eevee
