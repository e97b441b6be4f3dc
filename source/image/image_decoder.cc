// SPDX-License-Identifier: MIT
#include "image_decoder.hh"

#include "internal/image_decoders.hh"

#include <algorithm>
#include <string>
#include <string_view>

namespace gnomon::image {

static bool begins_with(std::span<const unsigned char> bytes, std::string_view start)
{
  return bytes.size() >= start.size() &&
         std::equal(start.begin(), start.end(), bytes.begin(),
                    [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

/** A RIFF container: its length comes between both names. */
static bool is_webp(std::span<const unsigned char> file)
{
  constexpr std::size_t name_start = 8;
  return begins_with(file, "RIFF") && file.size() > name_start && begins_with(file.subspan(name_start), "WEBP");
}

Format format_of(std::span<const unsigned char> file)
{
  using namespace std::string_view_literals;
  return begins_with(file, "\x89PNG\r\n\x1A\n"sv) ? Format::Png
         : begins_with(file, "\xFF\xD8\xFF"sv)    ? Format::Jpeg
         : is_webp(file)                          ? Format::Webp
                                                  : Format::None;
}

std::vector<std::uint16_t> Decoder::read_rgba16()
{
  const std::vector<std::uint8_t> values = read_rgba8();
  std::vector<std::uint16_t> wide(values.size());
  std::ranges::transform(values, wide.begin(), [](std::uint8_t value) { return std::uint16_t(257 * value); });
  return wide;
}

static std::unique_ptr<Decoder> open_format(std::span<const unsigned char> file)
{
  switch (format_of(file)) {
    case Format::Png: return open_png(file);
    case Format::Jpeg: return open_jpeg(file);
    case Format::Webp: return open_webp(file);
    case Format::None: break;
  }
  using namespace std::string_view_literals;
  throw Error(file.empty() ? "is empty"
              : begins_with(file, "\xABKTX 20\xBB\r\n\x1A\n"sv)
                  ? "is KTX2, which is not read: only PNG, JPEG and WebP are"
                  : "is none of PNG, JPEG and WebP");
}

std::unique_ptr<Decoder> open_decoder(std::span<const unsigned char> file)
{
  std::unique_ptr<Decoder> decoder = open_format(file);
  // Deflate repeats 258 bytes by two bits at best, and a texel has a bit or more. WebP stores one color in no bits.
  constexpr std::uint64_t texels_per_byte_max = std::uint64_t(8) * 1032;
  const std::uint64_t texel_count = std::uint64_t(decoder->width()) * decoder->height();
  if (format_of(file) != Format::Webp && texel_count / texels_per_byte_max > file.size()) {
    throw Error("is cut off: " + std::to_string(decoder->width()) + 'x' + std::to_string(decoder->height()) +
                " texels cannot be in " + std::to_string(file.size()) + " bytes");
  }
  return decoder;
}

}  // namespace gnomon::image
