// SPDX-License-Identifier: MIT
#include "internal/gltf_image.hh"

#include "internal/gltf_accessor.hh"
#include "internal/gltf_report.hh"
#include "scene_image.hh"

namespace gnomon::gltf {

namespace {

/** Texture size limit of all current GPUs. */
constexpr std::uint32_t edge_max = 16384;
/** Limit of the texels of one image, which are decoded at once: 1 GiB. */
constexpr std::uint64_t image_texel_count_max = std::uint64_t(edge_max) * edge_max;

}  // namespace

EncodedImage encoded_image(const File &file, const Model::Image &image, const std::string &what)
{
  EncodedImage encoded;
  if (!image.uri.empty()) {
    encoded.storage = bytes_of_uri(file.base, what, image.uri);
    encoded.bytes = encoded.storage;
  }
  else {
    static_cast<void>(element(file.model.buffer_views, image.buffer_view, what + ": bufferView"));
    encoded.bytes = view_bytes(file, image.buffer_view, 0, what);
  }
  return encoded;
}

ImageDecoder::ImageDecoder(std::span<const unsigned char> bytes, std::string what, std::uint32_t size_max)
    : what_(std::move(what))
{
  try {
    file_ = image::open_decoder(bytes);
  }
  catch (const image::Error &error) {
    throw Fault(what_, printable(error.what()));
  }
  const std::string size = size_text();
  const glm::uvec2 full(file_->width(), file_->height());
  const glm::uvec2 kept = size_max > 0 ? scene::reduced_size(full, size_max) : full;
  if (kept.x > edge_max || kept.y > edge_max) {
    throw LimitFault(what_, "is too large, " + size + " texels: an edge may have " + std::to_string(edge_max) +
                                " unless a limit of the texture size reduces it");
  }
  if (texel_count() > image_texel_count_max) {
    throw LimitFault(what_,
                     "is too large, " + size + " texels: an image may have " + std::to_string(image_texel_count_max));
  }
  kept_texel_count_ = std::uint64_t(kept.x) * kept.y;
}

scene::Image ImageDecoder::read()
{
  scene::Image image;
  image.width = file_->width();
  image.height = file_->height();
  try {
    image.texels = file_->read_rgba8();
  }
  catch (const image::Error &error) {
    throw Fault(what_, printable(error.what()));
  }
  return image;
}

}  // namespace gnomon::gltf
