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
  const std::string header = "#?RGBE\nEXPOSURE=2\r\n\n-Y 1 +X 8 \n";
  const std::string pixel = "\x80\x40\x20\x81";
  std::string pixels = header;
  for (int i = 0; i < 8; i++) {
    pixels += pixel;
  }
  write("pixels.hdr", pixels);
  write("runs.hdr",
        header + std::string("\x02\x02\x00\x08", 4) + "\x88\x80\x84\x40\x84\x40\x88\x20\x02\x81\x81\x86\x81");
  // Divided by the exposure.
  const std::vector<glm::vec4> expected(8, glm::vec4(0.5F, 0.25F, 0.125F, 1.0F));
  EXPECT_EQ(cli::read_picture(folder / "pixels.hdr").pixels, expected);
  EXPECT_EQ(cli::read_picture(folder / "runs.hdr").pixels, expected);
}

TEST_F(RadiancePictureTest, OtherPrimariesAreNamed)
{
  const auto has_warning = [&](const std::string &lines) {
    write("a.hdr", "#?RADIANCE\n" + lines + "\n-Y 1 +X 1\n\x80\x80\x80\x80");
    return !cli::read_picture(folder / "a.hdr").warnings.empty();
  };
  EXPECT_FALSE(has_warning(""));
  EXPECT_FALSE(has_warning("PRIMARIES=0.6400 0.3300 0.3000 0.6000 0.1500 0.0600 0.3127 0.3290\n"));
  EXPECT_FALSE(has_warning("PRIMARIES= .64 .33 .3\t.6 .15 .06 .313 .329\r\n"));
  // The first are Radiance's own primaries.
  EXPECT_TRUE(has_warning("PRIMARIES=0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333\n"));
  EXPECT_TRUE(has_warning("PRIMARIES=0.7347 0.2653 0 1 0.0001 -0.077 0.32168 0.33767\n"));
  EXPECT_TRUE(has_warning("PRIMARIES=0.64 0.33\n"));
  EXPECT_FALSE(has_warning("FORMAT=32-bit_rle_xyze\nPRIMARIES=0.64 0.33\n")) << "XYZ has no primaries";
}

TEST_F(RadiancePictureTest, BlanksAroundTheFormatAreNoPartOfIt)
{
  for (const std::string format : {"FORMAT= 32-bit_rle_rgbe\n", "FORMAT=\t32-bit_rle_rgbe \r\n"}) {
    write("a.hdr", "#?RADIANCE\n" + format + "\n-Y 1 +X 1\n\x80\x40\x20\x81");
    EXPECT_EQ(cli::read_picture(folder / "a.hdr").pixels.at(0), glm::vec4(1.0F, 0.5F, 0.25F, 1.0F));
  }
}

/** Bytes of a pixel with the values m 2^-8. */
std::string pixel_of(int red, int green, int blue)
{
  return {char(red), char(green), char(blue), char(0x80)};
}

TEST_F(RadiancePictureTest, OlderRunsRepeatThePixelBefore)
{
  const std::string first = pixel_of(128, 64, 32);
  const std::string second = pixel_of(32, 64, 128);
  const auto repeat = [](int count) { return std::string("\x01\x01\x01") + char(count); };
  // A run after a run counts 256 times as much: 2 + 256.
  for (const auto &[row, width] :
       std::vector<std::pair<std::string, int>>{{first + second, 2},
                                                {first + repeat(3) + second, 5},
                                                {first + repeat(2) + repeat(1) + second, 260},
                                                {first + repeat(9) + second + repeat(4), 15}}) {
    write("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X " + std::to_string(width) + '\n' + row + row);
    const cli::Picture picture = cli::read_picture(folder / "a.hdr");
    ASSERT_EQ(picture.size_px, glm::ivec2(width, 2));
    const std::size_t first_count = row == first + repeat(9) + second + repeat(4) ? 10 : std::size_t(width) - 1;
    for (std::size_t i = 0; i < picture.pixels.size(); i++) {
      const bool is_first = i % std::size_t(width) < first_count;
      const glm::vec4 expected = is_first ? glm::vec4(0.5F, 0.25F, 0.125F, 1.0F) : glm::vec4(0.125F, 0.25F, 0.5F, 1.0F);
      ASSERT_EQ(picture.pixels[i], expected) << width << ' ' << i;
    }
  }
}

TEST_F(RadiancePictureTest, RowsAndColumnsAreReadFromEachSide)
{
  // Pixel (x, y), y from the top, has the red value 64 x and the green value 64 y.
  for (const char *order :
       {"-Y 2 +X 3", "-Y 2 -X 3", "+Y 2 +X 3", "+Y 2 -X 3", "+X 3 -Y 2", "-X 3 -Y 2", "+X 3 +Y 2", "-X 3 +Y 2"}) {
    const std::string text(order);
    const bool has_columns = text[1] == 'X';
    const auto sign_of = [&](char axis) { return text[text.find(axis) - 1]; };
    std::string content = "#?RADIANCE\n\n" + text + '\n';
    for (int i = 0; i < (has_columns ? 3 : 2); i++) {
      for (int k = 0; k < (has_columns ? 2 : 3); k++) {
        const int along_x = has_columns ? i : k;
        const int along_y = has_columns ? k : i;
        const int x = sign_of('X') == '+' ? along_x : 2 - along_x;
        const int y = sign_of('Y') == '-' ? along_y : 1 - along_y;
        content += pixel_of(64 * x, 64 * y, 255);
      }
    }
    write("a.hdr", content);
    const cli::Picture picture = cli::read_picture(folder / "a.hdr");
    ASSERT_EQ(picture.size_px, glm::ivec2(3, 2)) << order;
    for (int y = 0; y < 2; y++) {
      for (int x = 0; x < 3; x++) {
        const glm::vec4 &pixel = picture.pixels[std::size_t((1 - y) * 3 + x)];
        EXPECT_EQ(glm::vec2(pixel), glm::vec2(0.25F * float(x), 0.25F * float(y))) << order;
      }
    }
  }
}

TEST_F(RadiancePictureTest, AreRadiancesOfTheProgramsPrimaries)
{
  const auto read = [&](const std::string &header, const std::string &pixel) {
    write("a.hdr", "#?RADIANCE\n" + header + "\n-Y 1 +X 1\n" + pixel);
    return glm::vec3(cli::read_picture(folder / "a.hdr").pixels.front());
  };
  const std::string grey = pixel_of(128, 128, 128);
  EXPECT_EQ(read("", grey), glm::vec3(0.5F));
  EXPECT_EQ(read("EXPOSURE=2\nEXPOSURE= 0.5\nEXPOSURE=4\n", grey), glm::vec3(0.125F));
  EXPECT_EQ(read("COLORCORR= 1 2 4\nEXPOSURE=0.5\n", grey), glm::vec3(1.0F, 0.5F, 0.25F));
  // White of Rec. 709 is (0.9505, 1, 1.089) in CIE XYZ, here within 0.1 of whole bytes, which red counts 4 times.
  const glm::vec3 white = read("FORMAT=32-bit_rle_xyze\n", pixel_of(192, 202, 220));
  for (int c = 0; c < 3; c++) {
    EXPECT_NEAR(white[c], 202.0F / 256.0F, 0.4F / 256.0F);
  }
  // Outside of the primaries: no value is negative.
  EXPECT_EQ(read("FORMAT=32-bit_rle_xyze\n", pixel_of(0, 128, 0)).r, 0.0F);
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
           {"EXPOSURE=0\n" + size + whole, "has an EXPOSURE or a COLORCORR that is no number above 0"},
           {"COLORCORR=1 2\n" + size + whole, "has an EXPOSURE or a COLORCORR that is no number above 0"},
           {"\n-Y 1 +X 3\n\x80\x40\x20\x81\x01\x01\x01\x03", "a run does not end with its row"},
           {"\n-Y 1 -Y 8\n" + whole, "does not state its size"},
           {"\n-Y 1000000000 +X 1\n" + whole, "is cut off"},
           {"EXPOSURE=1", "is cut off"},
           {"\n-Y 100000 +X 1\n" + std::string(400000, 'a'), "has 1x100000 pixels: an edge may have 1 to 32768"},
           {size + row + "\x89\x01" + channel + channel + channel, "a run does not end with its row"},
           {size + row + std::string(8, '\0'), "a run does not end with its row"},
           {size + std::string("\x02\x02\x00\x09", 4) + std::string(8, '\1'), "a row has another width"},
           {"\n-Y 1 +X 8a\n" + whole, "does not state its size"},
           {"\n-Y 1 +X 0\n" + whole, "does not state its size"},
           {"\n-Y 1 +X 99999999999\n" + whole, "does not state its size"},
           {"FORMAT=32-bit_rle_cmyk\n" + size + whole, "has another format"}}) {
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
