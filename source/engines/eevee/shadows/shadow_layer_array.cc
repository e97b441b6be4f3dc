// SPDX-License-Identifier: MIT
#include "shadow_layer_array.hh"

#include <fmt/format.h>

namespace gnomon::eevee {

bool LayerArray::resize(gpu::Device &device, int size_px, int layers, bool has_content)
{
  const bool is_same = texture_ ? texture_.desc().width == size_px && texture_.desc().layers == layers : layers == 0;
  if (is_same) {
    return false;
  }
  if (!has_content || layers == 0) {
    // Free the old texture first, so that both textures need not fit into memory.
    framebuffers_.clear();
    texture_ = {};
  }
  if (layers == 0) {
    return true;
  }
  gpu::Texture texture = device.create_texture({.name = name_,
                                                .kind = gpu::TextureKind::Array,
                                                .format = format_,
                                                .width = size_px,
                                                .height = size_px,
                                                .layers = layers});
  if (texture_) {
    device.copy_layers(texture_, texture);
  }
  framebuffers_.clear();
  texture_ = std::move(texture);
  return true;
}

void LayerArray::set_format(gpu::Format format)
{
  if (format != format_) {
    framebuffers_.clear();
    texture_ = {};
    format_ = format;
  }
}

const gpu::Framebuffer &LayerArray::framebuffer(gpu::Device &device, int first, int count)
{
  gpu::Framebuffer &framebuffer = framebuffers_[{first, count}];
  if (!framebuffer) {
    const gpu::Attachment layers{.texture = &texture_, .layer = first, .layer_count = count};
    const bool is_depth = gpu::is_depth(format_);
    framebuffer = device.create_framebuffer(
        {.name =
             count == 1 ? fmt::format("{} {}", name_, first) : fmt::format("{} {}-{}", name_, first, first + count - 1),
         .colors = is_depth ? std::vector<gpu::Attachment>{} : std::vector<gpu::Attachment>{layers},
         .depth = is_depth ? layers : gpu::Attachment{}});
  }
  return framebuffer;
}

}  // namespace gnomon::eevee
