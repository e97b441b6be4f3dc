// SPDX-License-Identifier: MIT
#include "internal/cli_exr_file.hh"

#include "cli_exr_part.hh"
#include "output_file.hh"

#include <fmt/format.h>

#include <IexBaseExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <stdexcept>
#include <thread>

namespace gnomon::cli {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

/**
 * Adds channels of pixels of \a value_count floats in rows from the bottom: \a names are those of the first values.
 * OpenEXR counts rows from the top.
 */
static void add_channels(Imf::FrameBuffer &buffer, const Names &names, std::size_t value_count, char *pixels,
                         glm::ivec2 size_px)
{
  const auto pixel_bytes = std::ptrdiff_t(value_count * sizeof(float));
  const std::ptrdiff_t row_bytes = pixel_bytes * size_px.x;
  char *origin = pixels + row_bytes * (size_px.y - 1);
  for (std::size_t i = 0; i < names.size(); i++) {
    buffer.insert(names[i], Imf::Slice(Imf::FLOAT, origin + i * sizeof(float), std::size_t(pixel_bytes),
                                       std::size_t(-row_bytes)));
  }
}

namespace {

/** Where OpenEXR writes. */
class ExrStream : public Imf::OStream {
 public:
  ExrStream(output::Stream &stream, const fs::path &path) : OStream(path.c_str()), stream_(stream) {}

  void write(const char *bytes, int size) override
  {
    stream_.write(bytes, std::size_t(size));
    end_ = std::max(end_, stream_.position());
  }
  std::uint64_t tellp() override
  {
    return stream_.position();
  }
  void seekp(std::uint64_t position) override
  {
    stream_.seek(position);
  }
  /** Writes the checksum in its place, in a file that is written. */
  void write_checksum()
  {
    const ReadBytes read = [this](char *bytes, std::size_t size) { stream_.read(bytes, size); };
    stream_.seek(0);
    const StoredChecksum stored = scan_headers(read, end_);
    stream_.seek(0);
    const std::string checksum = file_checksum(read, end_, stored);
    stream_.seek(stored.position);
    stream_.write(checksum);
  }

 private:
  output::Stream &stream_;
  /** Bytes of the file. */
  std::uint64_t end_ = 0;
};

}  // namespace

void write_exr_file(const fs::path &path, Imf::Header header, const Imf::FrameBuffer &pixels, const Metadata &metadata)
{
  header.insert("Software", Imf::StringAttribute("gnomon " GNOMON_VERSION));
  for (const auto &[name, value] : metadata) {
    header.insert(name, Imf::StringAttribute(value));
  }
  const Imath::Box2i &window = header.dataWindow();
  // The checksum takes the place of these digits when all other bytes are known.
  header.insert(checksum_metadata, Imf::StringAttribute(std::string(16, '0')));
  // A quarter less time than with level 4, the default, for a file that is 1 % larger.
  header.zipCompressionLevel() = 2;
  // Blocks of rows are compressed side by side: two threads take 0.55 of the time of one.
  Imf::setGlobalThreadCount(int(std::thread::hardware_concurrency()));
  output::write_file(path, [&](output::Stream &stream) {
    try {
      ExrStream exr_stream(stream, path);
      {
        Imf::OutputFile output(exr_stream, header);
        output.setFrameBuffer(pixels);
        output.writePixels(window.max.y - window.min.y + 1);
      }
      exr_stream.write_checksum();
    }
    catch (const Iex::BaseExc &error) {
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), error.what()));
    }
  });
}

void write_exr(const fs::path &path, glm::ivec2 size_px, std::span<const float> rgba, const Metadata &metadata,
               Alpha alpha, std::span<const Layer> layers)
{
  Imf::Header header(size_px.x, size_px.y);
  Imf::FrameBuffer buffer;
  const auto add = [&](const Names &names, std::size_t value_count, std::span<const float> values) {
    for (const std::string &name : names) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    }
    // OpenEXR does not write to the pixels.
    char *pixels = const_cast<char *>(reinterpret_cast<const char *>(values.data()));
    add_channels(buffer, names, value_count, pixels, size_px);
  };
  add(alpha == Alpha::Written ? Names{"R", "G", "B", "A"} : Names{"R", "G", "B"}, 4, rgba);
  for (const Layer &layer : layers) {
    Names names;
    for (const char channel : layer.channels) {
      names.push_back(fmt::format("{}.{}", layer.name, channel));
    }
    add(names, names.size(), layer.values);
  }
  write_exr_file(path, std::move(header), buffer, metadata);
}

}  // namespace gnomon::cli
