// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_programs.hh"

#include <fmt/format.h>

namespace gnomon::cli {

namespace {

void print_list()
{
  std::size_t variant_count = 0;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    fmt::print("{}: {}\n  {}\n  {}\n", declaration.name, declaration.purpose, declaration.vertex_path,
               declaration.fragment_path);
    for (const eevee::Feature features : eevee::shader_variants(declaration)) {
      const std::string defines = defines_of(eevee::shader_desc(declaration, features));
      fmt::print("    {}\n", defines.empty() ? "(no define)" : defines);
      variant_count++;
    }
  }
  for (const eevee::FeatureDefine &define : eevee::feature_defines()) {
    fmt::print("{}: where {}\n", define.define, define.purpose);
  }
  fmt::print("{} programs, {} variants\n", eevee::shader_declarations().size(), variant_count);
}

}  // namespace

void add_shaders(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand("shaders", "Check, list and reflect shaders");
  command->require_subcommand(1);
  command->add_subcommand("list", "All programs and variants, and their purpose")->callback([&status] {
    print_list();
    status = Status::Done;
  });
  add_shaders_check(*command, status);
  add_shaders_reflect(*command, status);
  add_shaders_layout(*command, status);
}

}  // namespace gnomon::cli
