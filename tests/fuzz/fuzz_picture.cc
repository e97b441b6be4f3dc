// SPDX-License-Identifier: MIT
// Reads pictures of worlds: EXR, Radiance HDR and the formats of images.
#include "cli_picture.hh"
#include "fuzz_file.hh"

#include <stdexcept>

static const gnomon::fuzz::Folder folder;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  try {
    static_cast<void>(gnomon::cli::read_picture(folder.write("world", {data, size})));
  }
  catch (const std::runtime_error &) {
  }
  return 0;
}
