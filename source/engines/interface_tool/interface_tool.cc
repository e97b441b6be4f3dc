// SPDX-License-Identifier: MIT
// A build tool that writes the interfaces of an engine's programs to a source file.
#include "eevee_programs.hh"
#include "overlay_programs.hh"
#include "unlit_programs.hh"

#include "shader_check_interfaces.hh"
#include "shader_files.hh"

#include <exception>
#include <fstream>

namespace {

using namespace gnomon;
using Entries = std::vector<shader_check::TableEntry>;

/** The functions are found by the type of \a declarations. */
template <typename Declaration>
Entries entries_of(std::span<const Declaration> declarations)
{
  Entries entries;
  for (const Declaration &declaration : declarations) {
    for (const auto features : shader_variants(declaration)) {
      entries.push_back({std::uint32_t(features), shader_desc(declaration, features)});
    }
  }
  return entries;
}

/** Empty: there is no such engine. */
Entries entries_of(std::string_view engine)
{
  if (engine == "eevee") {
    // The kernel of PCF decides nothing about names: the tests of tables compare other kernels.
    return entries_of(eevee::shader_declarations());
  }
  if (engine == "unlit") {
    return entries_of(unlit::shader_declarations());
  }
  return engine == "overlay" ? entries_of(overlay::shader_declarations()) : Entries();
}

}  // namespace

int main(int argument_count, char **arguments)
{
  const std::string engine = argument_count == 3 ? arguments[1] : "";
  const Entries entries = entries_of(std::string_view(engine));
  if (entries.empty()) {
    fmt::print(stderr, "usage: {} eevee|unlit|overlay OUTPUT.cc\n", arguments[0]);
    return 2;
  }
  try {
    const auto programs = shader_check::variant_interfaces(entries, shaders::file);
    std::ofstream file(arguments[2]);
    file << shader_check::table_source(programs, engine + "_interfaces.hh", "gnomon::" + engine + "::interface_tables");
    file.close();
    if (!file) {
      throw gpu::Error("{} cannot be written", arguments[2]);
    }
  }
  catch (const std::exception &error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
  return 0;
}
