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

Format format_of(std::span<const unsigned char> file)
{
  using namespace std::string_view_literals;
  return begins_with(file, "\x89PNG\r\n\x1A\n"sv) ? Format::Png
         : begins_with(file, "\xFF\xD8\xFF"sv)    ? Format::Jpeg
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
    case Format::None: break;
  }
  throw Error(file.empty() ? "is empty" : "is neither PNG nor JPEG");
}

}  // namespace gnomon::image
