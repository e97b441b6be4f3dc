// SPDX-License-Identifier: MIT
#include "internal/eevee_frame.hh"

#include "trace.hh"

#include <algorithm>
#include <array>
#include <utility>

namespace gnomon::eevee {

void record_calls(FrameSample &sample, const draw::View &view, gpu::CommandList &list)
{
  DrawnStep &drawn = *sample.step;
  // A picture without visible objects and without a background is only cleared.
  for (std::size_t i = 0; sample.is_seen && i < drawn.passes.size(); i++) {
    const draw::RecordCounts counts = drawn.step.passes[i].pass->record(view, sample.visible, list);
    drawn.passes[i].runs += counts.drawn > 0 ? 1 : 0;
    drawn.passes[i].counts.drawn += counts.drawn;
    drawn.passes[i].counts.culled += counts.culled;
  }
}

void record_pass(FrameSample &sample, gpu::CommandList &list, const gpu::Framebuffer &framebuffer,
                 const gpu::PassActions &actions)
{
  list.begin_pass(sample.step->step.name, framebuffer, actions);
  record_calls(sample, sample.sample_view, list);
  list.end_pass();
}

/** Whether \a part of a sample draws a step with \a step. */
static bool is_in_part(FrameStep::Part step, const draw::SamplePart &part)
{
  switch (step) {
    case FrameStep::Part::First: return part.is_first;
    case FrameStep::Part::Rows: return part.row_count > 0;
    case FrameStep::Part::Last: return part.is_last;
    case FrameStep::Part::Each: break;
  }
  return true;
}

/** Whether lists read the light of all lamps. If objects are tinted and not lit, lists read the tinted lamp alone. */
static bool reads_all_lights(const FrameState &state)
{
  return !state.settings.has_cascade_tint;
}

std::vector<FrameRead> deferred_reads()
{
  return {"depth",
          "view_block",
          {"light_block", "lights"},
          {"light_texture", "lights", reads_all_lights},
          {"light_cluster_block", "lights", reads_all_lights},
          {"light_lists", "lights", reads_all_lights},
          {"world_block", "lights", reads_all_lights},
          {"shadow_cubes", "shadows"},
          {"shadow_maps", "shadows"}};
}

std::vector<FrameRead> forward_reads(std::initializer_list<FrameRead> more)
{
  std::vector<FrameRead> reads = deferred_reads();
  reads.insert(reads.end(), {{"shadow_esm", "shadows"}, {"shadow_esm_half", "shadows"}, {"shadow_evsm", "shadows"}});
  reads.insert(reads.end(), more);
  return reads;
}

std::string_view why_no_shadow(const FrameState &state, std::string_view no_such_lamp)
{
  if (state.settings.shadow.kind == scene::ShadowKind::None) {
    return "shadows are off";
  }
  return has(state.features, Feature::Light) ? no_such_lamp : "no lamp gives light";
}

std::string_view reason_of(const FramePass &pass, const DrawnStep::PassRecord &record, const FrameState &state)
{
  if (record.runs > 0) {
    return pass.purpose;
  }
  if (!state.is_seen) {
    return nothing_seen;
  }
  return !pass.pass->is_empty() ? "none of its objects is in the view"
         : pass.why_empty       ? pass.why_empty(state)
                                : nothing_seen;
}

Frame::Frame(std::vector<FrameStep> steps)
{
  for (FrameStep &step : steps) {
    DrawnStep &drawn = steps_.emplace_back();
    drawn.passes.resize(step.passes.size());
    drawn.step = std::move(step);
  }
#ifndef NDEBUG
  for (const DrawnStep &drawn : steps_) {
    for (const FrameRead &read : drawn.step.reads) {
      const bool is_written = std::ranges::any_of(
          steps_, [&](const DrawnStep &other) { return std::ranges::count(other.step.writes, read.name) > 0; });
      GNOMON_ASSERT(is_written, "step '{}' names '{}', which no step writes", drawn.step.name, read.name);
    }
  }
#endif
}

void Frame::begin_picture()
{
  for (DrawnStep &drawn : steps_) {
    drawn.need.reset();
    std::ranges::fill(drawn.passes, DrawnStep::PassRecord());
  }
}

bool Frame::is_current(const gpu::Device &device) const
{
  return std::ranges::all_of(steps_, [&](const DrawnStep &drawn) {
    return std::ranges::all_of(drawn.step.passes, [&](const FramePass &pass) { return pass.pass->is_current(device); });
  });
}

void Frame::draw(FrameSample &sample, FrameStep::When when)
{
  gpu::Device &device = sample.viewport.device();
  for (DrawnStep &drawn : steps_) {
    const FrameStep &step = drawn.step;
    if (step.when != when || !is_in_part(step.part, sample.viewport.part()) ||
        (sample.is_for_feedback && !step.is_read_back)) {
      continue;
    }
    const Need need = step.need(sample);
    if (need.is_needed || !drawn.need || !drawn.need->is_needed) {
      drawn.need = need;
    }
    if (!need.is_needed) {
      continue;
    }
    const trace::Span span(step.name);
    sample.step = &drawn;
    gpu::CommandList &list = device.add_list();
    if (step.record) {
      step.record(sample, list);
    }
    // Without commands, every shadow layer was up to date.
    const bool has_commands = !list.commands().empty();
    const bool is_timed = sample.settings.is_timed && (has_commands || step.work);
    if (is_timed) {
      if (!drawn.query) {
        drawn.query = device.create_timer_query(std::string(step.name));
      }
      device.time_begin(drawn.query);
    }
    if (has_commands) {
      device.submit(list);
#ifndef NDEBUG
      check_.check(step, sample, list, device);
#endif
    }
    if (step.work) {
      step.work(sample);
    }
    if (is_timed) {
      device.time_end(drawn.query);
      drawn.is_pending = true;
    }
    if (step.submitted) {
      step.submitted(sample);
    }
  }
}

}  // namespace gnomon::eevee
