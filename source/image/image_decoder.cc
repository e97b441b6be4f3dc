// SPDX-License-Identifier: MIT
#include "image_decoder.hh"

#include "internal/image_decoders.hh"

#include <algorithm>
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

std::unique_ptr<Decoder> open_decoder(std::span<const unsigned char> file)
{
  switch (format_of(file)) {
    case Format::Png: return open_png(file);
    case Format::Jpeg: return open_jpeg(file);
    case Format::Webp: return open_webp(file);
    case Format::None: break;
  }
  throw Error(file.empty() ? "is empty" : "is none of PNG, JPEG and WebP");
}

}  // namespace gnomon::image
