// SPDX-License-Identifier: MIT
#include "shader_check_reflection.hh"

#include "internal/shader_check_compilation.hh"
#include "internal/shader_check_log.hh"
#include "slots_shared.h"

#include <algorithm>
#include <tuple>

namespace gnomon::shader_check {

namespace {

/** Whether \a name has an array index other than 0. */
bool is_later_element(std::string_view name)
{
  for (std::size_t i = name.find('['); i != std::string_view::npos; i = name.find('[', i + 1)) {
    if (name.substr(i, 3) != "[0]") {
      return true;
    }
  }
  return false;
}

/** The members of the block \a block_index, by offset. \a variable returns the reflected variable of an index. */
template <typename Get>
std::vector<gpu::ShaderInterface::Member> members_of(const glslang::TObjectReflection &block, int block_index,
                                                     int count, Get &&variable)
{
  std::vector<gpu::ShaderInterface::Member> members;
  const std::string prefix = block.name + ".";
  for (int i = 0; i < count; i++) {
    const glslang::TObjectReflection &member = variable(i);
    if (member.index == block_index && member.offset >= 0) {
      const bool has_prefix = member.name.starts_with(prefix);
      members.push_back({member.name.substr(has_prefix ? prefix.size() : 0), std::uint32_t(member.offset), 0});
    }
  }
  // glslang reports most blocks in this order.
  if (!std::ranges::is_sorted(members, {}, &gpu::ShaderInterface::Member::offset_bytes)) {
    std::ranges::stable_sort(members, {}, &gpu::ShaderInterface::Member::offset_bytes);
  }
  for (std::size_t i = 0; i < members.size(); i++) {
    const std::uint32_t end = i + 1 == members.size() ? std::uint32_t(block.size) : members[i + 1].offset_bytes;
    members[i].size_bytes = end - members[i].offset_bytes;
  }
  std::erase_if(members, [](const gpu::ShaderInterface::Member &member) { return is_later_element(member.name); });
  return members;
}

/** glslang ends a block at its last member. std140 and drivers end it at the end of that member's row of 16 bytes. */
std::uint32_t std140_size(const glslang::TObjectReflection &block)
{
  return (std::uint32_t(block.size) + 15U) / 16U * 16U;
}

/** ShaderInterface::Binding::stages of an object that glslang reports. */
std::uint32_t stages_of(const glslang::TObjectReflection &object)
{
  using gpu::ShaderStage;
  return ((object.stages & EShLangVertexMask) != 0 ? 1U << unsigned(ShaderStage::Vertex) : 0U) |
         ((object.stages & EShLangGeometryMask) != 0 ? 1U << unsigned(ShaderStage::Geometry) : 0U) |
         ((object.stages & EShLangFragmentMask) != 0 ? 1U << unsigned(ShaderStage::Fragment) : 0U);
}

/** Sets ShaderInterface::reads_object and varying_locations. */
void set_varyings(const Compilation &compilation, gpu::ShaderInterface &interface)
{
  for (std::size_t i = 0; i < compilation.facts.size(); i++) {
    const StageFacts &facts = compilation.facts[i];
    if (i == 0) {
      interface.reads_object = std::ranges::any_of(facts.inputs, [](const Declaration &input) {
        return input.is_used && input.location >= ATTRIBUTE_WORLD_FROM_OBJECT &&
               input.location <= ATTRIBUTE_OBJECT_VALUE;
      });
    }
    if (compilation.sources[i]->stage() != Stage::Fragment) {
      for (const Declaration &output : facts.outputs) {
        if (output.location >= 0) {
          interface.varying_locations = std::max(interface.varying_locations, output.location + output.location_count);
        }
      }
    }
  }
}

}  // namespace

gpu::ShaderInterface interface_of(glslang::TProgram &program)
{
  program.buildReflection(EShReflectionSeparateBuffers | EShReflectionAllBlockVariables |
                          EShReflectionStrictArraySuffix);
  gpu::ShaderInterface interface;
  const int variable_count = program.getNumUniformVariables();
  const auto variable = [&](int i) -> const glslang::TObjectReflection & { return program.getUniform(i); };
  for (int i = 0; i < program.getNumUniformBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getUniformBlock(i);
    std::vector<gpu::ShaderInterface::Member> members = members_of(block, i, variable_count, variable);
    if (block.name == gpu::push_constant_block_name) {
      interface.push_constant_slot = block.getBinding();
      interface.push_constant_size_bytes = std140_size(block);
      interface.push_constant_members = std::move(members);
      continue;
    }
    interface.bindings.push_back({block.name, gpu::BindingKind::UniformBlock, block.getBinding(), std140_size(block),
                                  std::move(members), stages_of(block)});
  }
  for (int i = 0; i < program.getNumBufferBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getBufferBlock(i);
    interface.bindings.push_back(
        {block.name, gpu::BindingKind::StorageBlock, block.getBinding(), std::uint32_t(block.size),
         members_of(block, i, program.getNumBufferVariables(),
                    [&](int j) -> const glslang::TObjectReflection & { return program.getBufferVariable(j); }),
         stages_of(block)});
  }
  for (int i = 0; i < variable_count; i++) {
    const glslang::TObjectReflection &uniform = variable(i);
    // Outside of blocks: textures, and plain uniforms. check_slots refuses the latter, because they have no slot.
    if (uniform.index == -1) {
      interface.bindings.push_back(
          {uniform.name, gpu::BindingKind::Texture, uniform.getBinding(), 0, {}, stages_of(uniform)});
    }
  }
  std::ranges::sort(interface.bindings, [](const auto &a, const auto &b) {
    return std::tie(a.kind, a.slot, a.name) < std::tie(b.kind, b.slot, b.name);
  });
  return interface;
}

namespace {

void check_slots(std::string_view name, const gpu::ShaderInterface &interface)
{
  for (std::size_t i = 0; i < interface.bindings.size(); i++) {
    const gpu::ShaderInterface::Binding &b = interface.bindings[i];
    if (b.slot < 0) {
      throw gpu::Error("shader '{}': {} '{}' has no layout(binding = …)", name, to_string(b.kind), b.name);
    }
    if (i > 0 && interface.bindings[i - 1].kind == b.kind && interface.bindings[i - 1].slot == b.slot) {
      throw gpu::Error("shader '{}': {} '{}' and '{}' share slot {}", name, to_string(b.kind),
                       interface.bindings[i - 1].name, b.name, b.slot);
    }
    if (interface.push_constant_size_bytes > 0 && b.kind == gpu::BindingKind::UniformBlock &&
        b.slot == interface.push_constant_slot) {
      throw gpu::Error("shader '{}': {} '{}' and '{}' share slot {}", name, to_string(b.kind),
                       gpu::push_constant_block_name, b.name, b.slot);
    }
  }
}

std::vector<StageVariable> variables(const std::vector<Declaration> &declarations, bool is_arrayed)
{
  std::vector<StageVariable> variables;
  for (const Declaration &declaration : declarations) {
    variables.push_back({declaration.name, type_name(declaration.type, is_arrayed), declaration.location});
  }
  std::ranges::stable_sort(variables, {}, &StageVariable::location);
  return variables;
}

}  // namespace

gpu::ShaderInterface reflect(std::string_view name, const std::vector<gpu::ShaderSource> &stages)
{
  gpu::ShaderInterface interface;
  with_large_stack([&] {
    Compilation compilation;
    for (const gpu::ShaderSource &stage : stages) {
      // SPIR-V, because its declarations can be read without glslang's tree.
      if (!compilation.add(std::make_unique<StageSource>(stage), CheckTarget::OpenGlSpirv, false)) {
        throw gpu::Error("shader '{}', {} stage:\n{}", name, to_string(stage.stage),
                         bounded_lines(stage.name_files(compilation.glslang.log())));
      }
    }
    if (!compilation.glslang.link()) {
      throw gpu::Error("shader '{}' does not link:\n{}", name, bounded_lines(compilation.glslang.log()));
    }
    compilation.read_facts(true, false);
    interface = interface_of(compilation.glslang.program());
    set_varyings(compilation, interface);
  });
  check_slots(name, interface);
  return interface;
}

StageVariables stage_variables(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files)
{
  StageVariables result;
  with_large_stack([&] {
    Compilation compilation;
    compile(desc, files, compilation);
    if (!compilation.facts.empty()) {
      const bool is_geometry = compilation.sources.front()->stage() == Stage::Geometry;
      result.inputs = variables(compilation.facts.front().inputs, is_geometry);
      result.outputs = variables(compilation.facts.back().outputs, false);
    }
  });
  return result;
}

}  // namespace gnomon::shader_check
