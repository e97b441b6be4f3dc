// SPDX-License-Identifier: MIT
#include "internal/eevee_adaptive.hh"
#include "internal/eevee_resource_report.hh"

#include "eevee_pixel_filter.hh"

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
  if (settings.light.kind != LightComponent::Kind::All) {
    return "a part of the light is drawn";
  }
  if (state.has_lamp_points) {
    return "each sample sees other points of lamps";
  }
  return state.has_transmission ? "a material that is drawn transmits light" : "";
}

std::string_view AdaptiveSampling::why_all_samples(const FrameState &state) const
{
  if (const std::string_view why_not = why_not_recorded(state); !why_not.empty()) {
    return why_not;
  }
  if (!state.is_seen) {
    return nothing_seen;
  }
  if (!is_whole_picture_) {
    return "a region of the picture is drawn";
  }
  return state.has_blended_casters ? "blended objects cast other shadows with each sample" : "";
}

Need AdaptiveSampling::need_of(const FrameState &state, std::string_view why) const
{
  if (is_active_) {
    return {true, why};
  }
  const std::string_view why_not = why_all_samples(state);
  return {false, why_not.empty() ? "no pixel is converged yet" : why_not};
}

Need AdaptiveSampling::need_test(const FrameState &state) const
{
  if (const std::string_view why_not = why_all_samples(state); !why_not.empty()) {
    return {false, why_not};
  }
  if (is_active_) {
    return {false, "the converged pixels are known"};
  }
  const int count = state.settings.planned_sample_count();
  const int drawn = film_.sample_count() + 1;
  return drawn < adaptive_first_samples(count) ? Need{false, "all pixels get the first samples"}
         : drawn == count                      ? Need{false, "no sample is left"}
                                               : Need{true, "pixels that differ little from others are converged"};
}

void AdaptiveSampling::sync(const Settings &settings)
{
  sample_step_ = sample_step(settings);
}

int AdaptiveSampling::sample_index(const Settings &settings, int position) const
{
  return settings.sample_count == 0 ? position : int(std::int64_t(position) * sample_step_ % settings.sample_count);
}

void AdaptiveSampling::make(const FrameState &state, const draw::Viewport &viewport)
{
  if (!why_not_recorded(state).empty()) {
    resized();
    return;
  }
  if (film_converged_) {
    return;
  }
  gpu::Device &device = viewport.device();
  film_converged_ = create_target(device, "film_converged", gpu::Format::Depth32F, viewport.size_px());
  drawn_converged_ = create_target(device, "drawn_converged", gpu::Format::Depth32F, viewport.drawn_size_px());
  test_fb_ = device.create_framebuffer({.name = "adaptive_test_fb", .colors = {}, .depth = {&film_converged_}});
  spread_fb_ = device.create_framebuffer({.name = "adaptive_spread_fb", .colors = {}, .depth = {&drawn_converged_}});
  film_fb_ = device.create_framebuffer(
      {.name = "adaptive_film_fb", .colors = {{&film_.texture()}}, .depth = {&film_converged_}});
}

void AdaptiveSampling::resized()
{
  test_fb_ = {};
  spread_fb_ = {};
  film_fb_ = {};
  film_converged_ = {};
  drawn_converged_ = {};
  begin_picture();
}

void AdaptiveSampling::record(gpu::Device &device, ShaderCache &shaders, const Settings &settings, glm::ivec2 guard_px)
{
  for (draw::Pass *pass :
       {&test_pass_, &spread_pass_, &depth_pass_, &background_pass_, &sampled_pass_, &converged_pass_}) {
    pass->clear();
  }
  if (!film_converged_) {
    return;
  }
  film_.add_to(sampled_pass_, shaders.get(device, ShaderId::Film), buffers_.radiance, guard_px, buffers_.nearest);
  draw::ShadingGroup &test = test_pass_.group(shaders.get(device, ShaderId::AdaptiveTest));
  test.bind_texture("film", film_.texture(), buffers_.nearest);
  test.constant_ref("sample_scale", &sample_scale_);
  test.constant("threshold", settings.noise_threshold);
  test.call_procedural();
  draw::ShadingGroup &spread = spread_pass_.group(shaders.get(device, ShaderId::AdaptiveSpread));
  spread.bind_texture("film_converged", film_converged_, buffers_.nearest);
  spread.constant("film_origin_px", guard_px);
  spread.call_procedural();
  for (const auto &[pass, is_inverted] : {std::pair(&depth_pass_, 0.0F), std::pair(&background_pass_, 1.0F)}) {
    draw::ShadingGroup &depth = pass->group(shaders.get(device, ShaderId::AdaptiveDepth));
    depth.bind_texture("drawn_converged", drawn_converged_, buffers_.nearest);
    depth.constant("is_inverted", is_inverted);
    depth.call_procedural();
  }
  draw::ShadingGroup &converged = converged_pass_.group(shaders.get(device, ShaderId::AdaptiveScale));
  converged.constant_ref("factor", &factor_);
  converged.call_procedural();
}

void AdaptiveSampling::begin_sample(bool is_whole)
{
  is_whole_picture_ = is_whole;
}

void AdaptiveSampling::begin_picture()
{
  is_tested_ = is_active_ = false;
}

static std::string_view no_convergence(const FrameState & /*state*/)
{
  return "all pixels get all samples";
}

FrameStep AdaptiveSampling::depth_step()
{
  return {.name = "adaptive_depth",
          .summary =
              "With a noise threshold and after the first samples, depths that hide all objects behind converged "
              "pixels ([decision 0032](decisions/0032-adaptive-sampling.md)).",
          .part = FrameStep::Part::First,
          .need = [this](const FrameState &state) { return need_of(state, "the depth test skips converged pixels"); },
          .reads = {"drawn_converged"},
          .writes = {"depth"},
          .passes = {{&depth_pass_, "converged pixels", no_convergence}},
          .record = [this](FrameSample &sample,
                           gpu::CommandList &list) { record_pass(sample, list, buffers_.depth_fb, {}); }};
}

FrameStep AdaptiveSampling::background_step()
{
  return {.name = "adaptive_background",
          .summary = "Gives converged pixels the depth of the background, so that deferred lighting skips them.",
          .part = FrameStep::Part::First,
          .need =
              [this](const FrameState &state) {
                const Need need = need_of(state, "deferred lighting skips converged pixels");
                return need.is_needed && !depth_.has_gbuffer() ? Need{false, why_forward} : need;
              },
          .reads = {"drawn_converged"},
          .writes = {"depth"},
          .passes = {{&background_pass_, "converged pixels", no_convergence}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.depth_fb, {.depth_load = gpu::LoadAction::Load});
              }};
}

FrameStep AdaptiveSampling::forward_depth_step()
{
  return {.name = "adaptive_forward_depth",
          .summary = "As adaptive_depth, if there is a G-buffer and objects outside of it.",
          .part = FrameStep::Part::Rows,
          .need =
              [this](const FrameState &state) {
                const Need need = need_of(state, "the depth test skips converged pixels after deferred lighting");
                return need.is_needed ? depth_.need_forward(state) : need;
              },
          .reads = {"drawn_converged"},
          .writes = {"depth"},
          .passes = {{&depth_pass_, "converged pixels", no_convergence}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.depth_fb,
                            {.depth_load = gpu::LoadAction::Load, .scissor = sample.viewport.part_region()});
              }};
}

FrameStep AdaptiveSampling::film_step()
{
  return {.name = "adaptive_film",
          .summary = "The same for pixels that are not converged. The others keep their mean.",
          .part = FrameStep::Part::Last,
          .need = [this](const FrameState &state) { return need_of(state, "converged pixels keep their mean"); },
          .reads = {"film_converged", "radiance"},
          .writes = {"film"},
          .passes = {{&sampled_pass_, "pixels that get the sample", no_convergence},
                     {&converged_pass_, "pixels that keep their mean", no_convergence}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                const double share = film_.share_with(sample.settings, sample.index);
                factor_ = glm::vec4(float(share / converged_share_));
                converged_share_ = share;
                film_.set_weights(sample);
                record_pass(sample, list, film_fb_, drawn_over());
              }};
}

FrameStep AdaptiveSampling::test_step()
{
  return {.name = "adaptive_test",
          .summary = "Finds the converged pixels of the film, once a picture.",
          .part = FrameStep::Part::Last,
          .need = [this](const FrameState &state) { return need_test(state); },
          .reads = {"film"},
          .writes = {"film_converged"},
          .passes = {{&test_pass_, "pixels of the film", no_convergence}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                if (sample.awaits_depths) {
                  // The depths of all pixels are read back.
                  return;
                }
                converged_share_ = film_.share_with(sample.settings, sample.index);
                sample_scale_ = float(1.0 / converged_share_);
                record_pass(sample, list, test_fb_, {});
                is_tested_ = true;
              }};
}

FrameStep AdaptiveSampling::spread_step()
{
  return {.name = "adaptive_spread",
          .summary = "Finds the pixels of the radiance that only converged pixels read.",
          .part = FrameStep::Part::Last,
          .need =
              [this](const FrameState &state) {
                return is_tested_ && !is_active_ ? Need{true, "the pixel filter reads neighbours"}
                                                 : Need{false, need_test(state).reason};
              },
          .reads = {"film_converged"},
          .writes = {"drawn_converged"},
          .passes = {{&spread_pass_, "pixels of the radiance", no_convergence}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, spread_fb_, {});
                is_active_ = true;
              }};
}

void AdaptiveSampling::report(ResourceReport &report) const
{
  const char *why_not = report.settings.noise_threshold > 0.0F ? "all pixels get all samples" : not_asked_for;
  report.add_target(film_converged_, "film_converged", "pixels that need no more samples", why_not);
  report.add_target(drawn_converged_, "drawn_converged", "pixels that need no more samples", why_not);
}

}  // namespace gnomon::eevee
