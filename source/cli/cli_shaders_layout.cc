// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_programs.hh"

#include "shader_check_blocks.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::cli {

namespace {

using Comparisons = std::vector<shader_check::BlockComparison>;

bool has_block(const Comparisons &comparisons, std::string_view name)
{
  return std::ranges::find(comparisons, name, &shader_check::BlockComparison::block) != comparisons.end();
}

/** Whether the shader in the program reads a block of the engines that is not in \a comparisons. */
bool reads_another_block(const Variant &variant, const Comparisons &comparisons)
{
  return std::ranges::any_of(engine_blocks(), [&](const gpu::BlockLayout &block) {
    return !has_block(comparisons, block.name) &&
           std::ranges::find(variant.interface.bindings, block.name, &gpu::ShaderInterface::Binding::name) !=
               variant.interface.bindings.end();
  });
}

/** Compares each block in one variant that reads it; check() compares all variants. */
Comparisons compare_engine_blocks(const gpu::ShaderFiles &files)
{
  Comparisons comparisons;
  const auto compare = [&](const Variant &variant) {
    for (shader_check::BlockComparison &comparison :
         shader_check::compare_blocks(variant.desc, files, engine_blocks())) {
      if (!has_block(comparisons, comparison.block)) {
        comparisons.push_back(std::move(comparison));
      }
    }
  };
  const std::vector<Variant> variants = engine_variants();
  std::vector<const Variant *> others;
  for (const Variant &variant : variants) {
    if (reads_another_block(variant, comparisons)) {
      compare(variant);
    }
    else {
      others.push_back(&variant);
    }
  }
  // Shaders of a folder may read a block in other variants than those in the program do.
  for (const Variant *variant : others) {
    if (comparisons.size() == engine_blocks().size()) {
      break;
    }
    compare(*variant);
  }
  return comparisons;
}

Status layout(const std::string &folder)
{
  const EngineFiles files(folder);
  const auto offset = [](std::optional<std::size_t> bytes) {
    return bytes ? std::to_string(*bytes) : std::string("-");
  };
  const Comparisons comparisons = compare_engine_blocks(files.files());
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
    if (!has_block(comparisons, block.name)) {
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
