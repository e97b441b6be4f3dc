// SPDX-License-Identifier: MIT
#include "gpu_shader.hh"

#include "gpu_error.hh"
#include "internal/gpu_glslang.hh"

#include <algorithm>
#include <tuple>

namespace gnomon::gpu {

namespace {

/** Whether \a name goes through an array's second element or a later one. */
bool is_later_element(std::string_view name)
{
  for (std::size_t i = name.find('['); i != std::string_view::npos; i = name.find('[', i + 1)) {
    if (name.substr(i, 3) != "[0]") {
      return true;
    }
  }
  return false;
}

/** Members of the block that \a variables name by \a block_index, in order. */
template <typename Get>
std::vector<ShaderInterface::Member> members_of(const glslang::TObjectReflection &block, int block_index, int count,
                                                Get &&variable)
{
  std::vector<ShaderInterface::Member> members;
  const std::string prefix = block.name + ".";
  for (int i = 0; i < count; i++) {
    const glslang::TObjectReflection &member = variable(i);
    if (member.index == block_index && member.offset >= 0) {
      const bool has_prefix = member.name.starts_with(prefix);
      members.push_back({member.name.substr(has_prefix ? prefix.size() : 0), std::uint32_t(member.offset), 0});
    }
  }
  std::ranges::stable_sort(members, {}, &ShaderInterface::Member::offset_bytes);
  for (std::size_t i = 0; i < members.size(); i++) {
    const std::uint32_t end = i + 1 == members.size() ? std::uint32_t(block.size) : members[i + 1].offset_bytes;
    members[i].size_bytes = end - members[i].offset_bytes;
  }
  std::erase_if(members, [](const ShaderInterface::Member &member) { return is_later_element(member.name); });
  return members;
}

/** ShaderInterface::Binding::stages of what glslang reports. */
std::uint32_t stages_of(const glslang::TObjectReflection &object)
{
  return ((object.stages & EShLangVertexMask) != 0 ? 1U << unsigned(ShaderStage::Vertex) : 0U) |
         ((object.stages & EShLangGeometryMask) != 0 ? 1U << unsigned(ShaderStage::Geometry) : 0U) |
         ((object.stages & EShLangFragmentMask) != 0 ? 1U << unsigned(ShaderStage::Fragment) : 0U);
}

/** glslang ends a block at its last member; std140, and drivers, at the end of that member's row of 16 bytes. */
std::uint32_t std140_size(const glslang::TObjectReflection &block)
{
  return (std::uint32_t(block.size) + 15U) / 16U * 16U;
}

}  // namespace

ShaderInterface interface_of(glslang::TProgram &program)
{
  program.buildReflection(EShReflectionSeparateBuffers | EShReflectionAllBlockVariables |
                          EShReflectionStrictArraySuffix);
  ShaderInterface interface;
  const int variable_count = program.getNumUniformVariables();
  const auto variable = [&](int i) -> const glslang::TObjectReflection & { return program.getUniform(i); };
  for (int i = 0; i < program.getNumUniformBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getUniformBlock(i);
    std::vector<ShaderInterface::Member> members = members_of(block, i, variable_count, variable);
    if (block.name == push_constant_block_name) {
      interface.push_constant_slot = block.getBinding();
      interface.push_constant_size_bytes = std140_size(block);
      interface.push_constant_members = std::move(members);
      continue;
    }
    interface.bindings.push_back({block.name, BindingKind::UniformBlock, block.getBinding(), std140_size(block),
                                  std::move(members), stages_of(block)});
  }
  for (int i = 0; i < program.getNumBufferBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getBufferBlock(i);
    interface.bindings.push_back(
        {block.name, BindingKind::StorageBlock, block.getBinding(), std::uint32_t(block.size),
         members_of(block, i, program.getNumBufferVariables(),
                    [&](int j) -> const glslang::TObjectReflection & { return program.getBufferVariable(j); }),
         stages_of(block)});
  }
  for (int i = 0; i < variable_count; i++) {
    const glslang::TObjectReflection &uniform = variable(i);
    // Outside of blocks stand textures, and plain uniforms, which have no slot either: check_slots refuses those.
    if (uniform.index == -1) {
      interface.bindings.push_back(
          {uniform.name, BindingKind::Texture, uniform.getBinding(), 0, {}, stages_of(uniform)});
    }
  }
  std::ranges::sort(interface.bindings, [](const auto &a, const auto &b) {
    return std::tie(a.kind, a.slot, a.name) < std::tie(b.kind, b.slot, b.name);
  });
  return interface;
}

namespace {

void check_slots(std::string_view name, const ShaderInterface &interface)
{
  for (std::size_t i = 0; i < interface.bindings.size(); i++) {
    const ShaderInterface::Binding &b = interface.bindings[i];
    if (b.slot < 0) {
      throw Error("shader '{}': {} '{}' has no layout(binding = …)", name, to_string(b.kind), b.name);
    }
    if (i > 0 && interface.bindings[i - 1].kind == b.kind && interface.bindings[i - 1].slot == b.slot) {
      throw Error("shader '{}': {} '{}' and '{}' share slot {}", name, to_string(b.kind),
                  interface.bindings[i - 1].name, b.name, b.slot);
    }
    if (interface.push_constant_size_bytes > 0 && b.kind == BindingKind::UniformBlock &&
        b.slot == interface.push_constant_slot) {
      throw Error("shader '{}': {} '{}' and '{}' share slot {}", name, to_string(b.kind), push_constant_block_name,
                  b.name, b.slot);
    }
  }
}

}  // namespace

ShaderInterface reflect(std::string_view name, const std::vector<ShaderSource> &stages)
{
  GlslangProgram glslang;
  for (const ShaderSource &stage : stages) {
    if (!glslang.add(stage, GlslangTarget::OpenGl)) {
      throw Error("shader '{}', {} stage:\n{}", name, to_string(stage.stage), stage.name_files(glslang.log()));
    }
  }
  if (!glslang.link()) {
    throw Error("shader '{}' does not link:\n{}", name, glslang.log());
  }
  ShaderInterface interface = interface_of(glslang.program());
  check_slots(name, interface);
  return interface;
}

}  // namespace gnomon::gpu
