// SPDX-License-Identifier: MIT
// Functions that several steps of a frame and Inspection share: the view of a sample, reasons.
#include "eevee_camera.hh"
#include "eevee_engine_data.hh"
#include "eevee_film.hh"
#include "eevee_frame.hh"

#include <glm/matrix.hpp>

#include <cmath>

namespace gnomon::eevee {

bool is_in_part(FrameStep::Part step, const draw::SamplePart &part)
{
  switch (step) {
    case FrameStep::Part::First: return part.is_first;
    case FrameStep::Part::Rows: return part.row_count > 0;
    case FrameStep::Part::Last: return part.is_last;
    case FrameStep::Part::Each: break;
  }
  return true;
}

std::string_view why_no_shadow(const FrameState &state, std::string_view no_such_lamp)
{
  if (state.settings.shadow.kind == scene::ShadowKind::None) {
    return "shadows are off";
  }
  return has(state.data.stl.features, Feature::Light) ? no_such_lamp : "no lamp gives light";
}

float pixel_size(const draw::View &view, const draw::Viewport &viewport)
{
  return 2.0F / (view.clip_from_view()[1][1] * float(viewport.drawn_size_px().y));
}

draw::View view_of_sample(const draw::View &drawn_view, const draw::Viewport &viewport, const Settings &settings,
                          int index)
{
  return with_sample_offset(drawn_view, film_offset_px(index, settings.sample_count, settings.seed),
                            viewport.drawn_size_px());
}

shared::ViewData view_data(const draw::View &view, const Settings &settings, int sample_index)
{
  const glm::mat4 world_from_view(glm::inverse(glm::dmat4(view.view_from_world())));
  shared::ViewData data{};
  data.clip_from_world = view.clip_from_world();
  data.world_from_clip = glm::mat4(glm::inverse(glm::dmat4(view.clip_from_world())));
  data.position_ws = glm::vec3(world_from_view[3]);
  data.is_perspective = view.is_perspective() ? 1 : 0;
  data.back_ws = glm::normalize(glm::vec3(world_from_view[2]));
  // With n samples for each pixel, a sample covers 1/n of the pixel's area, so that the samples are n^-1/2 pixels
  // apart.
  const int sample_count = settings.sample_count == 0 ? sample_index + 1 : settings.sample_count;
  data.texture_lod_bias = -0.5F * std::log2(float(sample_count));
  return data;
}

}  // namespace gnomon::eevee
