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
    for (const auto features : shader_variants(declaration)) {
      variants.push_back({declaration.purpose, shader_desc(declaration, features),
                          interfaces[std::size_t(declaration.id)].interface_of(std::uint32_t(features))});
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
