// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"
#include "eevee_frame_tree.hh"
#include "eevee_settings.hh"

#include "gpu_device.hh"

#include <functional>

namespace gnomon::eevee {

/** The nodes of a report for textures and blocks, to which each module adds its own. Internal to the engine. */
struct ResourceReport {
  const gpu::Device &device;
  const Settings &settings;
  /** Features that the programs of the frame have. */
  Feature features = Feature::None;
  /** \see Data::is_recorded */
  bool is_recorded = false;
  /** The reason why no program has a feature. */
  std::function<std::string(Feature)> why_no_feature;
  std::vector<FrameNode> targets{};
  std::vector<FrameNode> blocks{};

  [[nodiscard]] bool has(Feature feature) const
  {
    return eevee::has(features, feature);
  }
  void add_target(const gpu::Texture &texture, std::string what, std::string why, std::string why_not);
  /** \a why_not: after the passes were recorded */
  void add_block(const gpu::Buffer &buffer, std::string what, std::string why, std::string why_not);
};

inline constexpr const char *not_asked_for = "not asked for";

}  // namespace gnomon::eevee
