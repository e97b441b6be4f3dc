// SPDX-License-Identifier: MIT
#include "eevee_adaptive.hh"

#include "eevee_engine_data.hh"
#include "eevee_film.hh"
#include "eevee_frame_needs.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace gnomon::eevee {

int adaptive_first_samples(int sample_count)
{
  return std::clamp(sample_count / 2, 1, adaptive_first_max);
}

/** The least distance between the first samples of \a count that are \a step apart, in a square without edges. */
static float distance_of_first(int step, int count)
{
  float least = 1.0F;
  std::array<glm::vec2, adaptive_first_max> offsets{};
  for (std::size_t i = 0; i < std::size_t(std::max(2, adaptive_first_samples(count))); i++) {
    offsets[i] = film_offset_px(int(std::int64_t(i) * step % count), count, 0);
    for (std::size_t other = 0; other < i; other++) {
      const glm::vec2 difference = offsets[i] - offsets[other];
      least = std::min(least, glm::length(difference - glm::round(difference)));
    }
  }
  return least;
}

int sample_step(const Settings &settings)
{
  const int count = settings.sample_count;
  if (settings.noise_threshold == 0.0F || count < 2) {
    return 1;
  }
  int best = 1;
  float best_distance = distance_of_first(1, count);
  for (int step = 2; step < count; step++) {
    const float distance = std::gcd(step, count) == 1 ? distance_of_first(step, count) : 0.0F;
    if (distance > best_distance) {
      best = step;
      best_distance = distance;
    }
  }
  return best;
}

/** The reason why the passes of adaptive sampling are not recorded; empty: they are. */
static std::string_view why_not_recorded(const FrameState &state)
{
  const Settings &settings = state.settings;
  if (settings.noise_threshold == 0.0F) {
    return "the settings have no noise threshold";
  }
  if (settings.planned_sample_count() <= adaptive_first_samples(settings.planned_sample_count())) {
    return "there is one sample";
  }
  if (settings.light.kind != LightPart::Kind::All) {
    return "a part of the light is drawn";
  }
  if (!state.data.shared->lamp_points.empty()) {
    return "each sample sees other points of lamps";
  }
  return state.data.stl.transmissive.empty() ? "" : "a material that is drawn transmits light";
}

bool has_adaptive_passes(const FrameState &state)
{
  return why_not_recorded(state).empty();
}

/** The reason why all pixels get all samples; empty: some may get fewer. */
static std::string_view why_all_samples(const FrameState &state)
{
  if (const std::string_view why_not = why_not_recorded(state); !why_not.empty()) {
    return why_not;
  }
  if (!state.data.is_seen) {
    return nothing_seen;
  }
  if (!state.data.adaptive.is_whole_picture) {
    return "a region of the picture is drawn";
  }
  return std::ranges::any_of(state.data.shared->caster_kinds, &CasterKind::is_blended)
             ? "blended objects cast other shadows with each sample"
             : "";
}

/** Need of a step that skips converged pixels. */
static Need need_of(const FrameState &state, std::string_view why)
{
  if (state.data.adaptive.is_active) {
    return {true, why};
  }
  const std::string_view why_not = why_all_samples(state);
  return {false, why_not.empty() ? "no pixel is converged yet" : why_not};
}

Need need_adaptive_depth(const FrameState &state)
{
  return need_of(state, "the depth test skips converged pixels");
}

Need need_adaptive_background(const FrameState &state)
{
  const Need need = need_of(state, "deferred lighting skips converged pixels");
  return need.is_needed && !has_gbuffer(state.data) ? Need{false, why_forward} : need;
}

Need need_adaptive_film(const FrameState &state)
{
  return need_of(state, "converged pixels keep their mean");
}

Need need_adaptive_test(const FrameState &state)
{
  if (const std::string_view why_not = why_all_samples(state); !why_not.empty()) {
    return {false, why_not};
  }
  if (state.data.adaptive.is_active) {
    return {false, "the converged pixels are known"};
  }
  const int count = state.settings.planned_sample_count();
  const int drawn = state.data.film_sample_count + 1;
  return drawn < adaptive_first_samples(count) ? Need{false, "all pixels get the first samples"}
         : drawn == count                      ? Need{false, "no sample is left"}
                                               : Need{true, "pixels that differ little from others are converged"};
}

void record_adaptive_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.depth_fb, {});
}

Need need_adaptive_forward_depth(const FrameState &state)
{
  const Need need = need_of(state, "the depth test skips converged pixels after deferred lighting");
  return need.is_needed ? need_forward_depth(state) : need;
}

void record_adaptive_forward_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.depth_fb,
              {.depth_load = gpu::LoadAction::Load, .scissor = sample.viewport.part_region()});
}

void record_adaptive_background(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.depth_fb, {.depth_load = gpu::LoadAction::Load});
}

/** StorageList::film_share with the current sample. */
static double share_with(const FrameSample &sample)
{
  return sample.data.stl.film_share + film_share(sample.data.sample_index, sample.settings.sample_count,
                                                 sample.settings.seed, sample.data.stl.film_weight_sum);
}

void record_adaptive_film(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  AdaptiveSampling &adaptive = sample.data.adaptive;
  const double share = share_with(sample);
  adaptive.factor = glm::vec4(float(share / adaptive.converged_share));
  adaptive.converged_share = share;
  update_film_weights(sample);
  record_pass(step, sample, list, adaptive.film_fb,
              {.color_load = gpu::LoadAction::Load, .depth_load = gpu::LoadAction::Load});
}

void record_adaptive_test(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  Data &data = sample.data;
  if (awaits_depths(data, sample.view)) {
    // The depths of all pixels are read back.
    return;
  }
  AdaptiveSampling &adaptive = data.adaptive;
  adaptive.converged_share = share_with(sample);
  adaptive.sample_scale = float(1.0 / adaptive.converged_share);
  record_pass(step, sample, list, adaptive.test_fb, {});
  adaptive.is_tested = true;
}

Need need_adaptive_spread(const FrameState &state)
{
  const AdaptiveSampling &adaptive = state.data.adaptive;
  return adaptive.is_tested && !adaptive.is_active ? Need{true, "the pixel filter reads neighbours"}
                                                   : Need{false, need_adaptive_test(state).reason};
}

void record_adaptive_spread(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.adaptive.spread_fb, {});
  sample.data.adaptive.is_active = true;
}

void Engine::make_adaptive(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  AdaptiveSampling &adaptive = data.adaptive;
  if (!has_adaptive_passes({settings_, data})) {
    adaptive = {};
    return;
  }
  if (adaptive.film_converged) {
    return;
  }
  gpu::Device &device = viewport.device();
  adaptive.film_converged = create_target(device, "film_converged", gpu::Format::Depth32F, viewport.size_px());
  adaptive.drawn_converged = create_target(device, "drawn_converged", gpu::Format::Depth32F, viewport.drawn_size_px());
  adaptive.test_fb =
      device.create_framebuffer({.name = "adaptive_test_fb", .colors = {}, .depth = {&adaptive.film_converged}});
  adaptive.spread_fb =
      device.create_framebuffer({.name = "adaptive_spread_fb", .colors = {}, .depth = {&adaptive.drawn_converged}});
  adaptive.film_fb = device.create_framebuffer(
      {.name = "adaptive_film_fb", .colors = {{&data.txl.film}}, .depth = {&adaptive.film_converged}});
}

void Engine::record_adaptive(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  AdaptiveSampling &adaptive = data.adaptive;
  gpu::Device &device = viewport.device();
  draw::ShadingGroup &test = data.psl->adaptive_test_pass.group(shaders_->get(device, ShaderId::AdaptiveTest));
  test.bind_texture("film", data.txl.film, data.txl.nearest);
  test.constant_ref("sample_scale", &adaptive.sample_scale);
  test.constant("threshold", settings_.noise_threshold);
  test.call_procedural();
  draw::ShadingGroup &spread = data.psl->adaptive_spread_pass.group(shaders_->get(device, ShaderId::AdaptiveSpread));
  spread.bind_texture("film_converged", adaptive.film_converged, data.txl.nearest);
  spread.constant("film_origin_px", viewport.guard_px());
  spread.call_procedural();
  for (const auto &[pass, is_inverted] :
       {std::pair(&data.psl->adaptive_depth_pass, 0.0F), std::pair(&data.psl->adaptive_background_pass, 1.0F)}) {
    draw::ShadingGroup &depth = pass->group(shaders_->get(device, ShaderId::AdaptiveDepth));
    depth.bind_texture("drawn_converged", adaptive.drawn_converged, data.txl.nearest);
    depth.constant("is_inverted", is_inverted);
    depth.call_procedural();
  }
  draw::ShadingGroup &converged = data.psl->film_converged_pass.group(shaders_->get(device, ShaderId::AdaptiveScale));
  converged.constant_ref("factor", &adaptive.factor);
  converged.call_procedural();
}

}  // namespace gnomon::eevee
