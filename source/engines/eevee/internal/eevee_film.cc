// SPDX-License-Identifier: MIT
#include "internal/eevee_film.hh"
#include "internal/eevee_resource_report.hh"

#include "eevee_pixel_filter.hh"

namespace gnomon::eevee {

void Film::sync(const Settings &settings)
{
  weight_sum_ = film_weight_sum(settings.sample_count, settings.seed);
}

void Film::make(gpu::Device &device, glm::ivec2 size_px)
{
  if (!framebuffer_) {
    texture_ = create_target(device, "film", gpu::Format::RGBA32F, size_px);
    framebuffer_ = device.create_framebuffer({.name = "film_fb", .colors = {{&texture_}}, .depth = {}});
  }
}

void Film::resized()
{
  framebuffer_ = {};
  texture_ = {};
}

void Film::record(const gpu::Shader &shader, const gpu::Texture &radiance, glm::ivec2 origin_px,
                  const gpu::Sampler &nearest)
{
  pass_.clear();
  add_to(pass_, shader, radiance, origin_px, nearest);
}

void Film::add_to(draw::Pass &pass, const gpu::Shader &shader, const gpu::Texture &radiance, glm::ivec2 origin_px,
                  const gpu::Sampler &nearest) const
{
  draw::ShadingGroup &group = pass.group(shader);
  group.bind_texture("radiance_texture", radiance, nearest);
  group.constant("radiance_origin_px", origin_px);
  group.constant_ref("column_weights", &columns_);
  group.constant_ref("row_weights", &rows_);
  group.call_procedural();
}

void Film::begin_picture()
{
  share_ = 0.0;
  sample_count_ = 0;
  is_finished_ = false;
}

void Film::set_weights(const FrameSample &sample)
{
  const FilmWeights weights =
      film_weights(sample.index, sample.settings.sample_count, sample.settings.seed, weight_sum_);
  columns_ = glm::vec4(weights.columns, 0.0F);
  rows_ = glm::vec4(weights.rows, 0.0F);
}

void Film::count_sample(const Settings &settings, int sample_index, int count)
{
  share_ = share_with(settings, sample_index);
  sample_count_ = count;
}

void Film::finish(const Settings &settings, int samples_drawn)
{
  is_finished_ = is_finished_ || (samples_drawn > 0 && !has_all_samples(settings, samples_drawn));
}

double Film::share_with(const Settings &settings, int sample_index) const
{
  return share_ + film_share(sample_index, settings.sample_count, settings.seed, weight_sum_);
}

bool Film::has_all_samples(const Settings &settings, int samples_drawn) const
{
  return is_finished_ || (settings.sample_count > 0 && samples_drawn >= settings.drawn_sample_count());
}

float Film::scale(const Settings &settings, int samples_drawn) const
{
  const bool has_counted_samples = settings.sample_count > 0 && samples_drawn >= settings.sample_count &&
                                   settings.drawn_sample_count() == settings.sample_count;
  return (has_counted_samples && !is_finished_) || share_ == 0.0 ? 1.0F : float(1.0 / share_);
}

Need Film::need(const FrameState &state) const
{
  if (state.skips_converged) {
    return {false, "adaptive_film is drawn"};
  }
  // A picture without visible objects and without a background is cleared once, with the first sample.
  return state.is_seen ? Need{true, "samples of each pixel are added up"}
                       : Need{sample_count_ == 0, "nothing is seen: the picture is cleared"};
}

FrameStep Film::step()
{
  return {.name = "film",
          .summary =
              "Adds the sample and its neighbours, weighted by the pixel filter. The radiance has a guard band of one "
              "pixel for it.",
          .part = FrameStep::Part::Last,
          .need = [this](const FrameState &state) { return need(state); },
          .reads = {"radiance"},
          .writes = {"film"},
          .passes = {{&pass_, "samples"}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                set_weights(sample);
                record_pass(sample, list, framebuffer_,
                            {.color_load = sample_count_ == 0 ? gpu::LoadAction::Clear : gpu::LoadAction::Load,
                             .scissor = sample.viewport.region()});
              }};
}

void Film::report(ResourceReport &report) const
{
  report.add_target(texture_, "film", "the picture", "");
}

}  // namespace gnomon::eevee
