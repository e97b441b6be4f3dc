// SPDX-License-Identifier: MIT
#include "eevee_frame.hh"

#include "eevee_engine_data.hh"
#include "eevee_film.hh"
#include "eevee_frame_needs.hh"
#include "eevee_transmission.hh"

#include "trace.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace gnomon::eevee {

/** Appends the visible calls of the passes of \a step to \a list. */
static void record_passes(const FrameStep &step, FrameSample &sample, const draw::View &view, gpu::CommandList &list)
{
  Data &data = sample.data;
  StepRecord &record = data.frame[std::size_t(&step - frame_steps().data())];
  // A picture without visible objects and without a background is only cleared.
  for (std::size_t i = 0; data.is_seen && i < step.passes.size(); i++) {
    const draw::RecordCounts counts = ((*data.psl).*step.passes[i].pass).record(view, data.visible, list);
    record.passes[i].runs += counts.drawn > 0 ? 1 : 0;
    record.passes[i].counts.drawn += counts.drawn;
    record.passes[i].counts.culled += counts.culled;
  }
}

void record_pass(const FrameStep &step, FrameSample &sample, gpu::CommandList &list,
                 const gpu::Framebuffer &framebuffer, const gpu::PassActions &actions)
{
  list.begin_pass(step.name, framebuffer, actions);
  record_passes(step, sample, sample.sample_view, list);
  list.end_pass();
}

void update_film_weights(FrameSample &sample)
{
  StorageList &stl = sample.data.stl;
  const FilmWeights weights =
      film_weights(sample.data.sample_index, sample.settings.sample_count, sample.settings.seed, stl.film_weight_sum);
  stl.film_columns = glm::vec4(weights.columns, 0.0F);
  stl.film_rows = glm::vec4(weights.rows, 0.0F);
}

/** The region that steps before the transmission of light draw: all of the picture, where that reads other pixels. */
static gpu::Rectangle read_region(const FrameSample &sample)
{
  return sample.data.is_transmission_seen ? gpu::Rectangle() : sample.viewport.part_region();
}

namespace {

/** All rows, of which this part may light only some. Cascades are fitted to the depths of the whole picture. */
gpu::Rectangle depth_region(const FrameSample &sample)
{
  const bool is_whole = awaits_depths(sample.data, sample.view) || sample.data.is_transmission_seen;
  return is_whole ? gpu::Rectangle() : sample.viewport.drawn_region();
}

/** The first pass with the depth texture clears it. */
gpu::LoadAction depth_load(const FrameSample &sample)
{
  return sample.data.adaptive.is_active ? gpu::LoadAction::Load : gpu::LoadAction::Clear;
}

void record_gbuffer(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.main_fb,
              {.depth_load = depth_load(sample), .scissor = depth_region(sample)});
}

void record_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  Data &data = sample.data;
  record_pass(
      step, sample, list, data.fbl.depth_fb,
      {.depth_load = has_gbuffer(data) ? gpu::LoadAction::Load : depth_load(sample), .scissor = depth_region(sample)});
  if (awaits_depths(data, sample.view)) {
    DepthFeedback &depths = data.depth_feedback;
    const std::uint64_t tag = ++depths.requested_tag;
    depths.requested_views[tag % depths.requested_views.size()] = sample.view;
  }
}

void read_depths(FrameSample &sample)
{
  if (awaits_depths(sample.data, sample.view)) {
    sample.viewport.device().read_back(sample.viewport.depth_texture(), 0, sample.data.depth_feedback.requested_tag);
  }
}

void record_lamp_points(const FrameStep & /*step*/, FrameSample &sample, gpu::CommandList &list)
{
  sample.lamp_points = sample.data.shared->lamp_points.sample(
      std::uint32_t(sample.data.sample_index), sample.settings.seed, std::move(sample.data.stl.lamp_points_memory));
  write_lamp_points(sample.data, sample.lamp_points, sample.viewport.device(), list);
}

void record_light_clusters(const FrameStep & /*step*/, FrameSample &sample, gpu::CommandList &list)
{
  update_light_clusters(sample.data, sample.viewport, sample.view, list);
}

void record_shadows(const FrameStep & /*step*/, FrameSample &sample, gpu::CommandList &list)
{
  StorageList &stl = sample.data.stl;
  SharedData &shared = *sample.data.shared;
  const draw::SamplePart part = sample.viewport.part();
  // Between two parts, another viewport may have drawn another sample. Before, the settings may have been others.
  const bool is_disturbed =
      shared.sample_index != sample.data.sample_index || shared.sample_seed != int(sample.settings.seed);
  if (is_disturbed || (sample.settings.planned_sample_count() > 1 && part.is_first)) {
    stl.shadows->invalidate_blended();
  }
  shared.sample_index = sample.data.sample_index;
  shared.sample_seed = int(sample.settings.seed);
  // Two viewports that draw parts in turn would never have all layers, which are one sample's, so that one draws all.
  const int parts_max = part.is_first || !is_disturbed ? part.setup_max : draw::Viewport::no_setup_max;
  const UpdatedLayers updated = stl.shadows->update(
      sample.viewport.device(), sample.view, pixel_size(sample.view, sample.viewport), shared.shadow_pass, list,
      sample.lamp_points.points, sample.data.depth_feedback.picture(sample.viewport.drawn_size_px()), parts_max);
  sample.viewport.set_setup(updated.part_count, updated.left_count);
}

void record_deferred_lit(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.main_fb,
              {.color_load = gpu::LoadAction::Load,
               .depth_load = gpu::LoadAction::Load,
               .scissor = read_region(sample),
               .reads_attachments = true});
}

void record_forward_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.depth_fb,
              {.depth_load = gpu::LoadAction::Load, .scissor = read_region(sample)});
}

void record_lit(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.main_fb,
              {.color_load = has_gbuffer(sample.data) ? gpu::LoadAction::Load : gpu::LoadAction::Clear,
               .depth_load = gpu::LoadAction::Load,
               .scissor = read_region(sample)});
}

void record_blend(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.main_fb,
              {.color_load = gpu::LoadAction::Load,
               .depth_load = gpu::LoadAction::Load,
               .scissor = sample.viewport.part_region()});
}

void record_background(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  StorageList &stl = sample.data.stl;
  const glm::dmat4 projection(sample.sample_view.clip_from_view());
  const glm::dmat3 world_from_view = glm::transpose(glm::dmat3(sample.sample_view.view_from_world()));
  const glm::dvec2 size_px(sample.viewport.drawn_size_px());
  // The view ray through the normalized device coordinates (x, y) is (middle + scale * (x, y), -1) in view space. In an
  // orthographic view all rays are parallel.
  const bool is_perspective = sample.sample_view.is_perspective();
  const glm::dvec2 scale = is_perspective ? 1.0 / glm::dvec2(projection[0][0], projection[1][1]) : glm::dvec2(0.0);
  const glm::dvec2 middle = is_perspective ? scale * glm::dvec2(projection[2][0], projection[2][1]) : glm::dvec2(0.0);
  stl.background_corner = glm::vec4(glm::vec3(world_from_view * glm::dvec3(middle - scale, -1.0)), 0.0F);
  stl.background_across = glm::vec4(glm::vec3(world_from_view * glm::dvec3(2.0 * scale.x / size_px.x, 0.0, 0.0)), 0.0F);
  stl.background_up = glm::vec4(glm::vec3(world_from_view * glm::dvec3(0.0, 2.0 * scale.y / size_px.y, 0.0)), 0.0F);
  record_pass(
      step, sample, list, sample.data.fbl.main_fb,
      {.color_load = gpu::LoadAction::Load, .depth_load = gpu::LoadAction::Load, .scissor = read_region(sample)});
}

void record_film(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  update_film_weights(sample);
  const bool is_first = sample.data.film_sample_count == 0;
  record_pass(
      step, sample, list, sample.data.fbl.film_fb,
      {.color_load = is_first ? gpu::LoadAction::Clear : gpu::LoadAction::Load, .scissor = sample.viewport.region()});
}

void record_picture_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  const shared::ViewData block =
      view_data(sample.view, sample.settings, sample.data.sample_index, sample.data.shared->bounds_ws);
  list.update(sample.data.stl.view_block, 0, std::as_bytes(std::span(&block, 1)));
  list.begin_pass(step.name, sample.data.fbl.picture_depth_fb, {.scissor = sample.viewport.drawn_region()});
  record_passes(step, sample, sample.view, list);
  list.end_pass();
}

void record_tonemap(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  // A picture without visible objects is transparent black. Every view transform keeps black, so that a clear suffices.
  const gpu::LoadAction load = sample.data.is_seen ? gpu::LoadAction::Load : gpu::LoadAction::Clear;
  const draw::Target &target = sample.data.target;
  draw::begin_pass(
      list, step.name, target, sample.viewport.size_px(), sample.viewport.region(),
      {.color_load = load,
       .depth_load = target.depth ? load : gpu::LoadAction::Load,
       .clear_depth = target.depth ? draw::depth_map(sample.view.clip_from_view(), *target.depth).background : 0.0F});
  record_passes(step, sample, sample.view, list);
  list.end_pass();
}

constexpr std::array<FramePass, 2> depth_passes = {{
    {&PassList::depth_pass, "two-sided materials",
     [](const FrameState &) -> std::string { return "no object with a two-sided material outside of the G-buffer"; }},
    {&PassList::depth_pass_cull, "one-sided materials",
     [](const FrameState &) -> std::string { return "no object with a one-sided material outside of the G-buffer"; }},
}};

constexpr std::array<FramePass, 1> gbuffer_passes = {
    {{&PassList::gbuffer_pass, "opaque objects without textures",
      [](const FrameState &) -> std::string { return std::string(why_forward); }}}};

constexpr std::array<FramePass, 1> deferred_lit_passes = {
    {{&PassList::deferred_lit_pass, "pixels of the G-buffer",
      [](const FrameState &) -> std::string { return std::string(why_forward); }}}};

constexpr std::string (*no_transmission)(const FrameState &) = [](const FrameState &) -> std::string {
  return "no object that is not blended transmits light";
};

constexpr std::array<FramePass, 2> transmission_passes = {{
    {&PassList::transmission_depth_pass, "the nearest surface alone is seen", no_transmission},
    {&PassList::transmission_pass, "objects in the view", no_transmission},
}};

constexpr std::array<FramePass, 4> picture_depth_passes = {
    {depth_passes[0], depth_passes[1], gbuffer_passes[0], transmission_passes[0]}};

constexpr std::array<FramePass, 2> lit_passes = {{
    {&PassList::lit_pass, "objects in the view",
     [](const FrameState &state) -> std::string {
       return has_gbuffer(state.data) ? std::string(all_in_gbuffer) : nothing_seen;
     }},
    {&PassList::tint_pass, "asked for",
     [](const FrameState &state) -> std::string {
       return !state.settings.has_cascade_tint  ? "not asked for"
              : state.data.shared->tinted_light ? nothing_seen
                                                : "no sun has a shadow";
     }},
}};

constexpr std::array<FramePass, 1> background_passes = {
    {{&PassList::background_pass, "pixels without a surface",
      [](const FrameState &) -> std::string { return nothing_seen; }}}};

constexpr std::array<FramePass, 1> blend_passes = {{{&PassList::blend_pass, "blended objects, from back to front",
                                                     [](const FrameState &) -> std::string { return nothing_seen; }}}};

constexpr std::array<FramePass, 1> blend_behind_passes = {
    {{&PassList::blend_pass, "blended objects that are seen through others",
      [](const FrameState &) -> std::string { return nothing_seen; }}}};

constexpr std::array<FramePass, 1> film_passes = {
    {{&PassList::film_pass, "samples", [](const FrameState &) -> std::string { return nothing_seen; }}}};

constexpr std::string (*no_convergence)(const FrameState &) = [](const FrameState &) -> std::string {
  return "all pixels get all samples";
};

constexpr std::array<FramePass, 1> adaptive_depth_passes = {
    {{&PassList::adaptive_depth_pass, "converged pixels", no_convergence}}};

constexpr std::array<FramePass, 1> adaptive_background_passes = {
    {{&PassList::adaptive_background_pass, "converged pixels", no_convergence}}};

constexpr std::array<FramePass, 2> adaptive_film_passes = {{
    {&PassList::film_sampled_pass, "pixels that get the sample", no_convergence},
    {&PassList::film_converged_pass, "pixels that keep their mean", no_convergence},
}};

constexpr std::array<FramePass, 1> adaptive_test_passes = {
    {{&PassList::adaptive_test_pass, "pixels of the film", no_convergence}}};

constexpr std::array<FramePass, 1> adaptive_spread_passes = {
    {{&PassList::adaptive_spread_pass, "pixels of the radiance", no_convergence}}};

constexpr std::array<FramePass, 1> tonemap_passes = {
    {{&PassList::tonemap, "a target was given", [](const FrameState &) -> std::string { return nothing_seen; }}}};

constexpr std::array<std::string_view, 4> shadow_targets = {"shadow_cubes", "shadow_maps", "shadow_distance_cube",
                                                            "shadow_esm"};
constexpr std::array<std::string_view, 6> pictures = {"depth", "radiance", "film", "picture_depth", "target", "behind"};
constexpr std::span depth_only = std::span(pictures).first(1);
constexpr std::span radiance_only = std::span(pictures).subspan(1, 1);
constexpr std::span film_only = std::span(pictures).subspan(2, 1);
constexpr std::span picture_depth_only = std::span(pictures).subspan(3, 1);
constexpr std::span picture_only = std::span(pictures).subspan(2, 2);
constexpr std::span target_only = std::span(pictures).subspan(4, 1);
constexpr std::span behind_only = std::span(pictures).subspan(5, 1);
constexpr std::span depth_and_radiance = std::span(pictures).first(2);

constexpr std::array<std::string_view, 3> adaptive_resources = {"drawn_converged", "film_converged", "radiance"};
constexpr std::span converged_only = std::span(adaptive_resources).first(1);
constexpr std::span film_converged_only = std::span(adaptive_resources).subspan(1, 1);
constexpr std::span film_inputs = std::span(adaptive_resources).subspan(1, 2);

constexpr std::array<std::string_view, 2> lights = {"light_block", "light_texture"};
constexpr std::array<std::string_view, 2> cluster_resources = {"light_cluster_block", "light_lists"};

constexpr std::array<FrameStep, 22> steps = {{
    {"adaptive_depth", FrameStep::When::EachSample, FrameStep::Part::First, need_adaptive_depth, converged_only,
     depth_only, adaptive_depth_passes, record_adaptive_depth},
    // The depths come before the shadows because cascades may be fitted to them.
    {.name = "gbuffer",
     .when = FrameStep::When::EachSample,
     .part = FrameStep::Part::First,
     .need = need_gbuffer,
     .reads = {},
     .writes = depth_and_radiance,
     .passes = gbuffer_passes,
     .record = record_gbuffer,
     .is_read_back = true},
    {"depth_prepass",
     FrameStep::When::EachSample,
     FrameStep::Part::First,
     need_depth,
     {},
     depth_only,
     depth_passes,
     record_depth,
     read_depths,
     true},
    {"lamp_points",
     FrameStep::When::EachSample,
     FrameStep::Part::Each,
     need_lamp_points,
     {},
     lights,
     {},
     record_lamp_points},
    {"light_clusters",
     FrameStep::When::EachSample,
     FrameStep::Part::Each,
     need_light_clusters,
     {},
     cluster_resources,
     {},
     record_light_clusters},
    {"shadows",
     FrameStep::When::EachSample,
     FrameStep::Part::Each,
     need_shadows,
     depth_only,
     shadow_targets,
     {},
     record_shadows,
     [](FrameSample &sample) { sample.data.stl.shadows->submitted(); }},
    {"adaptive_background", FrameStep::When::EachSample, FrameStep::Part::First, need_adaptive_background,
     converged_only, depth_only, adaptive_background_passes, record_adaptive_background},
    {"deferred_lit", FrameStep::When::EachSample, FrameStep::Part::Rows, need_deferred_lit, shadow_targets,
     radiance_only, deferred_lit_passes, record_deferred_lit},
    {"adaptive_forward_depth", FrameStep::When::EachSample, FrameStep::Part::Rows, need_adaptive_forward_depth,
     converged_only, depth_only, adaptive_depth_passes, record_adaptive_forward_depth},
    {"forward_depth",
     FrameStep::When::EachSample,
     FrameStep::Part::Rows,
     need_forward_depth,
     {},
     depth_only,
     depth_passes,
     record_forward_depth},
    {"lit", FrameStep::When::EachSample, FrameStep::Part::Rows, need_lit, shadow_targets, radiance_only, lit_passes,
     record_lit},
    {"background", FrameStep::When::EachSample, FrameStep::Part::Rows, need_background, depth_only, radiance_only,
     background_passes, record_background},
    {"blend_behind", FrameStep::When::EachSample, FrameStep::Part::Rows, need_blend_behind, shadow_targets,
     radiance_only, blend_behind_passes, record_blend_behind},
    {.name = "behind",
     .when = FrameStep::When::EachSample,
     .part = FrameStep::Part::Rows,
     .need = need_behind,
     .reads = radiance_only,
     .writes = behind_only,
     .passes = {},
     .record = [](const FrameStep &, FrameSample &, gpu::CommandList &) {},
     .work = copy_behind},
    {"transmission", FrameStep::When::EachSample, FrameStep::Part::Rows, need_transmission, behind_only,
     depth_and_radiance, transmission_passes, record_transmission},
    {"blend", FrameStep::When::EachSample, FrameStep::Part::Rows, need_blend, shadow_targets, radiance_only,
     blend_passes, record_blend},
    {"film", FrameStep::When::EachSample, FrameStep::Part::Last, need_film, radiance_only, film_only, film_passes,
     record_film},
    {"adaptive_film", FrameStep::When::EachSample, FrameStep::Part::Last, need_adaptive_film, film_inputs, film_only,
     adaptive_film_passes, record_adaptive_film},
    {"adaptive_test", FrameStep::When::EachSample, FrameStep::Part::Last, need_adaptive_test, film_only,
     film_converged_only, adaptive_test_passes, record_adaptive_test},
    {"adaptive_spread", FrameStep::When::EachSample, FrameStep::Part::Last, need_adaptive_spread, film_converged_only,
     converged_only, adaptive_spread_passes, record_adaptive_spread},
    {"picture_depth",
     FrameStep::When::EachTarget,
     FrameStep::Part::Each,
     need_picture_depth,
     {},
     picture_depth_only,
     picture_depth_passes,
     record_picture_depth,
     [](FrameSample &sample) { sample.data.has_picture_depth = true; }},
    {"tonemap", FrameStep::When::EachTarget, FrameStep::Part::Each, need_tonemap, picture_only, target_only,
     tonemap_passes, record_tonemap},
}};

/** Measures the device time of the submissions of \a work with the timer query of the step \a name. */
template <typename Work>
void timed(gpu::Device &device, Timing &timing, std::string_view name, Work &&work)
{
  auto step = std::ranges::find(timing.steps, name, &Timing::Step::name);
  if (step == timing.steps.end()) {
    timing.steps.push_back({std::string(name), {}});
    step = timing.steps.end() - 1;
  }
  if (!step->query) {
    step->query = device.create_timer_query(step->name);
  }
  device.time_begin(step->query);
  work();
  device.time_end(step->query);
  step->is_pending = true;
}

}  // namespace

std::span<const FrameStep> frame_steps()
{
  return steps;
}

std::string reason_of(const FramePass &pass, const StepRecord::PassRecord &record, const FrameState &state)
{
  if (record.runs > 0) {
    return std::string(pass.purpose);
  }
  if (!state.data.is_seen) {
    return nothing_seen;
  }
  return ((*state.data.psl).*pass.pass).is_empty() ? pass.why_empty(state) : "none of its objects is in the view";
}

void draw_steps(FrameSample &sample, FrameStep::When when)
{
  Data &data = sample.data;
  gpu::Device &device = sample.viewport.device();
  const FrameState state{sample.settings, data};
  data.frame.resize(steps.size());
  for (std::size_t i = 0; i < steps.size(); i++) {
    const FrameStep &step = steps[i];
    StepRecord &record = data.frame[i];
    record.passes.resize(step.passes.size());
    if (step.when != when || !is_in_part(step.part, sample.viewport.part()) ||
        (sample.is_for_feedback && !step.is_read_back)) {
      continue;
    }
    Need need = step.need(state);
    const bool is_needed = need.is_needed;
    // The record of a picture says "needed" if at least one sample needed the step.
    if (is_needed || !record.need.is_needed) {
      record.need = std::move(need);
    }
    if (!is_needed) {
      continue;
    }
    const trace::Span span(step.name);
    gpu::CommandList &list = device.add_list();
    step.record(step, sample, list);
    const auto submit = [&] {
      if (!list.commands().empty()) {
        device.submit(list);
      }
      if (step.work) {
        step.work(sample);
      }
    };
    if (list.commands().empty() && !step.work) {
      // Every shadow layer was up to date.
    }
    else if (sample.settings.is_timed) {
      timed(device, data.timing, step.name, submit);
    }
    else {
      submit();
    }
    if (step.submitted) {
      step.submitted(sample);
    }
  }
}

}  // namespace gnomon::eevee
