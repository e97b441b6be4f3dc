// SPDX-License-Identifier: MIT
#include "draw_target_pass.hh"

#include <cmath>

namespace gnomon::draw {

using gpu::State;

void TargetPass::set(Pass &pass, const Target &target, const Picture &picture, const gpu::Shader &shader,
                     const gpu::Sampler &nearest)
{
  const bool is_over = target.composition == Composition::Over;
  constants_.origin_px = target.origin_px;
  constants_.radiance_origin_px = picture.radiance_origin_px;
  constants_.depth_origin_px = picture.depth_origin_px;
  constants_.picture_size_px = picture.size_px;
  constants_.target_size_px = size_in(target, picture.size_px);
  constants_.view_transform = int(target.view_transform);
  constants_.encoding = int(target.encoding);
  constants_.exposure_scale = target.encoding == Encoding::SceneLinear ? 1.0F : std::exp2(target.exposure);
  constants_.sample_scale = picture.scale;
  constants_.is_over = is_over ? 1 : 0;
  constants_.is_straight = target.composition == Composition::ReplaceStraight ? 1 : 0;
  State state = is_over ? State::BlendOver : State::None;
  if (target.depth) {
    constants_.depth = depth_map(picture.clip_from_view, *target.depth);
    state = state | State::WriteDepth;
    if (is_over) {
      state = state | (constants_.depth.is_near_smaller ? State::DepthLessEqual : State::DepthNearerEqual);
    }
  }
  // Blended surfaces without a surface behind them have no depth to compare with the target's.
  const bool has_blended = is_over && target.depth && picture.has_blended;
  const Key key{state, picture.radiance.id(), target.depth ? picture.depth->id() : 0, shader.id(), has_blended};
  if (recorded_ == key) {
    return;
  }
  recorded_ = {};
  pass.clear();
  const auto add_group = [&](State group_state) -> ShadingGroup & {
    ShadingGroup &group = pass.group(shader);
    group.state_enable(group_state);
    group.bind_texture("radiance_texture", picture.radiance, nearest);
    if (target.depth) {
      group.bind_texture("depth_texture", *picture.depth, nearest);
      group.constant_ref("depth_origin_px", &constants_.depth_origin_px);
    }
    group.constant_ref("origin_px", &constants_.origin_px);
    group.constant_ref("radiance_origin_px", &constants_.radiance_origin_px);
    group.constant_ref("picture_size_px", &constants_.picture_size_px);
    group.constant_ref("target_size_px", &constants_.target_size_px);
    group.constant_ref("view_transform", &constants_.view_transform);
    group.constant_ref("encoding", &constants_.encoding);
    group.constant_ref("exposure_scale", &constants_.exposure_scale);
    group.constant_ref("sample_scale", &constants_.sample_scale);
    group.constant_ref("depth_scale", &constants_.depth.scale);
    group.constant_ref("background_depth", &constants_.depth.background);
    group.constant_ref("is_over", &constants_.is_over);
    group.constant_ref("is_straight", &constants_.is_straight);
    group.call_procedural();
    return group;
  };
  add_group(state);
  if (has_blended) {
    add_group(State::BlendOver).constant("is_over", 2);
  }
  recorded_ = key;
}

}  // namespace gnomon::draw
