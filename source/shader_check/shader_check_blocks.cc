// SPDX-License-Identifier: MIT
#include "shader_check_blocks.hh"

#include "internal/shader_check_block.hh"

#include <algorithm>

namespace gnomon::shader_check {

namespace {

/** \a name without its last part: `lights[0].color` gives `lights[0].`. */
std::string_view parent_of(std::string_view name)
{
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : name.substr(0, dot + 1);
}

}  // namespace

BlockComparison compare_block(const Compilation &compilation, const gpu::ShaderInterface::Binding &binding,
                              const StageDeclaration &found, const gpu::BlockLayout &layout)
{
  const Declaration &block = *found.declaration;
  BlockComparison comparison;
  comparison.block = layout.name;
  comparison.cpp_size_bytes = layout.size_bytes;
  comparison.glsl_size_bytes = binding.size_bytes;
  comparison.file = compilation.file(found.stage, block.position);
  comparison.line = block.position.line;
  for (const BlockMember &member : block.members) {
    BlockComparison::Field &field = comparison.fields.emplace_back();
    field.structure = member.structure;
    field.name = member.name;
    field.file = compilation.file(found.stage, member.position);
    field.line = member.position.line;
    const auto glsl = std::ranges::find(binding.members, member.name, &gpu::ShaderInterface::Member::name);
    if (glsl != binding.members.end()) {
      field.glsl_offset_bytes = glsl->offset_bytes;
    }
    const auto cpp = std::ranges::find(layout.fields, member.name, &gpu::BlockLayout::Field::name);
    if (cpp != layout.fields.end()) {
      field.cpp_offset_bytes = cpp->offset_bytes;
    }
  }
  for (const gpu::BlockLayout::Field &cpp : layout.fields) {
    if (std::ranges::find(block.members, cpp.name, &BlockMember::name) != block.members.end()) {
      continue;
    }
    const auto sibling = std::ranges::find_if(
        block.members, [&](const BlockMember &member) { return parent_of(member.name) == parent_of(cpp.name); });
    BlockComparison::Field field;
    field.structure = sibling == block.members.end() ? "" : sibling->structure;
    const SourcePosition position = field.structure.empty()
                                        ? block.position
                                        : compilation.lines[found.stage].find_declaration(field.structure, "struct");
    field.name = cpp.name;
    field.cpp_offset_bytes = cpp.offset_bytes;
    field.file = compilation.file(found.stage, position);
    field.line = position.line;
    comparison.fields.push_back(std::move(field));
  }
  return comparison;
}

std::vector<BlockComparison> compare_blocks(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files,
                                            std::span<const gpu::BlockLayout> blocks)
{
  std::vector<BlockComparison> comparisons;
  with_large_stack([&] {
    Compilation compilation;
    compile(desc, files, compilation);
    for (const gpu::ShaderInterface::Binding &binding : interface_of(compilation.glslang.program()).bindings) {
      const auto layout = std::ranges::find(blocks, binding.name, &gpu::BlockLayout::name);
      const std::optional<StageDeclaration> found = find_block(compilation, binding.kind, binding.name);
      if (layout != blocks.end() && found) {
        comparisons.push_back(compare_block(compilation, binding, *found, *layout));
      }
    }
  });
  return comparisons;
}

std::vector<BlockDifference> differences(const BlockComparison &comparison)
{
  std::vector<BlockDifference> missing;
  std::vector<BlockDifference> moved;
  for (const BlockComparison::Field &field : comparison.fields) {
    const std::string where = field.structure.empty() ? std::string() : fmt::format(" of struct '{}'", field.structure);
    const std::string what = fmt::format("field '{}'{} in block '{}'", field.name, where, comparison.block);
    if (!field.cpp_offset_bytes) {
      missing.push_back({field.file, field.line, what + " is not in C++"});
    }
    else if (!field.glsl_offset_bytes) {
      missing.push_back({field.file, field.line, what + " is in C++ only"});
    }
    else if (*field.cpp_offset_bytes != *field.glsl_offset_bytes) {
      moved.push_back({field.file, field.line,
                       fmt::format("{} is at byte {}, in C++ at byte {}", what, *field.glsl_offset_bytes,
                                   *field.cpp_offset_bytes)});
    }
  }
  // A missing or additional field moves the following ones, so their offsets are not reported.
  if (!missing.empty()) {
    return missing;
  }
  if (moved.empty() && comparison.cpp_size_bytes != comparison.glsl_size_bytes) {
    moved.push_back({comparison.file, comparison.line,
                     fmt::format("block '{}' takes {} bytes, in C++ {}", comparison.block, comparison.glsl_size_bytes,
                                 comparison.cpp_size_bytes)});
  }
  return moved;
}

}  // namespace gnomon::shader_check
