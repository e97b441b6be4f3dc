// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_programs.hh"

#include "eevee_programs.hh"

#include <fmt/format.h>

namespace gnomon::cli {

namespace {

void print_list()
{
  const std::vector<Variant> variants = engine_variants();
  std::string_view program;
  for (const Variant &variant : variants) {
    if (variant.desc.name != program) {
      program = variant.desc.name;
      fmt::print("{}: {}\n  {}\n  {}\n", program, variant.purpose, variant.desc.vertex_path,
                 variant.desc.fragment_path);
    }
    const std::string defines = defines_of(variant.desc);
    fmt::print("    {}\n", defines.empty() ? "(no define)" : defines);
  }
  for (const eevee::FeatureDefine &define : eevee::feature_defines()) {
    fmt::print("{}: where {}\n", define.define, define.purpose);
  }
  fmt::print("{} programs, {} variants\n", program_count(variants), variants.size());
  std::size_t count = 0;
  std::string programs;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    const std::size_t of_program = eevee::surface_function_variants(declaration).size();
    count += of_program;
    if (of_program > 0) {
      programs += fmt::format("{}{} ({})", programs.empty() ? "" : ", ", declaration.name, of_program);
    }
  }
  fmt::print("each surface function: at most {} of these variants once more, as its materials need them: {}\n", count,
             programs);
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
