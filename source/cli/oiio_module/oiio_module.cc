// SPDX-License-Identifier: MIT
#include "internal/cli_picture_module.hh"

#include <OpenImageIO/imageio.h>

#include <exception>
#include <memory>
#include <stdexcept>

namespace gnomon::cli {

static Picture read(const char *path)
{
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
  if (!input) {
    throw std::runtime_error(OIIO::geterror());
  }
  const OIIO::ImageSpec &spec = input->spec();
  check_edges(spec.width, spec.height);
  const int red = spec.channelindex("R");
  if (red < 0 || spec.channelindex("G") != red + 1 || spec.channelindex("B") != red + 2) {
    throw std::runtime_error("has no channels R, G and B");
  }
  Picture picture{{spec.width, spec.height}, {}};
  picture.is_cube_map = spec.get_string_attribute("textureformat") == "CubeFace Environment";
  picture.pixels.assign(std::size_t(spec.width) * std::size_t(spec.height), glm::vec4(1.0F));
  const auto row_bytes = OIIO::stride_t(sizeof(glm::vec4)) * spec.width;
  auto *top = reinterpret_cast<char *>(picture.pixels.data()) + row_bytes * (spec.height - 1);
  if (!input->read_image(0, 0, red, red + 3, OIIO::TypeDesc::FLOAT, top, sizeof(glm::vec4), -row_bytes)) {
    throw std::runtime_error(input->geterror());
  }
  if (!spec.format.is_floating_point()) {
    for (glm::vec4 &pixel : picture.pixels) {
      pixel = {linear_of_srgb(pixel.r), linear_of_srgb(pixel.g), linear_of_srgb(pixel.b), 1.0F};
    }
  }
  return picture;
}

}  // namespace gnomon::cli

extern "C" __attribute__((visibility("default"))) bool gnomon_read_module_picture(const char *path,
                                                                                  gnomon::cli::Picture &picture,
                                                                                  std::string &error)
{
  try {
    picture = gnomon::cli::read(path);
    return true;
  }
  catch (const std::exception &failure) {
    error = failure.what();
    return false;
  }
}
