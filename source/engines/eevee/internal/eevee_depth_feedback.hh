// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_picture_depths.hh"

#include "gpu_device.hh"

#include <array>
#include <optional>
#include <vector>

namespace gnomon::eevee {

/** Depths of a viewport that are read back, to fit the cascades of suns to them. Internal to the engine. */
class DepthFeedback {
 public:
  /** Whether the host has the depths of \a view. */
  [[nodiscard]] bool is_of(const draw::View &view) const
  {
    return view_ == view;
  }
  /** Whether the last request has no result yet. */
  [[nodiscard]] bool is_pending() const
  {
    return requested_tag_ >= first_valid_tag_ && received_tag_ < requested_tag_;
  }
  /** \a size_px: of the depth texture. */
  [[nodiscard]] PictureDepths picture(glm::ivec2 size_px) const
  {
    return {depths_, size_px, view_.value_or(draw::View())};
  }
  /** The next request is of \a view. */
  void request(const draw::View &view);
  /** Read the depths of the last request back from \a texture. */
  void read_back(gpu::Device &device, const gpu::Texture &texture) const;
  /** Take the answers of \a feedback to requests that read \a texture. \return true if there are other depths */
  bool take(const gpu::Feedback &feedback, gpu::ResourceId texture);
  /** Discard the depths and all pending requests, because the scene or the size changed. */
  void forget();

 private:
  /** The views of the last requests, indexed by the tag modulo the size of the array. */
  std::array<draw::View, 4> requested_views_{};
  std::uint64_t requested_tag_ = 0;
  std::uint64_t received_tag_ = 0;
  /** Requests with lower tags belong to an earlier state of the scene and are ignored. */
  std::uint64_t first_valid_tag_ = 1;
  /** The view of `depths_`. Empty if there are no depths. */
  std::optional<draw::View> view_;
  std::vector<float> depths_;
};

}  // namespace gnomon::eevee
