// SPDX-License-Identifier: MIT
// A tool of the build: writes the interfaces of the engine's programs to the file that its argument names.
#include "eevee_programs.hh"

#include "shader_check_interfaces.hh"
#include "shader_files.hh"

#include <exception>
#include <fstream>

namespace {

using namespace gnomon;

/** Kernels that take each branch of the lookup. Others differ from these in numbers only. */
constexpr eevee::PcfKernel kernels[] = {{.width = 3}, {.width = 0}};

std::vector<shader_check::TableEntry> entries()
{
  std::vector<shader_check::TableEntry> entries;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    for (const eevee::Feature features : eevee::shader_variants(declaration)) {
      for (const eevee::PcfKernel &kernel : kernels) {
        gpu::ShaderDesc desc = eevee::shader_desc(declaration, features, kernel);
        if (entries.empty() || entries.back().desc.name != desc.name || entries.back().desc.defines != desc.defines) {
          entries.push_back({std::uint32_t(features), std::move(desc)});
        }
      }
    }
  }
  return entries;
}

}  // namespace

int main(int argument_count, char **arguments)
{
  if (argument_count != 2) {
    fmt::print(stderr, "usage: {} OUTPUT.cc\n", arguments[0]);
    return 2;
  }
  try {
    const auto programs = shader_check::variant_interfaces(entries(), shaders::file);
    std::ofstream file(arguments[1]);
    file << shader_check::table_source(programs, "eevee_interfaces.hh", "gnomon::eevee::interface_tables");
    file.close();
    if (!file) {
      throw gpu::Error("{} cannot be written", arguments[1]);
    }
  }
  catch (const std::exception &error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
  return 0;
}
