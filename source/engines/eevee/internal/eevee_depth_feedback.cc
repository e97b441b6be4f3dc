// SPDX-License-Identifier: MIT
#include "internal/eevee_depth_feedback.hh"

#include <algorithm>
#include <cstring>

namespace gnomon::eevee {

void DepthFeedback::request(const draw::View &view)
{
  const std::uint64_t tag = ++requested_tag_;
  requested_views_[tag % requested_views_.size()] = view;
}

void DepthFeedback::read_back(gpu::Device &device, const gpu::Texture &texture) const
{
  device.read_back(texture, 0, requested_tag_);
}

bool DepthFeedback::take(const gpu::Feedback &feedback, gpu::ResourceId texture)
{
  bool is_changed = false;
  for (const gpu::Feedback::Texels &texels : feedback.texels) {
    if (texels.texture != texture || texels.tag < first_valid_tag_) {
      continue;
    }
    received_tag_ = std::max(received_tag_, texels.tag);
    const draw::View &requested = requested_views_[texels.tag % requested_views_.size()];
    // Several frames of one view may have requested the same depths before the first request was answered.
    if (view_ != requested) {
      depths_.resize(texels.bytes.size() / sizeof(float));
      std::memcpy(depths_.data(), texels.bytes.data(), texels.bytes.size());
      view_ = requested;
      is_changed = true;
    }
  }
  return is_changed;
}

void DepthFeedback::forget()
{
  first_valid_tag_ = requested_tag_ + 1;
  view_.reset();
  depths_.clear();
}

}  // namespace gnomon::eevee
