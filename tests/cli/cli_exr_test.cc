// SPDX-License-Identifier: MIT
// EXR pictures of other windows, layers and numbers than those that the program writes.
#include "cli_exr_part.hh"
#include "cli_process.hh"
#include "cli_values.hh"

#include "scene_world.hh"

#include <fmt/format.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>

#include <array>
#include <bit>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>

namespace gnomon {
namespace {

class ExrPictureTest : public test::ProgramTest {
 protected:
  /** Writes a picture whose channels have the values 1, 2, 3 … */
  void write_channels(const std::string &name, OIIO::ImageSpec of_file, const std::vector<std::string> &channels)
  {
    of_file.nchannels = int(channels.size());
    of_file.channelnames = channels;
    std::vector<float> values;
    for (int i = 0; i < of_file.width * of_file.height; i++) {
      for (std::size_t c = 0; c < channels.size(); c++) {
        values.push_back(float(c + 1));
      }
    }
    test::write_values(folder / name, of_file, values);
  }
  [[nodiscard]] glm::vec3 first_pixel(const std::string &name, const std::string &layer = {}) const
  {
    return glm::vec3(cli::read_picture(folder / name, layer).pixels.front());
  }
  [[nodiscard]] std::string error_of(const std::string &name, const std::string &layer = {}) const
  {
    try {
      static_cast<void>(cli::read_picture(folder / name, layer));
    }
    catch (const std::runtime_error &error) {
      return error.what();
    }
    return {};
  }

  const OIIO::ImageSpec spec{4, 2, 3, OIIO::TypeDesc::FLOAT};
};

TEST_F(ExrPictureTest, PixelsOutsideOfTheDataWindowAreBlack)
{
  // Columns of the display window from `first` to `end`.
  struct Window {
    int x;
    int width;
    int first;
    int end;
  };
  for (const Window &window : {Window{0, 2, 0, 2}, Window{2, 2, 2, 4}, Window{1, 2, 1, 3}, Window{-3, 9, 0, 4},
                               Window{-2, 3, 0, 1}, Window{7, 2, 4, 4}}) {
    OIIO::ImageSpec part(window.width, 2, 3, OIIO::TypeDesc::HALF);
    part.x = window.x;
    part.full_width = 4;
    part.full_height = 2;
    write_channels("a.exr", part, {"R", "G", "B"});
    const cli::Picture picture = cli::read_picture(folder / "a.exr");
    ASSERT_EQ(picture.size_px, glm::ivec2(4, 2));
    for (int x = 0; x < 4; x++) {
      const bool is_inside = x >= window.first && x < window.end;
      EXPECT_EQ(glm::vec3(picture.pixels[std::size_t(x)]), is_inside ? glm::vec3(1, 2, 3) : glm::vec3(0)) << x;
    }
  }
}

TEST_F(ExrPictureTest, LuminanceIsGrey)
{
  write_channels("y.exr", spec, {"Y"});
  EXPECT_EQ(first_pixel("y.exr"), glm::vec3(1));
  write_channels("ya.exr", spec, {"Y", "A"});
  EXPECT_EQ(first_pixel("ya.exr"), glm::vec3(1));
}

TEST_F(ExrPictureTest, VectorsAreNoPictures)
{
  write_channels("n.exr", spec, {"Normal.X", "Normal.Y", "Normal.Z", "Combined.R", "Combined.G", "Combined.B"});
  EXPECT_EQ(first_pixel("n.exr"), glm::vec3(4, 5, 6));
  write_channels("p.exr", spec, {"X", "Y", "Z"});
  EXPECT_NE(error_of("p.exr").find("has no channels R, G and B, and no channel Y"), std::string::npos);
}

/** Parts of luminance and chroma, which has half of the pixels along both edges. */
void write_chroma_parts(const std::filesystem::path &path, const std::vector<std::string> &parts)
{
  constexpr int size = 4;
  std::vector<Imf::Header> headers;
  for (const std::string &part : parts) {
    Imf::Header header(size, size);
    header.setName(part);
    header.setType(Imf::SCANLINEIMAGE);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
    header.channels().insert("BY", Imf::Channel(Imf::HALF, 2, 2));
    headers.push_back(header);
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  std::vector<half> values(std::size_t(size) * size, half(0.5F));
  for (int i = 0; i < int(headers.size()); i++) {
    Imf::OutputPart part(file, i);
    Imf::FrameBuffer buffer;
    for (const auto &[name, step] : {std::pair("Y", 1), std::pair("RY", 2), std::pair("BY", 2)}) {
      buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char *>(values.data()), sizeof(half),
                                     std::size_t(size) * sizeof(half), step, step));
    }
    part.setFrameBuffer(buffer);
    part.writePixels(size);
  }
}

TEST_F(ExrPictureTest, ChromaIsColourAndNotGrey)
{
  write_chroma_parts(folder / "one.exr", {"a"});
  // (R - Y) / Y and (B - Y) / Y are 0.5.
  const glm::vec3 color = first_pixel("one.exr");
  EXPECT_NEAR(color.r, 0.75F, 1e-3F);
  EXPECT_NEAR(color.b, 0.75F, 1e-3F);
  EXPECT_LT(color.g, 0.5F);
  write_chroma_parts(folder / "two.exr", {"a", "b"});
  EXPECT_NE(error_of("two.exr", "b").find((folder / "two.exr").string() + ": has luminance and chroma (Y, RY and BY)"),
            std::string::npos)
      << error_of("two.exr", "b");
}

TEST_F(ExrPictureTest, ChromaOfAnotherSizeIsRefusedInWords)
{
  // Pixels of the picture for each of RY and BY.
  for (const glm::ivec2 step : {glm::ivec2(1, 1), glm::ivec2(2, 1), glm::ivec2(1, 2), glm::ivec2(4, 4)}) {
    Imf::Header header(4, 4);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
    header.channels().insert("BY", Imf::Channel(Imf::HALF, step.x, step.y));
    {
      Imf::OutputFile file((folder / "a.exr").c_str(), header);
      std::array<half, 16> values{};
      Imf::FrameBuffer buffer;
      for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
        buffer.insert(channel.name(),
                      Imf::Slice(Imf::HALF, reinterpret_cast<char *>(values.data()), sizeof(half), 4 * sizeof(half),
                                 channel.channel().xSampling, channel.channel().ySampling));
      }
      file.setFrameBuffer(buffer);
      file.writePixels(4);
    }
    const std::string text = fmt::format("whose channel BY has one pixel for {}x{} of the picture", step.x, step.y);
    EXPECT_NE(error_of("a.exr").find(text), std::string::npos) << error_of("a.exr");
  }
}

TEST_F(ExrPictureTest, OtherPrimariesAreNamed)
{
  const std::string warning = "states other primaries than Rec. 709, and its colours are taken as Rec. 709";
  using Warnings = std::vector<std::string>;
  const std::array<float, 8> aces = {0.7347F, 0.2653F, 0, 1, 0.0001F, -0.077F, 0.32168F, 0.33767F};
  const std::array<float, 8> rec709 = {0.64F, 0.33F, 0.3F, 0.6F, 0.15F, 0.06F, 0.313F, 0.329F};
  const auto warnings_of = [&](const std::array<float, 8> &primaries, const std::vector<std::string> &channels) {
    OIIO::ImageSpec of_file = spec;
    of_file.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries.data());
    write_channels("a.exr", of_file, channels);
    return cli::read_picture(folder / "a.exr").warnings;
  };
  EXPECT_EQ(warnings_of(aces, {"R", "G", "B"}), Warnings{warning});
  EXPECT_EQ(warnings_of(rec709, {"R", "G", "B"}), Warnings{});
  EXPECT_EQ(warnings_of(aces, {"Y"}), Warnings{}) << "grey";
  for (std::size_t i = 0; i < rec709.size(); i++) {
    std::array<float, 8> moved = rec709;
    moved[i] += 1e-3F;
    EXPECT_EQ(warnings_of(moved, {"R", "G", "B"}), Warnings{warning}) << i;
  }
  warnings_of(aces, {"R", "G", "B"});
  write("scene.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"extras": {"gnomon_world": "a.exr"}}]})");
  for (const char *arguments : {"info scene.gltf", "info scene.gltf --world a.exr"}) {
    const test::Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_NE((finished.out + finished.err).find("world 'a.exr': " + warning), std::string::npos)
        << finished.out << finished.err;
  }
  const test::Finished compared = run("compare a.exr a.exr");
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_NE(compared.err.find("warning: a.exr: " + warning), std::string::npos) << compared.err;
}

TEST_F(ExrPictureTest, ACubeMapIsNoWorld)
{
  for (const std::string name : {"a.exr", "a.tif"}) {
    for (const std::string format : {"CubeFace Environment", "LatLong Environment"}) {
      OIIO::ImageSpec of_file = spec;
      // The width of a square, and six of them in a column.
      of_file.height = format[0] == 'C' ? 24 : 2;
      of_file.full_height = of_file.height;
      of_file.attribute("textureformat", format);
      write_channels(name, of_file, {"R", "G", "B"});
      const std::string error = name + ": is a cube map, and a world must be an equirectangular picture";
      write("scene.gltf",
            R"({"asset": {"version": "2.0"}, "scenes": [{"extras": {"gnomon_world": ")" + name + "\"}}]}");
      const test::Finished given = run("info scene.gltf --world " + name);
      EXPECT_EQ(given.status, format[0] == 'C' ? 1 : 0) << name << given.err;
      EXPECT_EQ(given.err.find(error) != std::string::npos, format[0] == 'C') << given.err;
      const test::Finished own = run("info scene.gltf");
      EXPECT_EQ(own.status, 0) << own.err;
      EXPECT_EQ((own.out + own.err).find("its world is left out: " + error) != std::string::npos, format[0] == 'C')
          << own.out << own.err;
    }
  }
}

TEST_F(ExrPictureTest, TheOnlyLayerIsReadAndOneOfSeveralIsNamed)
{
  write_channels("one.exr", spec, {"Sky.R", "Sky.G", "Sky.B", "Sky.Z"});
  EXPECT_EQ(first_pixel("one.exr"), glm::vec3(1, 2, 3));
  write_channels("root.exr", spec, {"R", "G", "B", "Sky.R", "Sky.G", "Sky.B"});
  EXPECT_EQ(first_pixel("root.exr"), glm::vec3(1, 2, 3));
  EXPECT_EQ(first_pixel("root.exr", "Sky"), glm::vec3(4, 5, 6));
  // Nuke writes such names.
  write_channels("words.exr", spec, {"Sky.red", "Sky.green", "Sky.blue"});
  EXPECT_EQ(first_pixel("words.exr"), glm::vec3(1, 2, 3));
  write_channels("two.exr", spec, {"Fog.R", "Fog.G", "Fog.B", "Sky.a.R", "Sky.a.G", "Sky.a.B"});
  EXPECT_EQ(first_pixel("two.exr", "Sky.a"), glm::vec3(4, 5, 6));
  EXPECT_NE(error_of("two.exr").find(
                "has several layers, and none without a name (a world's is chosen by --world-layer): 'Fog', 'Sky.a'"),
            std::string::npos)
      << error_of("two.exr");
  EXPECT_NE(error_of("two.exr", "Sea").find("has no layer 'Sea'; it has: 'Fog', 'Sky.a'"), std::string::npos);
  // A folder is not a failure that another attempt may not have.
  EXPECT_EQ(error_of("."), (folder / ".").string() + ": is a folder");
  write_channels("none.exr", spec, {"U", "V"});
  EXPECT_NE(error_of("none.exr").find("has no channels R, G and B, and no channel Y; it has: U, V"), std::string::npos)
      << error_of("none.exr");
}

std::string little_endian(std::uint32_t value)
{
  std::string bytes;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes += char(value >> shift & 0xffU);
  }
  return bytes;
}

/** An attribute of an EXR header that states \a size bytes, of which \a value is there. */
std::string exr_attribute(const std::string &name, const std::string &type, const std::string &value,
                          std::size_t size = 0)
{
  const auto stated = std::uint32_t(size > 0 ? size : value.size());
  return name + '\0' + type + '\0' + little_endian(stated) + value;
}

/** The start of an EXR file of zeros: the headers, and a table whose chunks are all at the same place. */
struct ExrStart {
  glm::ivec2 size_px{8};
  /** Coordinates of the last pixel of the display window. */
  glm::ivec2 display_px{7};
  char compression = 0;
  int channel_count = 3;
  std::string first_attribute;
  int chunk_count = 8;

  [[nodiscard]] std::string bytes() const
  {
    const auto window = [](glm::ivec2 last) {
      return little_endian(0U) + little_endian(0U) + little_endian(std::uint32_t(last.x)) +
             little_endian(std::uint32_t(last.y));
    };
    std::string channels;
    const std::string names[] = {"B", "G", "R"};
    for (int i = 0; i < channel_count; i++) {
      const std::string name = i < 3 ? names[i] : fmt::format("a{:03}", i);
      channels += name + '\0' + little_endian(2U) + little_endian(0U) + little_endian(1U) + little_endian(1U);
    }
    const std::string one = little_endian(std::bit_cast<std::uint32_t>(1.0F));
    const std::string zero = little_endian(0U);
    std::string text = "\x76\x2f\x31\x01" + little_endian(2U) + first_attribute +
                       exr_attribute("channels", "chlist", channels + '\0') +
                       exr_attribute("compression", "compression", std::string(1, compression)) +
                       exr_attribute("dataWindow", "box2i", window(size_px - 1)) +
                       exr_attribute("displayWindow", "box2i", window(display_px)) +
                       exr_attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
                       exr_attribute("pixelAspectRatio", "float", one) +
                       exr_attribute("screenWindowCenter", "v2f", zero + zero) +
                       exr_attribute("screenWindowWidth", "float", one) + '\0';
    const auto at = std::uint32_t(text.size() + std::size_t(chunk_count) * 8);
    for (int i = 0; i < chunk_count; i++) {
      text += little_endian(at) + zero;
    }
    return text;
  }
};

// Each asked for 1 to 14 GiB: OpenEXR allocates what a header states.
TEST_F(ExrPictureTest, AskForNoMoreMemoryThanTheirBytesCanFill)
{
  const auto expect_refused = [&](const ExrStart &start, const std::string &reason) {
    const std::string bytes = start.bytes();
    std::ofstream(folder / "a.exr", std::ios::binary) << bytes;
    EXPECT_NE(error_of("a.exr").find(reason), std::string::npos) << error_of("a.exr");
    EXPECT_EQ(error_of("a.exr").find((folder / "a.exr").string()), 0U) << error_of("a.exr");
    const test::Finished merged = run("merge a.exr -o merged.exr");
    EXPECT_EQ(merged.status, 1);
    EXPECT_NE(merged.err.find("a.exr: "), std::string::npos) << merged.err;
  };
  const std::size_t long_value = 0x7ffffff0;
  for (const char *type : {"string", "floatvector", "stringvector", "unknown"}) {
    ExrStart start;
    start.first_attribute = exr_attribute("a", type, "abcd", long_value);
    expect_refused(start, "its attribute 'a' has 2147483632 bytes");
  }
  ExrStart preview;
  preview.first_attribute =
      exr_attribute("preview", "preview", little_endian(20000U) + little_endian(20000U), 8 + 4 * 20000 * 20000);
  expect_refused(preview, "its attribute 'preview' has 1600000008 bytes");

  // Compressions by their number in the file, and lines of a chunk.
  struct Compression {
    int number;
    int lines;
  };
  for (const Compression &compression :
       {Compression{1, 1}, Compression{2, 1}, Compression{3, 16}, Compression{4, 32}, Compression{5, 16},
        Compression{6, 32}, Compression{7, 32}, Compression{8, 32}, Compression{9, 256}}) {
    ExrStart start;
    start.size_px = {32768, 8192};
    start.display_px = start.size_px - 1;
    start.compression = char(compression.number);
    start.chunk_count = start.size_px.y / compression.lines;
    expect_refused(start, "bytes cannot be 32768x8192 pixels with 3 channels");
  }
  ExrStart many;
  many.size_px = many.display_px = {32767, 8191};
  many.channel_count = 5;
  many.compression = 9;
  many.chunk_count = 32;
  expect_refused(many, "has 32767x8191 pixels with 5 channels, which are more than 1073741824 values");
}

TEST_F(ExrPictureTest, HaveALimitOfPixelsThatAreNotStored)
{
  OIIO::ImageSpec part = spec;
  part.full_width = 4096;
  part.full_height = 4096;
  write_channels("a.exr", part, {"R", "G", "B"});
  EXPECT_EQ(cli::read_picture(folder / "a.exr").size_px, glm::ivec2(4096));
  part.full_height = 4097;
  write_channels("a.exr", part, {"R", "G", "B"});
  EXPECT_NE(error_of("a.exr").find("has 4096x4097 pixels in its display window, and 4x2 in its data window"),
            std::string::npos)
      << error_of("a.exr");
}

/** Noise, which deflate cannot shorten, so that its chunks have no checksum of their own, and equal values. */
cli::ExrPart part_of_noise()
{
  cli::ExrPart part{{7, 22}, {5, 19}, {2, 1}, {}, {{"gnomon:scene", "s.gltf"}, {"gnomon:samples", "2"}}};
  std::mt19937 random(1);
  for (const char *name : {"R", "G", "B"}) {
    for (int i = 0; i < part.size_px.x * part.size_px.y; i++) {
      part.channels[name].push_back(std::bit_cast<float>(std::uint32_t(random() % 0x7f000000U)));
    }
  }
  part.channels["A"].assign(part.channels["R"].size(), 1.0F);
  return part;
}

TEST_F(ExrPictureTest, AFlippedBitOfEachByteOfAPartIsNamed)
{
  cli::write_exr_part(folder / "a.exr", part_of_noise());
  const cli::ExrPart whole = cli::read_exr_part(folder / "a.exr");
  EXPECT_EQ(whole.channels, part_of_noise().channels);
  const std::string bytes = read("a.exr");
  std::vector<std::string> unnoticed;
  for (std::size_t i = 0; i < bytes.size(); i++) {
    std::string flipped = bytes;
    flipped[i] = char(flipped[i] ^ (1 << (i * 3 % 8)));
    write("a.exr", flipped);
    try {
      const cli::ExrPart part = cli::read_exr_part(folder / "a.exr");
      // Where the name of the checksum differs, the file is one without a checksum.
      if (part.channels != whole.channels || !cli::metadata_value(part.metadata, cli::checksum_metadata).empty()) {
        unnoticed.push_back(std::to_string(i));
      }
    }
    catch (const std::runtime_error &error) {
      EXPECT_EQ(std::string(error.what()).rfind((folder / "a.exr").string() + ": ", 0), 0U) << error.what();
    }
  }
  EXPECT_EQ(unnoticed, std::vector<std::string>()) << "of " << bytes.size() << " bytes";
}

TEST_F(ExrPictureTest, APartWithoutAChecksumIsRead)
{
  write_channels("a.exr", spec, {"R", "G", "B"});
  const cli::ExrPart part = cli::read_exr_part(folder / "a.exr");
  EXPECT_EQ(cli::metadata_value(part.metadata, cli::checksum_metadata), "");
  EXPECT_EQ(part.channels.at("G"), std::vector<float>(8, 2.0F));
}

TEST_F(ExrPictureTest, AWholePictureIsNoPart)
{
  cli::ExrPart part{{3, 4}, {3, 2}, {0, 0}, {{"R", std::vector<float>(6)}}, {}};
  cli::write_exr_part(folder / "a.exr", part);
  part.size_px.y = 4;
  part.channels["R"].resize(12);
  cli::write_exr_part(folder / "b.exr", part);
  const test::Finished merged = run("merge a.exr b.exr -o merged.exr");
  EXPECT_EQ(merged.status, 1);
  EXPECT_NE(merged.err.find("b.exr: is a whole picture, not a part"), std::string::npos) << merged.err;
}

TEST_F(ExrPictureTest, PartsOfSeveralDevicesAreJoinedAndNamed)
{
  const auto write_half = [&](const std::string &name, int first_row, const std::string &device) {
    cli::ExrPart part{{3, 4}, {3, 2}, {0, first_row}, {}, {{"gnomon:samples", "2"}, {"gnomon:device", device}}};
    for (const char *channel : {"R", "G", "B", "A"}) {
      part.channels[channel].assign(6, 0.5F);
    }
    cli::write_exr_part(folder / name, part);
  };
  write_half("a.exr", 0, "OpenGL");
  for (const std::string device : {"OpenGL", "Vulkan"}) {
    write_half("b.exr", 2, device);
    const test::Finished merged = run("merge a.exr b.exr -o whole.exr");
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(merged.err.find("a.exr by 'OpenGL', b.exr by 'Vulkan'") != std::string::npos, device == "Vulkan")
        << merged.err;
  }
}

TEST(WorldRadiances, AreClampedWithNumberAndPlace)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scene::WorldPicture picture{3, 2, std::vector<glm::vec3>(6, glm::vec3(0.25F, 0.5F, 1.0F))};
  EXPECT_EQ(scene::clamp_radiances(picture), "");
  picture.texels[1].r = -1e-5F;
  picture.texels[4] = {-infinity, nan, 1.0F};
  picture.texels[5] = glm::vec3(infinity);
  const std::string text = scene::clamp_radiances(picture);
  EXPECT_NE(text.find("2 of 6 texels negative (the first at 1, 0 from the top left)"), std::string::npos) << text;
  EXPECT_NE(text.find("1 of 6 texels not a number (the first at 1, 1 from the top left)"), std::string::npos) << text;
  EXPECT_NE(text.find("1 of 6 texels infinite (the first at 2, 1 from the top left)"), std::string::npos) << text;
  EXPECT_EQ(picture.texels[1], glm::vec3(0.0F, 0.5F, 1.0F));
  EXPECT_EQ(picture.texels[4], glm::vec3(0.0F, 0.0F, 1.0F));
  EXPECT_EQ(picture.texels[5], glm::vec3(0.25F, 0.5F, 1.0F)) << "the largest finite values";
}

}  // namespace
}  // namespace gnomon
