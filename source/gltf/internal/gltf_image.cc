// SPDX-License-Identifier: MIT
#include "internal/gltf_image.hh"

#include "internal/gltf_report.hh"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

namespace gnomon::gltf {

using scene::Image;

namespace {

using ByteSpan = std::span<const unsigned char>;

/** Texture size limit of all current GPUs. */
constexpr int edge_max = 16384;
/**
 * Largest ratio of decoded to encoded bytes. Deflate: 1032. JPEG: smaller, as 64 samples take at least two bits in each
 * channel.
 */
constexpr std::uint64_t expansion_max = 1032;

bool begins_with(ByteSpan bytes, std::string_view start)
{
  return bytes.size() >= start.size() &&
         std::equal(start.begin(), start.end(), bytes.begin(),
                    [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

/** A file name with which OpenImageIO selects the reader; nullptr for formats that glTF does not allow. */
const char *format_of(ByteSpan bytes)
{
  using namespace std::string_view_literals;
  return begins_with(bytes, "\x89PNG\r\n\x1A\n"sv) ? "png" : begins_with(bytes, "\xFF\xD8\xFF"sv) ? "jpeg" : nullptr;
}

/** JPEG decoders fill in missing data at the end, so the end marker is checked. */
bool is_cut_off_jpeg(ByteSpan bytes)
{
  constexpr std::array<unsigned char, 2> end_marker{0xFF, 0xD9};
  return std::search(bytes.rbegin(), bytes.rend(), end_marker.rbegin(), end_marker.rend()) == bytes.rend();
}

/** Expands one to four channels of each texel to four, in place. */
void spread_channels(std::vector<std::uint8_t> &texels, std::size_t texel_count, int channel_count)
{
  const auto count = static_cast<std::size_t>(channel_count);
  const bool is_grey = count < 3;
  // Backwards, so that no byte is overwritten before it is read.
  for (std::size_t i = texel_count; i-- > 0;) {
    const std::uint8_t *source = texels.data() + i * count;
    const std::array<std::uint8_t, 4> texel{source[0], source[is_grey ? 0 : 1], source[is_grey ? 0 : 2],
                                            count % 2 == 0 ? source[count - 1] : std::uint8_t(255)};
    std::copy(texel.begin(), texel.end(), texels.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
}

}  // namespace

struct ImageDecoder::Input {
  std::string what;
  OIIO::Filesystem::IOMemReader reader;
  OIIO::Filesystem::IOProxy *proxy = &reader;
  std::unique_ptr<OIIO::ImageInput> file{};
  OIIO::ImageSpec spec{};

  [[nodiscard]] std::uint64_t texel_count() const
  {
    return std::uint64_t(spec.width) * std::uint64_t(spec.height);
  }
};

ImageDecoder::ImageDecoder(ByteSpan bytes, std::string what, std::uint64_t texel_count_max)
    : input_(new Input{std::move(what), {const_cast<unsigned char *>(bytes.data()), bytes.size()}})
{
  const std::string &name = input_->what;
  const char *format = format_of(bytes);
  if (format == nullptr) {
    throw Fault(name, bytes.empty() ? "is empty" : "is neither PNG nor JPEG");
  }
  OIIO::ImageSpec config;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &input_->proxy);
  // Otherwise colours would be multiplied by alpha.
  config.attribute("oiio:UnassociatedAlpha", 1);
  input_->file = OIIO::ImageInput::create(format);
  if (!input_->file) {
    throw Fault(name, "cannot be decoded: " + printable(OIIO::geterror()));
  }
  OIIO::ImageSpec &spec = input_->spec;
  if (!input_->file->open(format, spec, config)) {
    throw Fault(name, "cannot be decoded: " + printable(input_->file->geterror()));
  }
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.nchannels > 4) {
    throw Fault(name, "has no texels, or more than four channels");
  }
  const std::string size = std::to_string(spec.width) + 'x' + std::to_string(spec.height);
  if (spec.width > edge_max || spec.height > edge_max) {
    throw Fault(name, "is too large, " + size + " texels: an edge may have " + std::to_string(edge_max));
  }
  if (texel_count() > texel_count_max) {
    throw Fault(name, "is too large, " + size + " texels: " + std::to_string(texel_count_max) +
                          " are left of those that all images may have");
  }
  if (texel_count() / 8 / expansion_max > bytes.size()) {
    throw Fault(name, "is cut off: " + size + " texels cannot be in " + std::to_string(bytes.size()) + " bytes");
  }
  if (std::string_view(format) == "jpeg" && is_cut_off_jpeg(bytes)) {
    throw Fault(name, "is cut off");
  }
}

ImageDecoder::ImageDecoder(ImageDecoder &&) noexcept = default;
ImageDecoder::~ImageDecoder() = default;

std::uint64_t ImageDecoder::texel_count() const
{
  return input_->texel_count();
}

Image ImageDecoder::read()
{
  const OIIO::ImageSpec &spec = input_->spec;
  Image image;
  image.width = static_cast<std::uint32_t>(spec.width);
  image.height = static_cast<std::uint32_t>(spec.height);
  image.texels.resize(4 * texel_count());
  if (!input_->file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, image.texels.data())) {
    throw Fault(input_->what, "cannot be decoded: " + printable(input_->file->geterror()));
  }
  spread_channels(image.texels, texel_count(), spec.nchannels);
  return image;
}

}  // namespace gnomon::gltf
