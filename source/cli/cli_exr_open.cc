// SPDX-License-Identifier: MIT
// Limits of EXR files: OpenEXR allocates what a header states before it reads it. Checksums of headers and pixels.
#include "internal/cli_exr_file.hh"
#include "internal/cli_picture_formats.hh"

#include "cli_exr_part.hh"

#include <ImfChannelList.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <vector>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** The numbers, names and values of a file's headers, in its order, and a hash of them. */
class HeaderReader {
 public:
  HeaderReader(std::istream &stream, std::uint64_t file_bytes) : stream_(stream), file_bytes_(file_bytes) {}

  std::uint32_t number()
  {
    std::array<unsigned char, 4> bytes{};
    stream_.read(reinterpret_cast<char *>(bytes.data()), bytes.size());
    check();
    add(bytes.data(), bytes.size());
    return bytes[0] | unsigned(bytes[1]) << 8U | unsigned(bytes[2]) << 16U | unsigned(bytes[3]) << 24U;
  }

  std::string name()
  {
    constexpr std::size_t length_max = 255;
    std::string text;
    for (char c = 0; stream_.get(c) && c != '\0' && text.size() <= length_max;) {
      text += c;
    }
    check();
    if (text.size() > length_max) {
      throw std::runtime_error("has a header that is damaged");
    }
    add(text.c_str(), text.size() + 1);
    return text;
  }

  void value(const std::string &name, std::uint32_t bytes)
  {
    const auto at = std::uint64_t(stream_.tellg());
    if (bytes > file_bytes_ - std::min(at, file_bytes_)) {
      throw std::runtime_error(
          fmt::format("is cut off: its attribute '{}' has {} bytes, and the file has {}", name, bytes, file_bytes_));
    }
    const bool is_checksum = name == checksum_metadata;
    if (is_checksum) {
      scan_.checksum_at = at;
      scan_.checksum.clear();
    }
    std::array<char, 4096> block;
    for (std::uint32_t left = bytes; left > 0;) {
      const std::uint32_t size = std::min(left, std::uint32_t(block.size()));
      stream_.read(block.data(), size);
      check();
      left -= size;
      if (is_checksum) {
        scan_.checksum.append(block.data(), size);
      }
      else {
        add(block.data(), size);
      }
    }
  }

  [[nodiscard]] const HeaderScan &scan() const
  {
    return scan_;
  }

 private:
  void check()
  {
    if (!stream_) {
      throw std::runtime_error("is cut off in its header");
    }
  }
  void add(const void *bytes, std::size_t size)
  {
    scan_.hash = XXH3_64bits_withSeed(bytes, size, scan_.hash);
  }

  std::istream &stream_;
  std::uint64_t file_bytes_;
  HeaderScan scan_;
};

/** Bytes of pixels that a stored byte can stand for, rounded up. */
std::uint64_t largest_ratio(Imf::Compression compression)
{
  // Deflate repeats 258 bytes by two bits at best.
  constexpr std::uint64_t deflate = 1032;
  switch (compression) {
    case Imf::NO_COMPRESSION: return 1;
    // 128 equal bytes by two.
    case Imf::RLE_COMPRESSION: return 64;
    // 16 equal values of two bytes by three.
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION: return 11;
    // Its Huffman code repeats 256 values of two bytes by ten bits.
    case Imf::PIZ_COMPRESSION: return 410;
    // Three of four bytes are stored.
    case Imf::PXR24_COMPRESSION: return deflate * 4 / 3;
    // Runs, deflated.
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION: return deflate * 64;
    default: return deflate;
  }
}

}  // namespace

HeaderScan scan_headers(std::istream &stream, std::uint64_t file_bytes)
{
  HeaderReader reader(stream, file_bytes);
  if (reader.number() != std::uint32_t(Imf::MAGIC)) {
    throw std::runtime_error("is no EXR file");
  }
  const bool has_parts = Imf::isMultiPart(int(reader.number()));
  std::string name;
  do {
    bool is_empty = true;
    for (name = reader.name(); !name.empty(); name = reader.name()) {
      is_empty = false;
      static_cast<void>(reader.name());
      reader.value(name, reader.number());
    }
    if (is_empty) {
      break;
    }
  } while (has_parts);
  return reader.scan();
}

std::string header_checksum(const HeaderScan &scan)
{
  return fmt::format("{:016x}", scan.hash);
}

std::string pixel_checksum(const Imath::Box2i &window, const Imf::FrameBuffer &pixels)
{
  std::vector<float> row(std::size_t(window.max.x - window.min.x) + 1);
  std::uint64_t hash = 0;
  for (auto channel = pixels.begin(); channel != pixels.end(); ++channel) {
    const Imf::Slice &slice = channel.slice();
    for (int y = window.min.y; y <= window.max.y; y++) {
      // The address of pixel (0, 0) may be outside of the values, and strides may be negative.
      auto address = reinterpret_cast<std::uintptr_t>(slice.base) + slice.yStride * std::size_t(y) +
                     slice.xStride * std::size_t(window.min.x);
      const void *values = reinterpret_cast<const void *>(address);
      if (slice.xStride != sizeof(float)) {
        for (float &value : row) {
          std::memcpy(&value, reinterpret_cast<const void *>(address), sizeof(value));
          address += slice.xStride;
        }
        values = row.data();
      }
      hash = XXH3_64bits_withSeed(values, row.size() * sizeof(float), hash);
    }
  }
  return fmt::format("{:016x}", hash);
}

static void check_checksum(const std::string &stated, const std::string &found, const char *what)
{
  if (stated != found) {
    throw std::runtime_error(
        fmt::format("is damaged, or another program has changed it: the checksum of its {} differs", what));
  }
}

void ExrInput::check_headers() const
{
  if (!scan_.checksum.empty()) {
    check_checksum(scan_.checksum.substr(std::min<std::size_t>(16, scan_.checksum.size())), header_checksum(scan_),
                   "header");
  }
}

void ExrInput::check_pixels(const Imf::FrameBuffer &pixels) const
{
  if (!scan_.checksum.empty()) {
    check_checksum(scan_.checksum.substr(0, 16), pixel_checksum(file_->header(0).dataWindow(), pixels), "pixels");
  }
}

glm::ivec2 size_of_window(const Imath::Box2i &window)
{
  const auto edge = [](int min, int max) { return std::int64_t(max) - min + 1; };
  check_edges(edge(window.min.x, window.max.x), edge(window.min.y, window.max.y));
  return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

ExrInput::ExrInput(const fs::path &path) : file_bytes_(fs::file_size(path))
{
  std::ifstream stream(path, std::ios::binary);
  scan_ = scan_headers(stream, file_bytes_);
  // Rows of a file that is cut off are not looked for: such a file is refused.
  file_.emplace(path.c_str(), Imf::globalThreadCount(), false);
}

void ExrInput::check_memory(int part) const
{
  const Imf::Header &header = file_->header(part);
  const glm::ivec2 size_px = size_of_window(header.dataWindow());
  std::uint64_t bytes = 0;
  std::uint64_t channel_count = 0;
  const std::uint64_t pixel_count = std::uint64_t(size_px.x) * std::uint64_t(size_px.y);
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const Imf::Channel &of = channel.channel();
    const std::uint64_t value_bytes = of.type == Imf::HALF ? 2 : 4;
    bytes += pixel_count / std::uint64_t(of.xSampling) / std::uint64_t(of.ySampling) * value_bytes;
    channel_count++;
  }
  const auto check_values = [&](std::uint64_t rows, const char *what) {
    if (std::uint64_t(size_px.x) * rows * channel_count > exr_value_count_max) {
      throw std::runtime_error(fmt::format("has {}x{} {} with {} channels, which are more than {} values", size_px.x,
                                           rows, what, channel_count, exr_value_count_max));
    }
  };
  check_values(std::uint64_t(size_px.y), "pixels");
  if (header.hasTileDescription()) {
    // OpenEXR reads a row of tiles at once.
    check_values(header.tileDescription().ySize, "pixels in a row of tiles");
  }
  if (bytes / largest_ratio(header.compression()) > file_bytes_) {
    throw std::runtime_error(fmt::format("is cut off or damaged: its {} bytes cannot be {}x{} pixels with {} channels",
                                         file_bytes_, size_px.x, size_px.y, channel_count));
  }
}

}  // namespace gnomon::cli
