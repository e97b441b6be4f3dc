// SPDX-License-Identifier: MIT
// Feedback of the device about submitted work: losses, depths and programs that did not compile.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"

#include <algorithm>
#include <cstring>

namespace gnomon::eevee {

void Engine::take_losses(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  const std::uint64_t loss_count = viewport.device().loss_count();
  if (data.loss_count != loss_count) {
    data.is_recorded = false;
    data.stl.recorded.reset();
    data.stl.clusters.made.reset();
    data.loss_count = loss_count;
  }
  SharedData &shared = *data.shared;
  if (shared.loss_count != loss_count) {
    shared.synced.reset();
    shared.recorded.reset();
    shared.shadows.invalidate();
    sync_lamps(shared, viewport.device().limits());
    shared.loss_count = loss_count;
  }
}

bool awaits_depths(const Data &data, const draw::View &view)
{
  return data.is_seen && data.stl.shadows->reads_depths() && data.depth_feedback.view != view;
}

bool Engine::take_feedback(draw::Viewport &viewport, const gpu::Feedback &feedback)
{
  Data &data = viewport.engine_data<Data>(*this);
  shaders_->take_failures(feedback);
  DepthFeedback &depths = data.depth_feedback;
  bool is_final = true;
  for (const gpu::Feedback::Texels &texels : feedback.texels) {
    const bool is_depth = viewport.has_depth_texture() && viewport.depth_texture().id() == texels.texture;
    if (!is_depth || texels.tag < depths.first_valid_tag) {
      continue;
    }
    depths.received_tag = std::max(depths.received_tag, texels.tag);
    const draw::View &requested = depths.requested_views[texels.tag % depths.requested_views.size()];
    // Several frames of one view may have requested the same depths before the first request was answered.
    if (depths.view != requested) {
      depths.depths.resize(texels.bytes.size() / sizeof(float));
      std::memcpy(depths.depths.data(), texels.bytes.data(), texels.bytes.size());
      depths.view = requested;
      data.stl.shadows->fit_again();
      is_final = false;
    }
  }
  return is_final;
}

}  // namespace gnomon::eevee
