// SPDX-License-Identifier: MIT
// Reads and writes the parts of gnomon merge.
#include "cli_exr_part.hh"
#include "fuzz_file.hh"

#include <stdexcept>

static const gnomon::fuzz::Folder folder;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  using namespace gnomon;
  try {
    const std::filesystem::path path = folder.write("part.exr", {data, size});
    static_cast<void>(cli::read_exr_part(path, cli::ExrContent::Header));
    cli::write_exr_part(folder.path() / "written.exr", cli::read_exr_part(path));
  }
  catch (const std::runtime_error &) {
  }
  return 0;
}
