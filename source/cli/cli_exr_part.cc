// SPDX-License-Identifier: MIT
#include "cli_exr_part.hh"

#include "internal/cli_exr_file.hh"

#include "output_file.hh"

#include <fmt/format.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfStringAttribute.h>

#include <new>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

/** The channels of \a part, whose upper left pixel has the coordinates \a first in the file. */
static Imf::FrameBuffer frame_buffer(const ExrPart &part, glm::ivec2 first)
{
  const std::ptrdiff_t row_bytes = std::ptrdiff_t(sizeof(float)) * part.size_px.x;
  Imf::FrameBuffer buffer;
  for (const auto &[name, values] : part.channels) {
    // The address of pixel (0, 0), which may be outside of the part. OpenEXR does not write through it when it writes a
    // file.
    const auto origin = reinterpret_cast<std::uintptr_t>(values.data()) - std::uintptr_t(row_bytes * first.y) -
                        std::uintptr_t(std::ptrdiff_t(sizeof(float)) * first.x);
    buffer.insert(name.c_str(),
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(origin), sizeof(float), std::size_t(row_bytes)));
  }
  return buffer;
}

ExrPart read_exr_part(const fs::path &path, ExrContent content)
{
  try {
    ExrInput file(path);
    file.check_memory(0);
    file.check_content();
    const Imf::Header &header = file.file().header(0);
    const Imath::Box2i &whole = header.displayWindow();
    const Imath::Box2i &window = header.dataWindow();
    ExrPart part{size_of_window(whole),
                 size_of_window(window),
                 {window.min.x - whole.min.x, window.min.y - whole.min.y},
                 {},
                 {}};
    const glm::ivec2 end_px = part.first_px + part.size_px;
    if (part.first_px.x < 0 || part.first_px.y < 0 || end_px.x > part.whole_size_px.x ||
        end_px.y > part.whole_size_px.y) {
      throw std::runtime_error("has pixels outside of the picture");
    }
    if (!file.file().partComplete(0)) {
      throw std::runtime_error("is cut off");
    }
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      if (channel.channel().type != Imf::FLOAT || channel.channel().xSampling != 1 ||
          channel.channel().ySampling != 1) {
        throw std::runtime_error(fmt::format("channel {} does not have a 32-bit float for each pixel", channel.name()));
      }
      std::vector<float> &values = part.channels[channel.name()];
      if (content == ExrContent::All) {
        values.resize(std::size_t(part.size_px.x) * std::size_t(part.size_px.y));
      }
    }
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
      if (const auto *text = dynamic_cast<const Imf::StringAttribute *>(&attribute.attribute())) {
        part.metadata.emplace_back(attribute.name(), text->value());
      }
    }
    if (content == ExrContent::All) {
      Imf::InputPart input(file.file(), 0);
      input.setFrameBuffer(frame_buffer(part, {window.min.x, window.min.y}));
      input.readPixels(window.min.y, window.max.y);
    }
    return part;
  }
  catch (const std::bad_alloc &) {
    throw output::TransientError(fmt::format("{}: there is not enough memory to read it", path.string()));
  }
  catch (const std::exception &error) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

void write_exr_part(const fs::path &path, const ExrPart &part)
{
  const glm::ivec2 last_px = part.first_px + part.size_px - 1;
  Imf::Header header({{0, 0}, {part.whole_size_px.x - 1, part.whole_size_px.y - 1}},
                     {{part.first_px.x, part.first_px.y}, {last_px.x, last_px.y}});
  for (const auto &[name, values] : part.channels) {
    header.channels().insert(name.c_str(), Imf::Channel(Imf::FLOAT));
  }
  write_exr_file(path, header, frame_buffer(part, part.first_px), part.metadata);
}

std::string metadata_value(const Metadata &metadata, const std::string &name)
{
  for (const auto &[key, value] : metadata) {
    if (key == name) {
      return value;
    }
  }
  return {};
}

}  // namespace gnomon::cli
