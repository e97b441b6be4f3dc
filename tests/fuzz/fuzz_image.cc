// SPDX-License-Identifier: MIT
// Decodes PNG, JPEG and WebP.
#include "fuzz_file.hh"
#include "image_decoder.hh"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  using namespace gnomon;
  for (const bool has_16_bits : {false, true}) {
    try {
      const std::unique_ptr<image::Decoder> decoder = image::open_decoder({data, size});
      // Callers do the same.
      if (std::uint64_t(decoder->width()) * decoder->height() > (1U << 20U)) {
        return 0;
      }
      if (has_16_bits) {
        static_cast<void>(decoder->read_rgba16());
      }
      else {
        static_cast<void>(decoder->read_rgba8());
      }
    }
    catch (const image::Error &) {
    }
  }
  return 0;
}
