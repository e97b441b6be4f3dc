// SPDX-License-Identifier: MIT
// Parses scripts of gnomon view, and each of their words as a number.
#include "fuzz_file.hh"
#include "view_words.hh"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  using namespace gnomon;
  std::vector<view::ScriptLine> lines;
  try {
    lines = view::parse_script({reinterpret_cast<const char *>(data), size});
  }
  catch (const std::runtime_error &) {
    return 0;
  }
  for (const view::ScriptLine &line : lines) {
    for (const std::string &word : line.words) {
      try {
        static_cast<void>(view::pixel(word, line.words.back()));
      }
      catch (const std::runtime_error &) {
      }
    }
  }
  return 0;
}
