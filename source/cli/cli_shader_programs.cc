// SPDX-License-Identifier: MIT
#include "cli_shader_programs.hh"

#include "eevee_blocks.hh"
#include "eevee_interfaces.hh"
#include "eevee_programs.hh"
#include "overlay_blocks.hh"
#include "overlay_interfaces.hh"
#include "overlay_programs.hh"
#include "shader_files.hh"
#include "unlit_interfaces.hh"
#include "unlit_programs.hh"

#include <fmt/ranges.h>

#include <set>
#include <stdexcept>
#include <type_traits>

namespace gnomon::cli {

namespace fs = std::filesystem;

EngineFiles::EngineFiles(const std::string &folder) : prefix_(folder.empty() ? "shaders" : folder), folder_(folder)
{
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw std::runtime_error(fmt::format("--shaders {}: no such folder", folder));
  }
  files_ = folder.empty() ? gpu::ShaderFiles(shaders::file) : folder_.files();
}

/** The functions of the engine are found by the type of \a declarations. */
template <typename Declaration>
static void add_variants(std::span<const Declaration> declarations, std::span<const gpu::InterfaceTable> interfaces,
                         std::vector<Variant> &variants)
{
  for (const Declaration &declaration : declarations) {
    const auto add = [&](auto features, auto constants) {
      variants.push_back({declaration.purpose, shader_desc(declaration, features | constants),
                          interfaces[std::size_t(declaration.id)].interface_of(std::uint32_t(features))});
    };
    const auto masks = shader_variants(declaration);
    for (const auto features : masks) {
      add(features, decltype(features)());
    }
    // The code of constants is in none of these variants. It reads nothing that they do not read.
    if constexpr (std::is_same_v<Declaration, eevee::ShaderDeclaration>) {
      const eevee::Feature constants = eevee::constants_of(declaration, masks.back());
      if (constants != eevee::Feature::None) {
        add(masks.back(), constants);
      }
    }
  }
}

std::vector<Variant> engine_variants()
{
  std::vector<Variant> variants;
  add_variants(eevee::shader_declarations(), eevee::interface_tables(), variants);
  add_variants(unlit::shader_declarations(), unlit::interface_tables(), variants);
  add_variants(overlay::shader_declarations(), overlay::interface_tables(), variants);
  return variants;
}

const std::vector<gpu::BlockLayout> &engine_blocks()
{
  static const std::vector<gpu::BlockLayout> blocks = [] {
    const auto first = eevee::block_layouts();
    std::vector<gpu::BlockLayout> all(first.begin(), first.end());
    const auto others = overlay::block_layouts();
    all.insert(all.end(), others.begin(), others.end());
    return all;
  }();
  return blocks;
}

std::size_t program_count(const std::vector<Variant> &variants)
{
  std::set<std::string_view> names;
  for (const Variant &variant : variants) {
    names.insert(variant.desc.name);
  }
  return names.size();
}

void throw_no_program(const std::string &name)
{
  throw std::runtime_error(fmt::format("no program '{}'; 'gnomon shaders list' lists all programs", name));
}

std::string defines_of(const gpu::ShaderDesc &desc)
{
  return fmt::format("{}", fmt::join(desc.defines, " "));
}

}  // namespace gnomon::cli
