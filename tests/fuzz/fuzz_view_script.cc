// SPDX-License-Identifier: MIT
// Reads scripts of gnomon view.
#include "fuzz_file.hh"
#include "view_script.hh"

#include <stdexcept>

static const gnomon::fuzz::Folder folder;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  try {
    const gnomon::view::Script script(folder.write("script", {data, size}));
  }
  catch (const std::runtime_error &) {
  }
  return 0;
}
