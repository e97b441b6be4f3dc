// SPDX-License-Identifier: MIT
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_process.hh"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace gnomon {
namespace {

using test::Finished;

/** `gnomon compare` on pictures whose errors are known. */
class CompareTest : public test::ProgramTest {
 protected:
  static constexpr glm::ivec2 size_px{40, 30};

  void write_picture(const std::string &name, const std::vector<glm::vec4> &pixels)
  {
    cli::write_exr(folder / name, size_px, cli::floats(pixels), {});
  }
  static std::vector<glm::vec4> constant(float value)
  {
    return std::vector<glm::vec4>(std::size_t(size_px.x) * std::size_t(size_px.y), glm::vec4(value));
  }
};

TEST_F(CompareTest, ErrorsOfAConstantDifferenceAreItsSize)
{
  write_picture("a.exr", constant(0.75F));
  write_picture("b.exr", constant(0.5F));
  const Finished finished = run("compare a.exr b.exr --json out.json --difference d.exr --difference-scale 2");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto json = nlohmann::json::parse(read("out.json"));
  EXPECT_EQ(json["non_finite_count"], 0);
  EXPECT_NEAR(json["rmse"].get<double>(), 0.25, 1e-6);
  EXPECT_NEAR(json["relative_mse"].get<double>(), 0.0625 / 0.26, 1e-6);
  EXPECT_NEAR(json["p99"].get<double>(), 0.25, 1e-6);
  EXPECT_GT(json["flip"].get<double>(), 0.0);
  const cli::Picture difference = cli::read_picture(folder / "d.exr");
  EXPECT_EQ(difference.size_px, size_px);
  EXPECT_EQ(difference.pixels.front(), glm::vec4(0.5F, 0.5F, 0.5F, 1.0F));
}

TEST_F(CompareTest, EqualPicturesHaveNoError)
{
  write_picture("a.exr", constant(0.3F));
  EXPECT_EQ(run("compare a.exr a.exr --max-rmse 0 --max-relative-mse 0 --max-p99 0 --max-flip 0").status, 0);
}

TEST_F(CompareTest, AnErrorAboveItsMaximumFailsAndIsNamed)
{
  write_picture("a.exr", constant(0.75F));
  write_picture("b.exr", constant(0.5F));
  EXPECT_EQ(run("compare a.exr b.exr --max-rmse 0.2501 --max-p99 0.2501").status, 0);
  const Finished finished = run("compare a.exr b.exr --max-rmse 0.2499 --max-p99 0.2501");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("a.exr: RMSE 0.25 is above 0.2499"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find("p99"), std::string::npos) << finished.err;
}

TEST_F(CompareTest, NonFiniteValuesAreCountedFirst)
{
  std::vector<glm::vec4> pixels = constant(0.5F);
  pixels[7].g = std::numeric_limits<float>::quiet_NaN();
  pixels[9].b = std::numeric_limits<float>::infinity();
  write_picture("a.exr", pixels);
  write_picture("b.exr", constant(0.5F));
  const Finished finished = run("compare a.exr b.exr --max-rmse 1 --difference d.png --json out.json");
  EXPECT_EQ(finished.status, 3);
  EXPECT_NE(finished.err.find("2 values"), std::string::npos) << finished.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "d.png"));
  EXPECT_EQ(nlohmann::json::parse(read("out.json"))["non_finite_count"], 2);
}

TEST_F(CompareTest, APngIsDecoded)
{
  write_picture("linear.exr", constant(std::pow((188.0F / 255.0F + 0.055F) / 1.055F, 2.4F)));
  const std::vector<std::uint8_t> bytes(std::size_t(4) * 40 * 30, 188);
  cli::write_png(folder / "coded.png", size_px, bytes, {});
  EXPECT_EQ(run("compare coded.png linear.exr --max-rmse 1e-6").status, 0);
}

TEST_F(CompareTest, BadInputIsNamed)
{
  write_picture("a.exr", constant(0.5F));
  cli::write_exr(folder / "small.exr", {1, 1}, std::vector<float>(4, 0.5F), {});
  const auto error = [&](const std::string &arguments, int status) {
    const Finished finished = run("compare " + arguments);
    EXPECT_EQ(finished.status, status) << arguments;
    return finished.err;
  };
  EXPECT_NE(error("a.exr small.exr", 1).find("a.exr: is 40x30 pixels, and small.exr is 1x1"), std::string::npos);
  EXPECT_NE(error("a.exr none.exr", 1).find("none.exr"), std::string::npos);
  (void)error("a.exr", 2);
  (void)error("a.exr a.exr --max-rmse -1", 2);
  (void)error("a.exr a.exr --difference out.txt", 2);
}

}  // namespace
}  // namespace gnomon
