// SPDX-License-Identifier: MIT
#include "eevee_frame_needs.hh"

#include "eevee_engine_data.hh"

namespace gnomon::eevee {

Need need_lamp_points(const FrameState &state)
{
  if (state.data.shared->lamp_points.empty()) {
    return {false, state.settings.sample_count != 1 ? "no lamp that gives light has a size"
                                                    : "one sample: each lamp is shaded as a whole"};
  }
  return state.data.is_seen ? Need{true, "each sample sees one point of each lamp with a size"}
                            : Need{false, nothing_seen};
}

Need need_light_clusters(const FrameState &state)
{
  if (!has(state.data.stl.features, Feature::LightClusters)) {
    return {false, "few lamps have a range"};
  }
  return state.data.is_seen ? Need{true, "pixels visit the lamps that can reach them"} : Need{false, nothing_seen};
}

Need need_shadows(const FrameState &state)
{
  if (!has(state.data.stl.features, any_shadow)) {
    return {false, why_no_shadow(state, "no lamp casts a shadow")};
  }
  return state.data.is_seen ? Need{true, "some layers were out of date"} : Need{false, nothing_seen};
}

bool has_gbuffer(const Data &data)
{
  return !data.psl->gbuffer_pass.is_empty();
}

Need need_gbuffer(const FrameState &state)
{
  if (!state.data.is_seen) {
    return {false, nothing_seen};
  }
  return has_gbuffer(state.data) ? Need{true, "each pixel is lit once"} : Need{false, why_forward};
}

Need need_deferred_lit(const FrameState &state)
{
  const Need need = need_gbuffer(state);
  return need.is_needed ? Need{true, "pixels of the G-buffer"} : need;
}

Need need_depth(const FrameState &state)
{
  if (!state.data.is_seen) {
    return {false, nothing_seen};
  }
  if (has_gbuffer(state.data) && !state.data.stl.shadows->reads_depths()) {
    return {false, "the G-buffer has its own depths"};
  }
  return {true, "each pixel is lit once"};
}

Need need_forward_depth(const FrameState &state)
{
  const Need need = need_gbuffer(state);
  if (!need.is_needed) {
    return need;
  }
  const PassList &psl = *state.data.psl;
  return psl.depth_pass.is_empty() && psl.depth_pass_cull.is_empty()
             ? Need{false, all_in_gbuffer}
             : Need{true, "objects that are not in the G-buffer"};
}

Need need_lit(const FrameState &state)
{
  if (!state.data.is_seen) {
    return {false, nothing_seen};
  }
  const PassList &psl = *state.data.psl;
  return has_gbuffer(state.data) && psl.lit_pass.is_empty() && psl.tint_pass.is_empty()
             ? Need{false, all_in_gbuffer}
             : Need{true, "objects in the view"};
}

Need need_background(const FrameState &state)
{
  using enum Background::Kind;
  if (state.settings.background.kind == None) {
    return {false, "the settings have no background"};
  }
  return (*state.data.psl).background_pass.is_empty() ? Need{false, "the scene has no world"}
                                                      : Need{true, "pixels without a surface"};
}

Need need_blend(const FrameState &state)
{
  if (!state.data.is_seen) {
    return {false, nothing_seen};
  }
  return (*state.data.psl).blend_pass.is_empty() ? Need{false, "no material that is drawn is blended"}
                                                 : Need{true, "blended objects, from back to front"};
}

Need need_film(const FrameState &state)
{
  if (state.data.adaptive.is_active) {
    return {false, "adaptive_film is drawn"};
  }
  if (state.data.is_seen) {
    return {true, "samples of each pixel are added up"};
  }
  return {state.data.film_sample_count == 0, "nothing is seen: the picture is cleared"};
}

Need need_picture_depth(const FrameState &state)
{
  if (!state.data.target.depth) {
    return {false, "no target takes depth"};
  }
  if (state.settings.sample_count == 1) {
    return {false, "the depth of the only sample is that of the picture"};
  }
  return !state.data.is_seen            ? Need{false, nothing_seen}
         : state.data.has_picture_depth ? Need{false, "it is up to date"}
                                        : Need{true, "the target takes depth, without the samples' offsets"};
}

Need need_tonemap(const FrameState &state)
{
  const draw::Target &target = state.data.target;
  if (!target) {
    return {false, "no target was given"};
  }
  if (state.data.is_seen) {
    return {true, "a target was given"};
  }
  return target.composition == draw::Composition::Over
             ? Need{false, nothing_seen}
             : Need{true, "nothing is seen: the target's rectangle is cleared"};
}

}  // namespace gnomon::eevee
