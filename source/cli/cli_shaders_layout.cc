// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_interfaces.hh"
#include "cli_shader_programs.hh"

#include "shader_check_blocks.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <set>
#include <span>

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

Status engine_layout(const std::string &folder)
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
      fmt::print("{}:{}: error: {} [layout]\n", output::printable(files.shown(difference.file)), difference.line,
                 output::printable(difference.text));
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

// ---- Shaders and structs of others ----

using shader_check::ProgramBinding;

/** A C++ struct, and the block, or the struct of a member of it, whose layout it must have. */
struct HostStruct {
  std::string header;
  std::string name;
  std::string block;
  /** Path of the member; empty: the block itself. */
  std::string member;
};

/** From HEADER:NAME, HEADER:NAME=BLOCK or HEADER:NAME=BLOCK.MEMBER. \throws UsageError */
HostStruct host_struct_of(const std::string &argument)
{
  const std::size_t colon = argument.find(':');
  const std::size_t equal = std::min(argument.find('=', colon), argument.size());
  if (colon == std::string::npos || colon == 0 || equal - colon < 2 || equal + 1 == argument.size() ||
      argument.find_first_of("\"\\\n") != std::string::npos) {
    throw UsageError(
        fmt::format("--struct '{}': must be HEADER:NAME, HEADER:NAME=BLOCK or HEADER:NAME=BLOCK.MEMBER", argument));
  }
  HostStruct result{argument.substr(0, colon), argument.substr(colon + 1, equal - colon - 1), {}, {}};
  const std::string block =
      equal < argument.size() ? argument.substr(equal + 1) : result.name.substr(result.name.rfind(':') + 1);
  const std::size_t dot = block.find('.');
  result.block = block.substr(0, dot);
  result.member = dot == std::string::npos ? "" : block.substr(dot + 1);
  return result;
}

/** The path of \a name within one element of \a member; empty: \a name is no part of a struct there. */
std::string_view path_within(std::string_view name, std::string_view member)
{
  if (member.empty()) {
    return name;
  }
  if (!name.starts_with(member)) {
    return {};
  }
  name.remove_prefix(member.size());
  while (name.starts_with("[0]")) {
    name.remove_prefix(3);
  }
  return name.starts_with('.') ? name.substr(1) : std::string_view();
}

std::size_t index_count(std::string_view path)
{
  return std::size_t(std::ranges::count(path, '['));
}

/** C++ that compiles where \a host has the layout of \a block. Empty: the block has no such member. */
std::string assertions_of(const HostStruct &host, const ProgramBinding &block, std::string_view program)
{
  std::string text;
  std::set<std::string> written;
  const auto add = [&](const std::string &condition, std::string_view path) {
    if (written.insert(condition).second) {
      text += fmt::format("static_assert({}, {:?});\n", condition,
                          fmt::format("'{}' of block '{}' in {}", path, block.name, program));
    }
  };
  // Where the struct begins in the block.
  std::uint32_t begin = host.member.empty() ? 0 : std::numeric_limits<std::uint32_t>::max();
  for (const ProgramBinding::Member &member : block.members) {
    if (!path_within(member.name, host.member).empty()) {
      begin = std::min(begin, member.offset_bytes);
    }
  }
  std::uint32_t stride = 0;
  for (const ProgramBinding::Member &member : block.members) {
    const std::string path(path_within(member.name, host.member));
    if (path.empty()) {
      continue;
    }
    // The arrays that the struct itself is an element of.
    const std::size_t outer = index_count(member.name) - index_count(path);
    stride = outer > 0 ? member.arrays[outer - 1].stride_bytes : 0;
    const auto inner = std::span(member.arrays).subspan(outer);
    if (std::ranges::find(inner, 0U, &ProgramBinding::Array::count) != inner.end()) {
      text += fmt::format("// '{}' is in an array without a size, which no C++ struct has.\n", member.name);
      continue;
    }
    const std::string object = fmt::format("std::declval<{} &>().", host.name);
    add(fmt::format("offsetof({}, {}) == {}", host.name, path, member.offset_bytes - begin), member.name);
    add(fmt::format("sizeof({}{}) >= {}", object, path, member.size_bytes), member.name);
    // The path names elements of the arrays of structs. Those of the member itself follow.
    std::string element = path;
    while (index_count(element) < inner.size()) {
      element += "[0]";
    }
    std::size_t place = 0;
    for (const ProgramBinding::Array &array : inner) {
      place = element.find('[', place);
      const std::string whole = object + element.substr(0, place);
      add(fmt::format("sizeof({}) == {}", whole, array.count * array.stride_bytes), member.name);
      add(fmt::format("sizeof({}[0]) == {}", whole, array.stride_bytes), member.name);
      place++;
    }
  }
  if (stride > 0) {
    add(fmt::format("sizeof({}) == {}", host.name, stride), host.member);
  }
  return text;
}

/** C++ source that compiles where each struct has the layout of its block in each program that uses it. */
std::string assertions_of(const std::vector<std::string> &structs, const std::vector<NamedInterface> &programs)
{
  std::set<std::string> headers;
  std::string text;
  for (const std::string &argument : structs) {
    const HostStruct host = host_struct_of(argument);
    headers.insert(host.header);
    std::set<std::string> blocks;
    std::string assertions;
    for (const NamedInterface &program : programs) {
      for (const ProgramBinding &binding : program.interface.bindings) {
        if (!binding.members.empty()) {
          blocks.insert(binding.name);
          assertions += binding.name == host.block ? assertions_of(host, binding, program.name) : "";
        }
      }
    }
    if (assertions.empty()) {
      throw std::runtime_error(
          blocks.contains(host.block)
              ? fmt::format("--struct {}: block '{}' has no struct '{}'", argument, host.block, host.member)
              : fmt::format("--struct {}: no shader uses a block '{}'; used are: {}", argument, host.block,
                            blocks.empty() ? "none" : fmt::format("{}", fmt::join(blocks, ", "))));
    }
    text += "\n" + assertions;
  }
  std::string head =
      "// Written by `gnomon shaders layout`: compiles where C++ structs have the layout of GLSL blocks.\n";
  for (const std::string &header : headers) {
    head += fmt::format("#include \"{}\"\n", header);
  }
  return head + "#include <cstddef>\n#include <utility>\n" + text;
}

struct LayoutArguments {
  InterfaceArguments source;
  std::vector<std::string> structs;
  std::string shaders;
};

Status layout(const LayoutArguments &arguments)
{
  const InterfaceArguments &source = arguments.source;
  if (source.files.empty()) {
    if (!arguments.structs.empty() || !source.defines.empty() || !source.include_folders.empty() ||
        source.target != "auto") {
      throw UsageError("--struct, -I, -D and --target are for files");
    }
    return engine_layout(arguments.shaders);
  }
  if (arguments.structs.empty() || !arguments.shaders.empty()) {
    throw UsageError(
        "files need --struct; 'gnomon shaders reflect' prints their blocks. --shaders is for the engine's");
  }
  fmt::print("{}", assertions_of(arguments.structs, file_interfaces(source)));
  return Status::Done;
}

}  // namespace

void add_shaders_layout(CLI::App &shaders, Status &status)
{
  auto a = std::make_shared<LayoutArguments>();
  CLI::App *command = shaders.add_subcommand("layout", "Compare the layout of blocks in GLSL and in C++");
  command->add_option(
      "files", a->source.files,
      "Shaders, of which those of one stem are a program (default: the engine's blocks in C++ and GLSL)");
  command->add_option("--struct", a->structs,
                      "HEADER:NAME[=BLOCK[.MEMBER]], a C++ struct: print C++ source that compiles where the struct has "
                      "the layout of the block, or of an element of its member (default: the block of that name)");
  add_interface_options(*command, a->source);
  command->add_option("--shaders", a->shaders, "Folder of the engine's shaders (default: those in the program)");
  command->callback([a, &status] { status = layout(*a); });
}

}  // namespace gnomon::cli
