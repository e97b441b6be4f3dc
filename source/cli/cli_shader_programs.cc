// SPDX-License-Identifier: MIT
#include "cli_shader_programs.hh"

#include "eevee_programs.hh"
#include "shader_files.hh"
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

std::vector<Variant> engine_variants()
{
  std::vector<Variant> variants;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    for (const eevee::Feature features : eevee::shader_variants(declaration)) {
      variants.push_back({declaration.purpose, eevee::shader_desc(declaration, features)});
    }
  }
  for (const unlit::ShaderDeclaration &declaration : unlit::shader_declarations()) {
    for (const unlit::Feature features : unlit::shader_variants(declaration)) {
      variants.push_back({declaration.purpose, unlit::shader_desc(declaration, features)});
    }
  }
  return variants;
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
