// SPDX-License-Identifier: MIT
#include "internal/gltf_write_buffer.hh"

#include "internal/gltf_report.hh"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>

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
  OIIO::Filesystem::IOVecOutput bytes;
  OIIO::ImageSpec spec(int(image.width), int(image.height), 4, OIIO::TypeDesc::UINT8);
  // Texels are written as they are, not multiplied by alpha.
  spec.attribute("oiio:UnassociatedAlpha", 1);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("image.png");
  if (!output) {
    throw Fault(what, "cannot be encoded: " + printable(OIIO::geterror()));
  }
  if (!output->set_ioproxy(&bytes) || !output->open("image.png", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, image.texels.data()) || !output->close()) {
    throw Fault(what, "cannot be encoded: " + printable(output->geterror()));
  }
  return bytes.buffer();
}

}  // namespace gnomon::gltf
