// SPDX-License-Identifier: MIT
#include "internal/gltf_write_buffer.hh"

#include "image_png.hh"
#include "internal/gltf_report.hh"

namespace gnomon::gltf {

int WrittenBuffer::add_view(std::span<const unsigned char> content)
{
  // Accessors begin at multiples of their components' size.
  bytes.resize((bytes.size() + 3) / 4 * 4);
  const std::size_t offset = bytes.size();
  bytes.insert(bytes.end(), content.begin(), content.end());
  return views.add("{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) +
                   ",\"byteLength\":" + std::to_string(content.size()) + '}');
}

std::vector<unsigned char> png_of(const scene::Image &image, const std::string &what)
{
  try {
    return image::png_file(image.width, image.height, 4, image.texels);
  }
  catch (const image::Error &error) {
    throw Fault(what, printable(error.what()));
  }
}

}  // namespace gnomon::gltf
