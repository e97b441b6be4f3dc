// SPDX-License-Identifier: MIT
// EXR pictures of other windows, layers and numbers than those that the program writes.
#include "cli_process.hh"
#include "cli_values.hh"

#include "scene_world.hh"

#include <limits>
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

TEST_F(ExrPictureTest, TheOnlyLayerIsReadAndOneOfSeveralIsNamed)
{
  write_channels("one.exr", spec, {"Sky.R", "Sky.G", "Sky.B", "Sky.Z"});
  EXPECT_EQ(first_pixel("one.exr"), glm::vec3(1, 2, 3));
  write_channels("root.exr", spec, {"R", "G", "B", "Sky.R", "Sky.G", "Sky.B"});
  EXPECT_EQ(first_pixel("root.exr"), glm::vec3(1, 2, 3));
  EXPECT_EQ(first_pixel("root.exr", "Sky"), glm::vec3(4, 5, 6));
  write_channels("two.exr", spec, {"Fog.R", "Fog.G", "Fog.B", "Sky.a.R", "Sky.a.G", "Sky.a.B"});
  EXPECT_EQ(first_pixel("two.exr", "Sky.a"), glm::vec3(4, 5, 6));
  EXPECT_NE(
      error_of("two.exr").find("has several layers, of which --world-layer names that of a world: 'Fog', 'Sky.a'"),
      std::string::npos)
      << error_of("two.exr");
  EXPECT_NE(error_of("two.exr", "Sea").find("has no layer 'Sea'; it has: 'Fog', 'Sky.a'"), std::string::npos);
  write_channels("none.exr", spec, {"U", "V"});
  EXPECT_NE(error_of("none.exr").find("has no channels R, G and B, and no channel Y; it has: U, V"), std::string::npos)
      << error_of("none.exr");
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
