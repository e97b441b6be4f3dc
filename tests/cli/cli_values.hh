// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <gtest/gtest.h>

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <vector>

/** Pictures as OpenImageIO reads and writes them. */
namespace gnomon::test {

/** Red, green and blue of a file, rows from the top. */
template <typename Value>
std::vector<Value> values_in(const std::filesystem::path &path)
{
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    ADD_FAILURE() << OIIO::geterror();
    return {};
  }
  std::vector<Value> values(std::size_t(input->spec().width) * std::size_t(input->spec().height) * 3);
  EXPECT_TRUE(input->read_image(0, 0, 0, 3, OIIO::BaseTypeFromC<Value>::value, values.data())) << input->geterror();
  return values;
}

template <typename Value>
void write_values(const std::filesystem::path &path, const OIIO::ImageSpec &spec, const std::vector<Value> &values)
{
  const auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output && output->open(path.string(), spec) &&
              output->write_image(OIIO::BaseTypeFromC<Value>::value, values.data()) && output->close())
      << path;
}

/** The same, of a picture with rows from the bottom. */
inline std::vector<float> values_in(const cli::Picture &picture)
{
  std::vector<float> values;
  for (int y = picture.size_px.y; y-- > 0;) {
    for (int x = 0; x < picture.size_px.x; x++) {
      const glm::vec4 &pixel = picture.pixels[std::size_t(y * picture.size_px.x + x)];
      EXPECT_EQ(pixel.a, 1.0F);
      values.insert(values.end(), {pixel.r, pixel.g, pixel.b});
    }
  }
  return values;
}

}  // namespace gnomon::test
