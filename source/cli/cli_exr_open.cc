// SPDX-License-Identifier: MIT
// Limits of EXR files: OpenEXR allocates what a header states before it reads it. Checksums of files.
#include "internal/cli_exr_file.hh"
#include "internal/cli_picture_formats.hh"

#include "cli_exr_part.hh"

#include "output_file.hh"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** The numbers, names and values of a file's headers, in its order. */
class HeaderReader {
 public:
  HeaderReader(const ReadBytes &read, std::uint64_t file_bytes) : read_(read), file_bytes_(file_bytes) {}

  std::uint32_t number()
  {
    std::array<char, 4> bytes{};
    read(bytes.data(), bytes.size());
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); i++) {
      value |= std::uint32_t(static_cast<unsigned char>(bytes[i])) << 8U * i;
    }
    return value;
  }

  std::string name()
  {
    constexpr std::size_t length_max = 255;
    std::string text;
    char c = 0;
    for (read(&c, 1); c != '\0' && text.size() <= length_max; read(&c, 1)) {
      text += c;
    }
    if (text.size() > length_max) {
      throw std::runtime_error("has a header that is damaged");
    }
    return text;
  }

  void value(const std::string &name, std::uint32_t bytes)
  {
    if (bytes > file_bytes_ - position_) {
      throw std::runtime_error(
          fmt::format("is cut off: its attribute '{}' has {} bytes, and the file has {}", name, bytes, file_bytes_));
    }
    const bool is_checksum = name == checksum_metadata;
    if (is_checksum) {
      checksum_ = {.position = position_};
    }
    std::array<char, 4096> block;
    for (std::uint32_t left = bytes; left > 0;) {
      const std::uint32_t size = std::min(left, std::uint32_t(block.size()));
      read(block.data(), size);
      left -= size;
      if (is_checksum) {
        checksum_.text.append(block.data(), size);
      }
    }
  }

  [[nodiscard]] const StoredChecksum &checksum() const
  {
    return checksum_;
  }

 private:
  void read(char *bytes, std::size_t size)
  {
    if (size > file_bytes_ - position_) {
      throw std::runtime_error("is cut off in its header");
    }
    read_(bytes, size);
    position_ += size;
  }

  const ReadBytes &read_;
  std::uint64_t file_bytes_;
  /** Bytes that were read. */
  std::uint64_t position_ = 0;
  StoredChecksum checksum_;
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

StoredChecksum scan_headers(const ReadBytes &read, std::uint64_t file_bytes)
{
  HeaderReader reader(read, file_bytes);
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
  return reader.checksum();
}

std::string file_checksum(const ReadBytes &read, std::uint64_t file_bytes, const StoredChecksum &stored)
{
  std::uint64_t hash = 0;
  std::vector<char> block(std::size_t(1) << 16U);
  const auto add = [&](std::uint64_t bytes) {
    while (bytes > 0) {
      const auto size = std::size_t(std::min(bytes, std::uint64_t(block.size())));
      read(block.data(), size);
      hash = XXH3_64bits_withSeed(block.data(), size, hash);
      bytes -= size;
    }
  };
  add(stored.position);
  std::string value(stored.text.size(), '\0');
  read(value.data(), value.size());
  add(file_bytes - stored.position - value.size());
  return fmt::format("{:016x}", hash);
}

/** \a stream stays the caller's. */
static ReadBytes read_from(std::istream &stream)
{
  return [&stream](char *bytes, std::size_t size) {
    if (!stream.read(bytes, std::streamsize(size))) {
      throw std::runtime_error("cannot be read to its end");
    }
  };
}

void ExrInput::check_content() const
{
  std::ifstream stream(path_, std::ios::binary);
  // OpenEXR finds the checksum behind an attribute whose size is damaged.
  const auto *attribute = file_->header(0).findTypedAttribute<Imf::StringAttribute>(checksum_metadata);
  const std::string stated = attribute ? attribute->value() : "";
  if (stated != checksum_.text ||
      (!stated.empty() && stated != file_checksum(read_from(stream), file_bytes_, checksum_))) {
    throw std::runtime_error("is damaged, or another program has changed it: its checksum differs");
  }
}

glm::ivec2 size_of_window(const Imath::Box2i &window)
{
  const auto edge = [](int min, int max) { return std::int64_t(max) - min + 1; };
  check_edges(edge(window.min.x, window.max.x), edge(window.min.y, window.max.y));
  return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

ExrInput::ExrInput(const fs::path &path) : path_(path)
{
  output::require_readable(path);
  std::error_code error;
  file_bytes_ = fs::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) {
    throw std::runtime_error(
        fmt::format("cannot be read: {}", (error ? error : std::error_code(errno, std::generic_category())).message()));
  }
  checksum_ = scan_headers(read_from(stream), file_bytes_);
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
