// SPDX-License-Identifier: MIT
#include "internal/image_decoders.hh"
#include "internal/image_png_context.hh"

#include <algorithm>

namespace gnomon::image {

namespace {

constexpr const char *failure = "cannot be decoded";
/** Most bytes of a chunk without texels: texts and profiles, which may be compressed. */
constexpr std::size_t chunk_bytes_max = std::size_t(1) << 24U;

class PngDecoder final : public Decoder {
 public:
  explicit PngDecoder(std::span<const unsigned char> file) : context_(spng_ctx_new(0))
  {
    if (!context_) {
      throw Error("cannot be decoded: no memory");
    }
    check_png(spng_set_chunk_limits(context_.get(), chunk_bytes_max, chunk_bytes_max), failure);
    check_png(spng_set_png_buffer(context_.get(), file.data(), file.size()), failure);
    check_png(spng_get_ihdr(context_.get(), &header_), failure);
    width_ = header_.width;
    height_ = header_.height;
  }

  std::vector<std::uint8_t> read_rgba8() override
  {
    if (header_.bit_depth < 16) {
      return read<std::uint8_t>(SPNG_FMT_RGBA8);
    }
    const std::vector<std::uint16_t> wide = read_rgba16();
    std::vector<std::uint8_t> values(wide.size());
    std::ranges::transform(wide, values.begin(),
                           [](std::uint16_t value) { return std::uint8_t((value + 128U) / 257U); });
    return values;
  }
  std::vector<std::uint16_t> read_rgba16() override
  {
    return header_.bit_depth < 16 ? Decoder::read_rgba16() : read<std::uint16_t>(SPNG_FMT_RGBA16);
  }

 private:
  PngContext context_;
  spng_ihdr header_{};

  template <typename Value>
  std::vector<Value> read(spng_format format)
  {
    std::vector<Value> values(value_count());
    check_png(spng_decode_image(context_.get(), values.data(), values.size() * sizeof(Value), format, SPNG_DECODE_TRNS),
              failure);
    // The texels may be there before the end of their chunks, whose checksums are then unread.
    const int rest = spng_decode_chunks(context_.get());
    // Texts after the texels are not read, however many there are.
    check_png(rest == SPNG_ECHUNK_LIMITS ? 0 : rest, failure);
    return values;
  }
};

}  // namespace

std::unique_ptr<Decoder> open_png(std::span<const unsigned char> file)
{
  return std::make_unique<PngDecoder>(file);
}

}  // namespace gnomon::image
