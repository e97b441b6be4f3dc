// SPDX-License-Identifier: MIT
#include "internal/eevee_view_lights.hh"
#include "internal/eevee_resource_report.hh"

#include <fmt/format.h>

namespace gnomon::eevee {

void ViewLights::make(gpu::Device &device)
{
  if (!lights_.plan().is_clustered()) {
    lists_ = {};
    made_.reset();
    block_ = {};
    texture_ = {};
  }
  else if (!block_) {
    block_ = device.create_buffer({"light_cluster_block", gpu::BufferKind::Uniform, sizeof(shared::LightClusterBlock)});
    made_.reset();
  }
}

void ViewLights::bind(draw::ShadingGroup &group) const
{
  if (block_) {
    group.bind_uniform("light_cluster_block", block_);
    group.bind_texture_ref("light_lists", &binding_);
  }
}

void ViewLights::update_lists(const FrameSample &sample, gpu::CommandList &list)
{
  const glm::ivec2 size_px = sample.viewport.drawn_size_px();
  const Key key{sample.eye_view, size_px, lights_.reaches_revision()};
  if (made_ != key || !texture_) {
    made_.reset();
    gpu::Device &device = sample.viewport.device();
    lists_.build(lights_.plan().lamps, sample.eye_view, size_px, lights_.plan().bounds_ws,
                 std::size_t(device.limits().buffer_texels_max));
    list.update(block_, 0, std::as_bytes(std::span(&lists_.block(), 1)));
    const std::span<const float> values = lists_.values();
    if (!texture_ || int(values.size()) > texture_.desc().width) {
      texture_ = device.create_texture({.name = "light_lists",
                                        .kind = gpu::TextureKind::Buffer,
                                        .format = gpu::Format::R32F,
                                        .width = light_texture_width(values.size(), device)});
    }
    device.upload(texture_, 0, std::as_bytes(values));
    made_ = key;
  }
  // Another viewport may have made the sampler anew.
  binding_ = {texture_.id(), lights_.sampler().id()};
}

FrameStep ViewLights::points_step()
{
  return {.name = "lamp_points",
          .summary =
              "Moves each lamp with a size to one of its points, and gives emissive surfaces lamps at some of theirs.",
          .part = FrameStep::Part::Each,
          .need =
              [](const FrameState &state) {
                if (!state.has_lamp_points) {
                  return Need{false, state.settings.sample_count != 1 ? "no lamp that gives light has a size"
                                                                      : "one sample: each lamp is shaded as a whole"};
                }
                return state.is_seen ? Need{true, "each sample sees one point of each lamp with a size"}
                                     : Need{false, nothing_seen};
              },
          .writes = {"light_block", "light_texture", "world_block"},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                points_ =
                    lights_.plan().points.sample(std::uint32_t(sample.index), sample.settings.seed, std::move(points_));
                sample.lamp_points = points_.points;
                lights_.write_points(points_, sample.viewport.device(), list);
              }};
}

FrameStep ViewLights::lists_step()
{
  return {.name = "light_clusters",
          .summary =
              "If many lamps have a range, lists those that reach each part of the view ([decision "
              "0024](decisions/0024-light-clusters.md)).",
          .part = FrameStep::Part::Each,
          .need =
              [](const FrameState &state) {
                return !has(state.features, Feature::LightClusters) ? Need{false, "few lamps have a range"}
                       : state.is_seen ? Need{true, "pixels visit the lamps that can reach them"}
                                       : Need{false, nothing_seen};
              },
          .writes = {"light_cluster_block", "light_lists"},
          .record = [this](FrameSample &sample, gpu::CommandList &list) { update_lists(sample, list); }};
}

void ViewLights::report(ResourceReport &report) const
{
  report.add_target(texture_, "light_lists",
                    fmt::format("{} entries for {} parts of the view", lists_.entry_count(), lists_.froxel_count()),
                    report.why_no_feature(Feature::LightClusters));
  report.add_block(block_, "light_cluster_block", "the grid of light_lists",
                   report.why_no_feature(Feature::LightClusters));
}

}  // namespace gnomon::eevee
