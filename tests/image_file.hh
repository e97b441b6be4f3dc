// SPDX-License-Identifier: MIT
#pragma once

#include <OpenImageIO/imageio.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gnomon::test {

/** The bytes of an image file. \a extension is "png" or "jpg"; rows from the top. */
template <typename Component>
std::vector<unsigned char> image_file(const std::string &extension, int width, int height, int channel_count,
                                      const std::vector<Component> &texels)
{
  std::string name = (std::filesystem::temp_directory_path() / "gnomon_image_XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  const std::string path = (folder / ("image." + extension)).string();
  OIIO::ImageSpec spec(width, height, channel_count, OIIO::BaseTypeFromC<Component>::value);
  // Texels are written as they are.
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("Compression", "jpeg:100");
  const auto output = OIIO::ImageOutput::create(path);
  EXPECT_TRUE(output && output->open(path, spec) && output->write_image(spec.format, texels.data()) && output->close());
  std::ifstream stream(path, std::ios::binary);
  std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(stream), {}};
  std::filesystem::remove_all(folder);
  return bytes;
}

}  // namespace gnomon::test
