// SPDX-License-Identifier: MIT
#include "image_png.hh"

#include "internal/image_png_context.hh"

#include <cstdlib>
#include <memory>

namespace gnomon::image {

static constexpr const char *failure = "cannot be encoded";

static void add_texts(spng_ctx *context, std::span<const std::pair<std::string, std::string>> texts)
{
  std::vector<spng_text> entries;
  // The library refers to the texts until the end, and does not change them.
  static char none[] = "";
  for (const auto &[name, value] : texts) {
    // The library refuses empty ones.
    if (value.empty()) {
      continue;
    }
    spng_text &entry = entries.emplace_back();
    entry.type = SPNG_ITXT;
    name.copy(entry.keyword, sizeof(entry.keyword) - 1);
    entry.text = const_cast<char *>(value.c_str());
    entry.length = value.size();
    entry.language_tag = none;
    entry.translated_keyword = none;
  }
  if (!entries.empty()) {
    check_png(spng_set_text(context, entries.data(), std::uint32_t(entries.size())), failure);
  }
}

std::vector<unsigned char> png_file(std::uint32_t width, std::uint32_t height, int channel_count,
                                    std::span<const std::uint8_t> texels,
                                    std::span<const std::pair<std::string, std::string>> texts)
{
  const PngContext context(spng_ctx_new(SPNG_CTX_ENCODER));
  if (!context) {
    throw Error("cannot be encoded: no memory");
  }
  spng_ihdr header{};
  header.width = width;
  header.height = height;
  header.bit_depth = 8;
  header.color_type = channel_count == 3 ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  check_png(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1), failure);
  check_png(spng_set_ihdr(context.get(), &header), failure);
  add_texts(context.get(), texts);
  check_png(spng_encode_image(context.get(), texels.data(), texels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE),
            failure);
  std::size_t size = 0;
  int result = SPNG_OK;
  const std::unique_ptr<void, decltype(&std::free)> buffer(spng_get_png_buffer(context.get(), &size, &result),
                                                           std::free);
  check_png(result, failure);
  const auto *begin = static_cast<const unsigned char *>(buffer.get());
  return {begin, begin + size};
}

}  // namespace gnomon::image
