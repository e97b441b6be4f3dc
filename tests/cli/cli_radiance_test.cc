// SPDX-License-Identifier: MIT
// Radiance pictures (.hdr), which the program reads itself.
#include "cli_process.hh"
#include "cli_values.hh"

#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

namespace gnomon {
namespace {

using test::values_in;

class RadiancePictureTest : public test::ProgramTest {};

TEST_F(RadiancePictureTest, AreReadAsAnotherLibraryReadsThem)
{
  std::mt19937 random(4);
  // Rows of 7 pixels are stored without runs. Even rows of values are long runs, odd ones have none.
  for (const int width : {1, 7, 8, 300}) {
    const int height = 6;
    std::vector<float> rgb(std::size_t(3) * std::size_t(width * height));
    for (std::size_t i = 0; i < rgb.size(); i++) {
      const bool is_even = i / 3 / std::size_t(width) % 2 == 0;
      rgb[i] = is_even ? 0.5F : std::ldexp(float(random() % 256), int(random() % 200) - 100);
    }
    test::write_values(folder / "a.hdr", OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT), rgb);
    const std::vector<float> ours = values_in(cli::read_picture(folder / "a.hdr"));
    const std::vector<float> others = values_in<float>(folder / "a.hdr");
    ASSERT_EQ(ours.size(), others.size());
    for (std::size_t i = 0; i < ours.size(); i++) {
      // The other library rounds the scales of large exponents, so that the last bit differs.
      ASSERT_FLOAT_EQ(ours[i], others[i]) << width << ' ' << i;
    }
  }
  // The same pixels as runs and one by one, from the top. 2^-8 m 2^(e - 128) is the value of m with the exponent e.
  const std::string header = "#?RGBE\nEXPOSURE=2\r\n\n-Y 1 +X 8\n";
  const std::string pixel = "\x80\x40\x20\x81";
  std::string pixels = header;
  for (int i = 0; i < 8; i++) {
    pixels += pixel;
  }
  write("pixels.hdr", pixels);
  write("runs.hdr",
        header + std::string("\x02\x02\x00\x08", 4) + "\x88\x80\x84\x40\x84\x40\x88\x20\x02\x81\x81\x86\x81");
  const std::vector<glm::vec4> expected(8, glm::vec4(1.0F, 0.5F, 0.25F, 1.0F));
  EXPECT_EQ(cli::read_picture(folder / "pixels.hdr").pixels, expected);
  EXPECT_EQ(cli::read_picture(folder / "runs.hdr").pixels, expected);
}

TEST_F(RadiancePictureTest, ThatCannotBeReadHaveAReason)
{
  const std::string row("\x02\x02\x00\x08", 4);
  const std::string channel = "\x88\x01";
  const std::string whole = row + channel + channel + channel + channel;
  const std::string size = "\n-Y 1 +X 8\n";
  for (const auto &[content, reason] : std::vector<std::pair<std::string, std::string>>{
           {size + whole.substr(0, 11), "is cut off"},
           {"\n-Y 2 +X 8\n" + whole + row + "\x08" + channel + channel + channel + channel, "is cut off"},
           {"\n-Y 32768 +X 32767\n" + whole, "is cut off"},
           {"\n-Y 1000000000 +X 1\n" + whole, "is cut off"},
           {"EXPOSURE=1", "is cut off"},
           {"\n-Y 100000 +X 1\n" + std::string(400000, 'a'), "has 1x100000 pixels: an edge may have 1 to 32768"},
           {size + row + "\x89\x01" + channel + channel + channel, "a run does not end with its row"},
           {size + row + std::string(8, '\0'), "a run does not end with its row"},
           {size + std::string("\x02\x02\x00\x09", 4) + std::string(8, '\1'), "a row has another width"},
           {"\n+Y 1 +X 8\n" + whole, "does not state its size"},
           {"\n-Y 1 +X 8a\n" + whole, "does not state its size"},
           {"\n-Y 1 +X 0\n" + whole, "does not state its size"},
           {"\n-Y 1 +X 99999999999\n" + whole, "does not state its size"},
           {"FORMAT=32-bit_rle_xyze\n" + size + whole, "has another format"}}) {
    write("a.hdr", "#?RADIANCE\n" + content);
    try {
      (void)cli::read_picture(folder / "a.hdr");
      ADD_FAILURE() << "was read; expected: " << reason;
    }
    catch (const std::runtime_error &error) {
      EXPECT_TRUE(std::string(error.what()).starts_with((folder / "a.hdr").string() + ": ")) << error.what();
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }
  write("a.hdr", "#?RADIANCE\n" + size + whole);
  EXPECT_EQ(cli::read_picture(folder / "a.hdr").pixels.size(), 8U);
}

}  // namespace
}  // namespace gnomon
