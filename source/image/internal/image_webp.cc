// SPDX-License-Identifier: MIT
#include "internal/image_decoders.hh"

#include <webp/decode.h>

#include <cstddef>
#include <string>

namespace gnomon::image {

namespace {

const char *webp_reason(VP8StatusCode status)
{
  switch (status) {
    case VP8_STATUS_OUT_OF_MEMORY: return "no memory";
    case VP8_STATUS_NOT_ENOUGH_DATA: return "is cut off";
    case VP8_STATUS_UNSUPPORTED_FEATURE: return "unsupported feature";
    default: return "invalid data";
  }
}

void check_webp(VP8StatusCode status)
{
  if (status != VP8_STATUS_OK) {
    throw Error(std::string("cannot be decoded: ") + webp_reason(status));
  }
}

/** The header states the size of the file without its first 8 bytes, so that nothing is allocated for a part of a file.
 */
bool is_webp_cut_off(std::span<const unsigned char> file)
{
  constexpr std::size_t header_bytes = 8;
  std::uint32_t stated = 0;
  for (std::size_t i = 0; i < 4; i++) {
    stated |= std::uint32_t(file[4 + i]) << (8 * i);
  }
  return stated > file.size() - header_bytes;
}

class WebpDecoder final : public Decoder {
 public:
  /** \pre format_of(file) == Format::Webp, which reads the first 12 bytes */
  explicit WebpDecoder(std::span<const unsigned char> file) : file_(file)
  {
    if (is_webp_cut_off(file)) {
      throw Error("is cut off");
    }
    WebPBitstreamFeatures features{};
    check_webp(WebPGetFeatures(file.data(), file.size(), &features));
    if (features.has_animation != 0) {
      throw Error("is an animation");
    }
    width_ = std::uint32_t(features.width);
    height_ = std::uint32_t(features.height);
  }

  std::vector<std::uint8_t> read_rgba8() override
  {
    std::vector<std::uint8_t> values(value_count());
    WebPDecoderConfig config;
    if (WebPInitDecoderConfig(&config) == 0) {
      throw Error("cannot be decoded: the library has another version");
    }
    config.output.colorspace = MODE_RGBA;
    config.output.is_external_memory = 1;
    config.output.u.RGBA.rgba = values.data();
    config.output.u.RGBA.stride = int(4 * width_);
    config.output.u.RGBA.size = values.size();
    check_webp(WebPDecode(file_.data(), file_.size(), &config));
    return values;
  }

 private:
  std::span<const unsigned char> file_;
};

}  // namespace

std::unique_ptr<Decoder> open_webp(std::span<const unsigned char> file)
{
  return std::make_unique<WebpDecoder>(file);
}

}  // namespace gnomon::image
