// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_programs.hh"

#include "shader_check_blocks.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::cli {

namespace {

/** Compares each block in the first variant that reads it; check() compares all variants. */
std::vector<shader_check::BlockComparison> compare_engine_blocks(const gpu::ShaderFiles &files)
{
  std::vector<shader_check::BlockComparison> comparisons;
  for (const Variant &variant : engine_variants()) {
    for (shader_check::BlockComparison &comparison :
         shader_check::compare_blocks(variant.desc, files, engine_blocks())) {
      if (std::ranges::find(comparisons, comparison.block, &shader_check::BlockComparison::block) ==
          comparisons.end()) {
        comparisons.push_back(std::move(comparison));
      }
    }
    if (comparisons.size() == engine_blocks().size()) {
      break;
    }
  }
  return comparisons;
}

Status layout(const std::string &folder)
{
  const EngineFiles files(folder);
  const auto offset = [](std::optional<std::size_t> bytes) {
    return bytes ? std::to_string(*bytes) : std::string("-");
  };
  const std::vector<shader_check::BlockComparison> comparisons = compare_engine_blocks(files.files());
  Status status = Status::Done;
  for (const shader_check::BlockComparison &comparison : comparisons) {
    fmt::print("{}: {} bytes in C++, {} in GLSL\n     C++   GLSL\n", comparison.block, comparison.cpp_size_bytes,
               comparison.glsl_size_bytes);
    for (const auto &field : comparison.fields) {
      fmt::print("  {:>6} {:>6}  {}{}\n", offset(field.cpp_offset_bytes), offset(field.glsl_offset_bytes), field.name,
                 field.cpp_offset_bytes == field.glsl_offset_bytes ? "" : "  <-- differs");
    }
  }
  for (const shader_check::BlockComparison &comparison : comparisons) {
    for (const shader_check::BlockDifference &difference : shader_check::differences(comparison)) {
      fmt::print("{}:{}: error: {} [layout]\n", files.shown(difference.file), difference.line, difference.text);
      status = Status::Failed;
    }
  }
  for (const gpu::BlockLayout &block : engine_blocks()) {
    if (std::ranges::find(comparisons, block.name, &shader_check::BlockComparison::block) == comparisons.end()) {
      fmt::print("error: block '{}' is read by no shader [layout]\n", block.name);
      status = Status::Failed;
    }
  }
  return status;
}

}  // namespace

void add_shaders_layout(CLI::App &shaders, Status &status)
{
  auto folder = std::make_shared<std::string>();
  CLI::App *command = shaders.add_subcommand("layout", "Layout of each block in C++ and in GLSL");
  command->add_option("--shaders", *folder, "Folder of the engine's shaders (default: those in the program)");
  command->callback([folder, &status] { status = layout(*folder); });
}

}  // namespace gnomon::cli
