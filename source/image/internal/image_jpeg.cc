// SPDX-License-Identifier: MIT
#include "internal/image_decoders.hh"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <string>
#include <type_traits>

namespace gnomon::image {

namespace {

struct FreeJpeg {
  void operator()(void *handle) const
  {
    tjDestroy(handle);
  }
};

/** Decoders replace data that are missing at the end, so the end marker is checked. */
bool is_cut_off(std::span<const unsigned char> file)
{
  constexpr std::array<unsigned char, 2> end_marker{0xFF, 0xD9};
  return std::search(file.rbegin(), file.rend(), end_marker.rbegin(), end_marker.rend()) == file.rend();
}

class JpegDecoder final : public Decoder {
 public:
  explicit JpegDecoder(std::span<const unsigned char> file) : file_(file), handle_(tjInitDecompress())
  {
    int width = 0;
    int height = 0;
    int subsampling = 0;
    int colors = 0;
    check(tjDecompressHeader3(handle_.get(), file.data(), file.size(), &width, &height, &subsampling, &colors));
    if (is_cut_off(file)) {
      throw Error("is cut off");
    }
    width_ = std::uint32_t(width);
    height_ = std::uint32_t(height);
    is_cmyk_ = colors == TJCS_CMYK || colors == TJCS_YCCK;
  }

  std::vector<std::uint8_t> read_rgba8() override
  {
    std::vector<std::uint8_t> values(value_count());
    check(tjDecompress2(handle_.get(), file_.data(), file_.size(), values.data(), int(width_), 0, int(height_),
                        is_cmyk_ ? TJPF_CMYK : TJPF_RGBA, TJFLAG_LIMITSCANS));
    if (is_cmyk_) {
      // Files store the amount of light that each ink lets through.
      for (std::size_t i = 0; i < values.size(); i += 4) {
        for (std::size_t color = 0; color < 3; color++) {
          values[i + color] = std::uint8_t((values[i + color] * values[i + 3] + 127) / 255);
        }
        values[i + 3] = 255;
      }
    }
    return values;
  }

 private:
  std::span<const unsigned char> file_;
  std::unique_ptr<std::remove_pointer_t<tjhandle>, FreeJpeg> handle_;
  bool is_cmyk_ = false;

  /** Warnings are of data that the decoder replaces, as other programs do. */
  void check(int result) const
  {
    if (result != 0 && tjGetErrorCode(handle_.get()) == TJERR_FATAL) {
      throw Error(std::string("cannot be decoded: ") + tjGetErrorStr2(handle_.get()));
    }
  }
};

}  // namespace

std::unique_ptr<Decoder> open_jpeg(std::span<const unsigned char> file)
{
  return std::make_unique<JpegDecoder>(file);
}

}  // namespace gnomon::image
