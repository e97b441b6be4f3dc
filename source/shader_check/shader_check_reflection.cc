// SPDX-License-Identifier: MIT
#include "shader_check_reflection.hh"
#include "shader_check_program.hh"

#include "internal/shader_check_compilation.hh"
#include "internal/shader_check_log.hh"
#if GNOMON_GLSLANG_TREE
#include "internal/shader_check_tree.hh"
#endif
#include "slots_shared.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>

namespace gnomon::shader_check {

namespace {

using Members = std::vector<gpu::ShaderInterface::Member>;

/** Sets the sizes of the members of a block of \a block_bytes. \a members: also those of later elements of arrays. */
void set_sizes(Members &members, std::uint32_t block_bytes)
{
  // Most blocks have this order.
  if (!std::ranges::is_sorted(members, {}, &gpu::ShaderInterface::Member::offset_bytes)) {
    std::ranges::stable_sort(members, {}, &gpu::ShaderInterface::Member::offset_bytes);
  }
  for (std::size_t i = 0; i < members.size(); i++) {
    const std::uint32_t end = i + 1 == members.size() ? block_bytes : members[i + 1].offset_bytes;
    members[i].size_bytes = end - members[i].offset_bytes;
  }
}

#if GNOMON_GLSLANG_TREE

/** glslang's list of all members would be made again for each use of one, which takes as long as the parser. */
constexpr int reflection_options = EShReflectionSeparateBuffers | EShReflectionStrictArraySuffix;

/** Adds \a type at \a offset_bytes of a block: of arrays of structs or arrays the first element, and a place without a
 * name where the second begins. */
void add_members(const glslang::TType &type, const std::string &name, int offset_bytes, Members &members)
{
  using glslang::TIntermediate;
  const glslang::TQualifier &qualifier = type.getQualifier();
  if (type.isArray() && (type.isStruct() || type.isArrayOfArrays())) {
    int size_bytes = 0;
    int stride_bytes = 0;
    TIntermediate::getMemberAlignment(type, size_bytes, stride_bytes, qualifier.layoutPacking,
                                      qualifier.layoutMatrix == glslang::ElmRowMajor);
    add_members(glslang::TType(type, 0), name + "[0]", offset_bytes, members);
    if (type.getOuterArraySize() > 1) {
      members.push_back({"", std::uint32_t(offset_bytes + stride_bytes), 0});
    }
    return;
  }
  if (!type.isStruct()) {
    members.push_back({name, std::uint32_t(offset_bytes), 0});
    return;
  }
  int begin_bytes = 0;
  for (const glslang::TTypeLoc &entry : *type.getStruct()) {
    if (entry.type->getQualifier().hasOffset()) {
      begin_bytes = int(entry.type->getQualifier().layoutOffset);
    }
    int size_bytes = 0;
    TIntermediate::updateOffset(type, *entry.type, begin_bytes, size_bytes);
    const std::string field = text_of(entry.type->getFieldName());
    add_members(*entry.type, name.empty() ? field : name + "." + field, offset_bytes + begin_bytes, members);
    begin_bytes += size_bytes;
  }
}

/** The members of a block of \a size_bytes, by offset. */
Members members_of(const glslang::TType &block, std::uint32_t size_bytes)
{
  Members members;
  add_members(block, "", 0, members);
  set_sizes(members, size_bytes);
  std::erase_if(members, [](const gpu::ShaderInterface::Member &member) { return member.name.empty(); });
  return members;
}

template <typename Get>
Members members_of(const glslang::TObjectReflection &block, int /*block_index*/, int /*count*/, Get && /*variable*/)
{
  return members_of(*block.getType(), std::uint32_t(block.size));
}

#else

constexpr int reflection_options =
    EShReflectionSeparateBuffers | EShReflectionAllBlockVariables | EShReflectionStrictArraySuffix;

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
Members members_of(const glslang::TObjectReflection &block, int block_index, int count, Get &&variable)
{
  Members members;
  const std::string prefix = block.name + ".";
  for (int i = 0; i < count; i++) {
    const glslang::TObjectReflection &member = variable(i);
    if (member.index == block_index && member.offset >= 0) {
      const bool has_prefix = member.name.starts_with(prefix);
      members.push_back({member.name.substr(has_prefix ? prefix.size() : 0), std::uint32_t(member.offset), 0});
    }
  }
  set_sizes(members, std::uint32_t(block.size));
  std::erase_if(members, [](const gpu::ShaderInterface::Member &member) { return is_later_element(member.name); });
  return members;
}

#endif

/** glslang ends a block at its last member. std140 and drivers end it at the end of that member's row of 16 bytes. */
std::uint32_t std140_size(std::uint32_t size_bytes)
{
  return (size_bytes + 15U) / 16U * 16U;
}

/** ShaderInterface::Binding::stages of glslang's \a mask of stages. */
std::uint32_t stages_of(int mask)
{
  using gpu::ShaderStage;
  return ((mask & EShLangVertexMask) != 0 ? 1U << unsigned(ShaderStage::Vertex) : 0U) |
         ((mask & EShLangGeometryMask) != 0 ? 1U << unsigned(ShaderStage::Geometry) : 0U) |
         ((mask & EShLangFragmentMask) != 0 ? 1U << unsigned(ShaderStage::Fragment) : 0U);
}

void set_push_constants(int slot, int size_bytes, Members members, gpu::ShaderInterface &interface)
{
  interface.push_constant_slot = slot;
  interface.push_constant_size_bytes = std140_size(std::uint32_t(size_bytes));
  interface.push_constant_members = std::move(members);
}

void sort_bindings(gpu::ShaderInterface &interface)
{
  std::ranges::sort(interface.bindings, [](const auto &a, const auto &b) {
    return std::tie(a.kind, a.slot, a.name) < std::tie(b.kind, b.slot, b.name);
  });
}

#if GNOMON_GLSLANG_TREE

/**
 * The uniforms and blocks that a linked stage uses. As in glslang's reflection, branches that are never taken count.
 * Linking removed the functions without a caller.
 */
class UsedSymbols : public glslang::TIntermTraverser {
 public:
  std::set<long long> ids;

  bool visitAggregate(glslang::TVisit /*visit*/, glslang::TIntermAggregate *aggregate) override
  {
    return aggregate->getOp() != glslang::EOpLinkerObjects;
  }
  void visitSymbol(glslang::TIntermSymbol *symbol) override
  {
    if (symbol->getQualifier().isUniformOrBuffer()) {
      ids.insert(symbol->getId());
    }
  }
};

/** Adds \a symbol, which \a stages use. \return false for arrays of blocks, and for arrays and structs outside of
 * blocks */
bool add_symbol(const glslang::TIntermSymbol &symbol, std::uint32_t stages, gpu::ShaderInterface &interface)
{
  const glslang::TType &type = symbol.getType();
  const glslang::TQualifier &qualifier = type.getQualifier();
  const bool is_block = type.getBasicType() == glslang::EbtBlock;
  if (type.isArray() || (type.isStruct() && !is_block)) {
    return false;
  }
  const bool is_buffer = qualifier.storage == glslang::EvqBuffer;
  gpu::ShaderInterface::Binding binding;
  binding.name = text_of(is_block ? type.getTypeName() : symbol.getName());
  binding.kind = !is_block   ? gpu::BindingKind::Texture
                 : is_buffer ? gpu::BindingKind::StorageBlock
                             : gpu::BindingKind::UniformBlock;
  binding.slot = qualifier.hasBinding() ? int(qualifier.layoutBinding) : -1;
  binding.stages = stages;
  for (gpu::ShaderInterface::Binding &known : interface.bindings) {
    if (known.kind == binding.kind && known.name == binding.name) {
      known.stages |= stages;
      return true;
    }
  }
  const bool is_push_constants = is_block && !is_buffer && binding.name == gpu::push_constant_block_name;
  if (is_push_constants && interface.push_constant_size_bytes > 0) {
    return true;
  }
  if (is_block) {
    const int size_bytes = glslang::TIntermediate::getBlockSize(type);
    binding.members = members_of(type, std::uint32_t(size_bytes));
    if (is_push_constants) {
      set_push_constants(binding.slot, size_bytes, std::move(binding.members), interface);
      return true;
    }
    binding.size_bytes = is_buffer ? std::uint32_t(size_bytes) : std140_size(std::uint32_t(size_bytes));
  }
  interface.bindings.push_back(std::move(binding));
  return true;
}

/**
 * The interface by one walk over each tree. glslang's reflection names all elements of an array of structs at each use
 * of one, which takes longer than all else. \return nothing if names of elements are needed, which glslang makes
 */
std::optional<gpu::ShaderInterface> interface_of_trees(glslang::TProgram &program)
{
  gpu::ShaderInterface interface;
  for (int language = 0; language < EShLangCount; language++) {
    const glslang::TIntermediate *tree = program.getIntermediate(EShLanguage(language));
    if (tree == nullptr || tree->getTreeRoot() == nullptr) {
      continue;
    }
    UsedSymbols used;
    tree->getTreeRoot()->traverse(&used);
    const glslang::TIntermAggregate *objects = tree->findLinkerObjects();
    if (objects == nullptr) {
      continue;
    }
    for (const TIntermNode *object : objects->getSequence()) {
      const glslang::TIntermSymbol *symbol = object->getAsSymbolNode();
      if (symbol != nullptr && used.ids.contains(symbol->getId()) &&
          !add_symbol(*symbol, stages_of(1 << language), interface)) {
        return std::nullopt;
      }
    }
  }
  sort_bindings(interface);
  return interface;
}

#endif

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
#if GNOMON_GLSLANG_TREE
  if (std::optional<gpu::ShaderInterface> interface = interface_of_trees(program)) {
    return *std::move(interface);
  }
#endif
  program.buildReflection(reflection_options);
  gpu::ShaderInterface interface;
  const int variable_count = program.getNumUniformVariables();
  const auto variable = [&](int i) -> const glslang::TObjectReflection & { return program.getUniform(i); };
  for (int i = 0; i < program.getNumUniformBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getUniformBlock(i);
    Members members = members_of(block, i, variable_count, variable);
    if (block.name == gpu::push_constant_block_name) {
      set_push_constants(block.getBinding(), block.size, std::move(members), interface);
      continue;
    }
    interface.bindings.push_back({block.name, gpu::BindingKind::UniformBlock, block.getBinding(),
                                  std140_size(std::uint32_t(block.size)), std::move(members), stages_of(block.stages)});
  }
  for (int i = 0; i < program.getNumBufferBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getBufferBlock(i);
    interface.bindings.push_back(
        {block.name, gpu::BindingKind::StorageBlock, block.getBinding(), std::uint32_t(block.size),
         members_of(block, i, program.getNumBufferVariables(),
                    [&](int j) -> const glslang::TObjectReflection & { return program.getBufferVariable(j); }),
         stages_of(block.stages)});
  }
  for (int i = 0; i < variable_count; i++) {
    const glslang::TObjectReflection &uniform = variable(i);
    // Outside of blocks: textures, and plain uniforms. check_slots refuses the latter, because they have no slot.
    if (uniform.index == -1) {
      interface.bindings.push_back(
          {uniform.name, gpu::BindingKind::Texture, uniform.getBinding(), 0, {}, stages_of(uniform.stages)});
    }
  }
  sort_bindings(interface);
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

std::vector<StageVariable> variables(const std::vector<Declaration> &declarations)
{
  std::vector<StageVariable> variables;
  for (const Declaration &declaration : declarations) {
    variables.push_back({declaration.name, type_name(declaration.type, declaration.is_arrayed), declaration.location,
                         declaration.component, declaration.index});
  }
  std::ranges::stable_sort(variables, {}, [](const StageVariable &variable) {
    return std::tuple(variable.location, variable.index, variable.component);
  });
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
      if (!compilation.add(std::make_unique<StageSource>(stage), CheckTarget::OpenGlSpirv, false, false)) {
        throw gpu::Error("shader '{}', {} stage:\n{}", name, to_string(stage.stage),
                         bounded_lines(stage.name_files(compilation.glslang.log())));
      }
    }
    if (!compilation.link()) {
      throw gpu::Error("shader '{}' does not link:\n{}", name, bounded_lines(compilation.glslang.log()));
    }
    compilation.read_facts(true, false);
    interface = interface_of(compilation.glslang.program());
    set_varyings(compilation, interface);
  });
  check_slots(name, interface);
  return interface;
}

std::string_view to_string(ProgramBinding::Kind kind)
{
  switch (kind) {
    case ProgramBinding::Kind::UniformBlock: return to_string(gpu::BindingKind::UniformBlock);
    case ProgramBinding::Kind::StorageBlock: return to_string(gpu::BindingKind::StorageBlock);
    case ProgramBinding::Kind::Texture: return to_string(gpu::BindingKind::Texture);
    case ProgramBinding::Kind::Image: return "image";
    case ProgramBinding::Kind::PushConstants: return "push constants";
    case ProgramBinding::Kind::Sampler: return "sampler";
    case ProgramBinding::Kind::SubpassInput: return "subpass input";
    case ProgramBinding::Kind::AccelerationStructure: return "acceleration structure";
    case ProgramBinding::Kind::AtomicCounter: return "atomic counter";
  }
  return "";
}

namespace {

/** \a usual: the kind of the list that \a declaration is in. */
ProgramBinding::Kind kind_of(const Declaration &declaration, ProgramBinding::Kind usual)
{
  using Kind = ProgramBinding::Kind;
  const std::string_view type = declaration.type.name;
  if (usual != Kind::Texture) {
    return declaration.is_push_constant ? Kind::PushConstants : usual;
  }
  return declaration.is_image                 ? Kind::Image
         : type == "sampler"                  ? Kind::Sampler
         : type == "atomic_uint"              ? Kind::AtomicCounter
         : type == "accelerationStructureEXT" ? Kind::AccelerationStructure
         : declaration.attachment >= 0        ? Kind::SubpassInput
                                              : usual;
}

/** Adds those of \a declarations that \a stage uses. \a booleans: booleans_in(). */
void add_bindings(const std::vector<Declaration> &declarations, ProgramBinding::Kind usual, Stage stage,
                  const std::map<std::string, std::string> &booleans, std::vector<ProgramBinding> &bindings)
{
  for (const Declaration &declaration : declarations) {
    if (!declaration.is_used) {
      continue;
    }
    ProgramBinding binding{.kind = kind_of(declaration, usual),
                           .name = declaration.name,
                           .type = usual == ProgramBinding::Kind::Texture ? type_name(declaration.type) : "",
                           .counts = declaration.type.array_sizes,
                           .set = declaration.set,
                           .slot = declaration.slot,
                           .format = declaration.format,
                           .qualifiers = declaration.qualifiers,
                           .attachment = declaration.attachment,
                           .offset_bytes = declaration.offset_bytes,
                           .size_bytes = declaration.size_bytes,
                           .members = {},
                           .stages = {}};
    for (const BlockMember &member : declaration.members) {
      DeclaredType type = member.type;
      const auto boolean = booleans.find(declaration.name + "." + member.name);
      type.name = boolean == booleans.end() ? type.name : boolean->second;
      binding.members.push_back({member.name, type_name(type), member.offset_bytes, member.size_bytes, member.arrays,
                                 member.matrix_stride_bytes, member.is_row_major});
    }
    const auto known = std::ranges::find_if(bindings, [&](const ProgramBinding &other) {
      binding.stages = other.stages;
      return binding == other;
    });
    if (known != bindings.end()) {
      known->stages.push_back(stage);
      continue;
    }
    binding.stages = {stage};
    bindings.push_back(std::move(binding));
  }
}

/**
 * Adds GLSL's types of boolean members of blocks, which are integers in SPIR-V, to \a types. Keys are the names of
 * block and member, such as `Scene.lights[0].is_on`. \return false if \a program is not linked
 */
bool add_booleans(glslang::TProgram &program, std::map<std::string, std::string> &types)
{
  if (!program.buildReflection(EShReflectionSeparateBuffers | EShReflectionAllBlockVariables |
                               EShReflectionStrictArraySuffix)) {
    return false;
  }
  const auto add = [&](const glslang::TObjectReflection &member, std::string block) {
    // GL_BOOL, and GL_BOOL_VEC2 to GL_BOOL_VEC4.
    const int size = member.glDefineType - 0x8B56 + 1;
    if (size < 1 || size > 4) {
      return;
    }
    block.resize(std::min(block.find('['), block.size()));
    std::string name = member.name.substr(member.name.starts_with(block + ".") ? block.size() + 1 : 0);
    while (name.ends_with("[0]")) {
      name.resize(name.size() - 3);
    }
    types.emplace(block + "." + name, size == 1 ? "bool" : fmt::format("bvec{}", size));
  };
  for (int i = 0; i < program.getNumUniformVariables(); i++) {
    if (const int block = program.getUniform(i).index; block >= 0) {
      add(program.getUniform(i), program.getUniformBlock(block).name);
    }
  }
  for (int i = 0; i < program.getNumBufferVariables(); i++) {
    add(program.getBufferVariable(i), program.getBufferBlock(program.getBufferVariable(i).index).name);
  }
  return true;
}

std::map<std::string, std::string> booleans_in(Compilation &compilation, CheckTarget target)
{
  std::map<std::string, std::string> types;
  if (!add_booleans(compilation.glslang.program(), types)) {
    // Blocks differ between the stages, which Vulkan allows and glslang does not.
    for (const std::unique_ptr<StageSource> &source : compilation.sources) {
      GlslangProgram alone;
      if (alone.add(*source, target, false) && alone.link()) {
        add_booleans(alone.program(), types);
      }
    }
  }
  return types;
}

/** The interface of a program that is linked for a target with SPIR-V. */
ProgramInterface interface_of(Compilation &compilation, CheckTarget target)
{
  const std::map<std::string, std::string> booleans = booleans_in(compilation, target);
  ProgramInterface result;
  result.target = target;
  StageFacts facts;
  for (std::size_t i = 0; i < compilation.sources.size(); i++) {
    const Stage stage = compilation.sources[i]->stage();
    facts = read_spirv(compilation.spirv(i).words, stage, compilation.lines[i]);
    result.stages.push_back(stage);
    add_bindings(facts.uniform_blocks, ProgramBinding::Kind::UniformBlock, stage, booleans, result.bindings);
    add_bindings(facts.storage_blocks, ProgramBinding::Kind::StorageBlock, stage, booleans, result.bindings);
    add_bindings(facts.textures, ProgramBinding::Kind::Texture, stage, booleans, result.bindings);
    for (const ProgramConstant &constant : facts.constants) {
      if (std::ranges::find(result.constants, constant) == result.constants.end()) {
        result.constants.push_back(constant);
      }
    }
    if (facts.workgroup) {
      result.workgroups.push_back(*facts.workgroup);
    }
    for (const Declaration &uniform : facts.uniforms) {
      if (uniform.is_used &&
          std::ranges::find(result.uniforms, uniform.name, &StageVariable::name) == result.uniforms.end()) {
        result.uniforms.push_back({uniform.name, type_name(uniform.type), uniform.location});
      }
    }
    if (i == 0) {
      result.inputs = variables(facts.inputs);
    }
  }
  result.outputs = variables(facts.outputs);
  std::ranges::stable_sort(result.constants, {}, &ProgramConstant::id);
  std::ranges::stable_sort(result.uniforms, {}, &StageVariable::location);
  for (ProgramBinding &binding : result.bindings) {
    const bool is_uniform =
        binding.kind == ProgramBinding::Kind::UniformBlock || binding.kind == ProgramBinding::Kind::PushConstants;
    if (is_uniform && !is_vulkan(target)) {
      binding.size_bytes = std140_size(binding.size_bytes);
    }
  }
  std::ranges::sort(result.bindings, [](const ProgramBinding &a, const ProgramBinding &b) {
    return std::tie(a.kind, a.set, a.slot, a.name) < std::tie(b.kind, b.set, b.slot, b.name);
  });
  return result;
}

}  // namespace

ProgramInterface program_interface(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files)
{
  ProgramInterface result;
  with_large_stack([&] {
    Compilation compilation;
    compile(desc, files, compilation);
    result = interface_of(compilation, CheckTarget::OpenGlSpirv);
  });
  return result;
}

ProgramInterface program_interface(const Program &program, const gpu::ShaderFiles &files, const ProgramOptions &options)
{
  const ProgramCheck check = check_program(program, files, options);
  std::vector<std::string> errors;
  for (const CheckMessage &message : check.messages) {
    if (message.severity == Severity::Error) {
      errors.push_back(fmt::format("{}:{}: {}", message.file, message.line, message.text));
    }
  }
  if (!errors.empty()) {
    throw gpu::Error("{}", fmt::join(errors, "\n"));
  }
  if (check.target == CheckTarget::Es) {
    throw gpu::Error("'{}' is for {}, for which there is no SPIR-V; vulkan1.0 reads GLSL ES 3.10 and later",
                     program.name, to_string(check.target));
  }
  const CheckTarget target = has_spirv(check.target) ? check.target : CheckTarget::OpenGlSpirv;
  std::vector<Program::File> sorted = program.files;
  std::ranges::stable_sort(sorted, {}, &Program::File::stage);
  ProgramInterface result;
  with_large_stack([&] {
    Compilation compilation;
    for (const Program::File &file : sorted) {
      auto source = std::make_unique<StageSource>(file.stage, file.path, files(file.path).value_or(""), program.defines,
                                                  files, options.include_folders);
      if (!compilation.add(std::move(source), target, false)) {
        const CompileMessage first = compile_messages(compilation.glslang.log(), *compilation.sources.back()).at(0);
        throw gpu::Error("{}:{}: for {}: {}", compilation.file(compilation.sources.size() - 1, first.position),
                         first.position.line, to_string(target), first.text);
      }
    }
    // The stages of a program for Vulkan may differ in what glslang compares by name, and check_program() has compared
    // them.
    if (!compilation.link() && !is_vulkan(target)) {
      throw gpu::Error("'{}' does not link for {}:\n{}", program.name, to_string(target),
                       bounded_lines(compilation.glslang.log()));
    }
    result = interface_of(compilation, target);
  });
  return result;
}

}  // namespace gnomon::shader_check
