// SPDX-License-Identifier: MIT
#include "shader_check_stage.hh"

#include "gpu_shader.hh"

#include <spirv-tools/libspirv.h>
#include <glslang/SPIRV/spirv.hpp>

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <set>
#include <utility>

namespace gnomon::shader_check {

std::string type_name(const DeclaredType &type, bool is_arrayed)
{
  std::string name = type.name;
  for (std::size_t i = is_arrayed ? 1 : 0; i < type.array_sizes.size(); i++) {
    name += type.array_sizes[i] == 0 ? "[]" : fmt::format("[{}]", type.array_sizes[i]);
  }
  return name;
}

void check_array(const DeclaredType &type, bool has_rows, const BlockMember &member,
                 std::vector<StageFinding> &findings)
{
  const bool is_array = !type.array_sizes.empty();
  const bool is_matrix = type.row_count > 0;
  if (is_matrix && type.row_count != 4) {
    findings.push_back({"block-array", member.position,
                        fmt::format("'{}': a matrix with {} rows takes 16 bytes a column in a block; C++ has {}",
                                    member.name, type.row_count, 4 * type.row_count),
                        type.row_count == 3});
  }
  else if (is_array && type.vector_size == 3) {
    findings.push_back(
        {"block-array", member.position,
         fmt::format("'{}': an array of vec3 takes 16 bytes an element in a block; C++ has 12", member.name), true});
  }
  else if (is_array && has_rows && !is_matrix && type.vector_size < 4 && type.scalar != "double") {
    findings.push_back({"block-array", member.position,
                        fmt::format("'{}': an array of {} takes 16 bytes an element in a std140 block; C++ has {}",
                                    member.name, type.vector_size == 1 ? "scalars" : "vec2", 4 * type.vector_size),
                        false});
  }
}

bool is_64_bit(const DeclaredType &type)
{
  return type.scalar == "double" || type.scalar.ends_with("64_t");
}

void set_components(Declaration &declaration, int first)
{
  const DeclaredType &type = declaration.type;
  if (!type.is_struct && type.row_count == 0) {
    declaration.component = first;
    declaration.component_count = type.vector_size * (is_64_bit(type) ? 2 : 1);
  }
}

namespace {

/** Values by decoration; 0 for those without. */
using Decorations = std::map<std::uint32_t, std::uint32_t>;

struct SpirvType {
  spv::Op op = spv::OpNop;
  /** Words behind the result. */
  std::vector<std::uint32_t> operands;
  struct Member {
    std::string name;
    Decorations decorations;
  };
  /** Members of a struct that have a name or a decoration. */
  std::map<std::uint32_t, Member> members;
};

struct SpirvVariable {
  std::uint32_t id = 0;
  /** Type of the pointer. */
  std::uint32_t type = 0;
  spv::StorageClass storage = spv::StorageClassFunction;
};

/** Declarations of a module of SPIR-V. */
struct SpirvModule {
  std::map<std::uint32_t, std::string> names;
  std::map<std::uint32_t, SpirvType> types;
  std::map<std::uint32_t, Decorations> decorations;
  /** Constants of one word. */
  std::map<std::uint32_t, std::uint32_t> constants;
  struct SpecConstant {
    std::uint32_t id;
    std::uint32_t type;
    std::uint64_t bits;
  };
  std::vector<SpecConstant> spec_constants;
  /** The ids of vectors' components, by the vector's id. */
  std::map<std::uint32_t, std::vector<std::uint32_t>> constituents;
  /** Values of LocalSize, or ids of LocalSizeId. */
  std::vector<std::uint32_t> local_size;
  bool has_local_size_ids = false;
  /** Outside of functions. */
  std::vector<SpirvVariable> variables;
  /** By id: whether a function uses it. */
  std::vector<bool> used;
  /** The first two indices of each access to a part of a variable, with the variable; 0: there is no second. */
  std::set<std::array<std::uint32_t, 3>> accesses;
  bool is_in_function = false;

  explicit SpirvModule(std::span<const std::uint32_t> words)
  {
    // The environment decides nothing about the form of instructions.
    const spv_context context = spvContextCreate(SPV_ENV_UNIVERSAL_1_6);
    const auto header = [](void *self, spv_endianness_t, std::uint32_t, std::uint32_t, std::uint32_t,
                           std::uint32_t bound, std::uint32_t) {
      static_cast<SpirvModule *>(self)->used.resize(bound);
      return SPV_SUCCESS;
    };
    const auto instruction = [](void *self, const spv_parsed_instruction_t *one) {
      static_cast<SpirvModule *>(self)->add(*one);
      return SPV_SUCCESS;
    };
    spvBinaryParse(context, this, words.data(), words.size(), header, instruction, nullptr);
    spvContextDestroy(context);
  }

  [[nodiscard]] const SpirvType &type(std::uint32_t id) const
  {
    static const SpirvType none;
    const auto found = types.find(id);
    return found == types.end() ? none : found->second;
  }
  [[nodiscard]] std::string name(std::uint32_t id) const
  {
    const auto found = names.find(id);
    return found == names.end() ? std::string() : found->second;
  }

 private:
  static std::string text_at(const spv_parsed_instruction_t &one, std::size_t word)
  {
    return reinterpret_cast<const char *>(one.words + word);
  }
  static std::pair<std::uint32_t, std::uint32_t> decoration_at(const spv_parsed_instruction_t &one, std::size_t word)
  {
    return {one.words[word], word + 1U < one.num_words ? one.words[word + 1] : 0U};
  }

  void add(const spv_parsed_instruction_t &one)
  {
    const std::uint32_t *words = one.words;
    if (is_in_function) {
      for (std::size_t i = 0; i < one.num_operands; i++) {
        const spv_parsed_operand_t &operand = one.operands[i];
        if (operand.type == SPV_OPERAND_TYPE_ID && words[operand.offset] < used.size()) {
          used[words[operand.offset]] = true;
        }
      }
      if ((one.opcode == spv::OpAccessChain || one.opcode == spv::OpInBoundsAccessChain) && one.num_words > 4) {
        accesses.insert({words[3], words[4], one.num_words > 5 ? words[5] : 0});
      }
      return;
    }
    switch (one.opcode) {
      case spv::OpFunction: is_in_function = true; break;
      case spv::OpName: names[words[1]] = text_at(one, 2); break;
      case spv::OpMemberName: types[words[1]].members[words[2]].name = text_at(one, 3); break;
      case spv::OpDecorate: decorations[words[1]].insert(decoration_at(one, 2)); break;
      case spv::OpMemberDecorate: types[words[1]].members[words[2]].decorations.insert(decoration_at(one, 3)); break;
      case spv::OpSpecConstantTrue:
      case spv::OpSpecConstantFalse:
        spec_constants.push_back({one.result_id, one.type_id, one.opcode == spv::OpSpecConstantTrue ? 1U : 0U});
        break;
      case spv::OpSpecConstant:
        spec_constants.push_back(
            {one.result_id, one.type_id, words[3] | (one.num_words > 4 ? std::uint64_t(words[4]) << 32U : 0U)});
        [[fallthrough]];
      case spv::OpConstant: constants[one.result_id] = words[3]; break;
      case spv::OpConstantComposite:
      case spv::OpSpecConstantComposite: constituents[one.result_id].assign(words + 3, words + one.num_words); break;
      case spv::OpExecutionMode:
      case spv::OpExecutionModeId:
        if (words[2] == spv::ExecutionModeLocalSize || words[2] == spv::ExecutionModeLocalSizeId) {
          local_size.assign(words + 3, words + one.num_words);
          has_local_size_ids = words[2] == spv::ExecutionModeLocalSizeId;
        }
        break;
      case spv::OpVariable: variables.push_back({one.result_id, one.type_id, spv::StorageClass(words[3])}); break;
      default:
        // An instruction with an id and without a type declares a type, a label, a group of decorations or an
        // extension.
        if (one.result_id != 0 && one.type_id == 0) {
          SpirvType &type = types[one.result_id];
          type.op = spv::Op(one.opcode);
          type.operands.assign(words + 2, words + one.num_words);
        }
    }
  }
};

class SpirvReader {
 public:
  SpirvReader(const SpirvModule &module, Stage stage, const SourceLines &lines)
      : module_(module), stage_(stage), lines_(lines)
  {
    for (const SpirvVariable &variable : module.variables) {
      add(variable);
    }
    for (const SpirvModule::SpecConstant &constant : module.spec_constants) {
      add(constant);
    }
    set_workgroup();
  }
  StageFacts facts;

 private:
  static const std::uint32_t *find(const Decorations &decorations, spv::Decoration decoration)
  {
    const auto found = decorations.find(decoration);
    return found == decorations.end() ? nullptr : &found->second;
  }
  const std::uint32_t *find(std::uint32_t id, spv::Decoration decoration) const
  {
    const auto found = module_.decorations.find(id);
    return found == module_.decorations.end() ? nullptr : find(found->second, decoration);
  }
  static int value_or(const std::uint32_t *value, int other)
  {
    return value == nullptr ? other : int(*value);
  }
  static const SpirvType::Member &member_of(const SpirvType &type, std::uint32_t index)
  {
    static const SpirvType::Member none;
    const auto found = type.members.find(index);
    return found == type.members.end() ? none : found->second;
  }
  static bool is_array(const SpirvType &type)
  {
    return type.op == spv::OpTypeArray || type.op == spv::OpTypeRuntimeArray;
  }
  /** 0: the shader gives none. */
  int length_of(const SpirvType &array) const
  {
    const auto length =
        array.op == spv::OpTypeArray ? module_.constants.find(array.operands[1]) : module_.constants.end();
    return length == module_.constants.end() ? 0 : int(length->second);
  }
  /** The type of elements of \a id, and of their elements; \a id if it is no array. */
  std::uint32_t element_of(std::uint32_t id) const
  {
    while (is_array(module_.type(id))) {
      id = module_.type(id).operands[0];
    }
    return id;
  }

  /** The name of a scalar, and the prefix of the names of its vectors. */
  std::pair<std::string, std::string> scalar_name(std::uint32_t id) const
  {
    const SpirvType &type = module_.type(id);
    const std::uint32_t bits = type.operands.empty() ? 0U : type.operands[0];
    switch (type.op) {
      case spv::OpTypeBool: return {"bool", "b"};
      case spv::OpTypeFloat:
        return bits == 32   ? std::pair<std::string, std::string>{"float", ""}
               : bits == 64 ? std::pair<std::string, std::string>{"double", "d"}
                            : std::pair<std::string, std::string>{"float16_t", "f16"};
      case spv::OpTypeInt: {
        const bool is_signed = type.operands[1] != 0;
        const std::string name = is_signed ? "int" : "uint";
        const std::string start = is_signed ? "i" : "u";
        return bits == 32 ? std::pair{name, start}
                          : std::pair{fmt::format("{}{}_t", name, bits), fmt::format("{}{}", start, bits)};
      }
      default: return {};
    }
  }
  /** GLSL's name of the format of an image; empty if it has none. */
  static std::string_view format_name(std::uint32_t format)
  {
    static constexpr std::array<std::string_view, 42> names = {"",          "rgba32f",      "rgba16f",
                                                               "r32f",      "rgba8",        "rgba8_snorm",
                                                               "rg32f",     "rg16f",        "r11f_g11f_b10f",
                                                               "r16f",      "rgba16",       "rgb10_a2",
                                                               "rg16",      "rg8",          "r16",
                                                               "r8",        "rgba16_snorm", "rg16_snorm",
                                                               "rg8_snorm", "r16_snorm",    "r8_snorm",
                                                               "rgba32i",   "rgba16i",      "rgba8i",
                                                               "r32i",      "rg32i",        "rg16i",
                                                               "rg8i",      "r16i",         "r8i",
                                                               "rgba32ui",  "rgba16ui",     "rgba8ui",
                                                               "r32ui",     "rgb10_a2ui",   "rg32ui",
                                                               "rg16ui",    "rg8ui",        "r16ui",
                                                               "r8ui",      "r64ui",        "r64i"};
    return format < names.size() ? names[format] : std::string_view();
  }
  /** Qualifiers of an image, or those that each member of the struct \a block has. */
  std::vector<std::string_view> qualifiers(std::uint32_t id, const SpirvType *block) const
  {
    static constexpr std::array<std::pair<spv::Decoration, std::string_view>, 5> all = {
        {{spv::DecorationNonWritable, "readonly"},
         {spv::DecorationNonReadable, "writeonly"},
         {spv::DecorationRestrict, "restrict"},
         {spv::DecorationCoherent, "coherent"},
         {spv::DecorationVolatile, "volatile"}}};
    std::vector<std::string_view> names;
    for (const auto &[decoration, name] : all) {
      bool is_of_all = block != nullptr && !block->operands.empty();
      for (std::uint32_t i = 0; is_of_all && i < block->operands.size(); i++) {
        is_of_all = find(member_of(*block, i).decorations, decoration) != nullptr;
      }
      if (is_of_all || find(id, decoration) != nullptr) {
        names.push_back(name);
      }
    }
    return names;
  }
  /** The name of a sampler, texture, image or reference. */
  std::string opaque_name(std::uint32_t id) const
  {
    const SpirvType &type = module_.type(id);
    if (type.op == spv::OpTypePointer) {
      return module_.name(type.operands[1]);
    }
    if (type.op == spv::OpTypeAccelerationStructureKHR) {
      return "accelerationStructureEXT";
    }
    const SpirvType &image = type.op == spv::OpTypeSampledImage ? module_.type(type.operands[0]) : type;
    if (image.op != spv::OpTypeImage) {
      return "sampler";
    }
    // Vulkan has samplerBuffer, which needs no sampler, as an image.
    const bool is_combined =
        type.op == spv::OpTypeSampledImage || (image.operands[1] == spv::DimBuffer && image.operands[5] != 2);
    // Words of OpTypeImage: sampled type, dimension, depth, arrayed, multisampled, whether it is sampled: 2 for not.
    static constexpr std::array<std::string_view, 7> dimensions = {"1D", "2D", "3D", "Cube", "2DRect", "Buffer", ""};
    const bool is_input = image.operands[1] == spv::DimSubpassData;
    return fmt::format("{}{}{}{}{}{}", scalar_name(image.operands[0]).second,
                       is_input                 ? "subpassInput"
                       : is_combined            ? "sampler"
                       : image.operands[5] == 2 ? "image"
                                                : "texture",
                       image.operands[1] < dimensions.size() ? dimensions[image.operands[1]] : "",
                       image.operands[4] != 0 ? "MS" : "", image.operands[3] != 0 ? "Array" : "",
                       is_combined && image.operands[2] == 1 ? "Shadow" : "");
  }
  DeclaredType declared_type(std::uint32_t id) const
  {
    DeclaredType result;
    for (; is_array(module_.type(id)); id = module_.type(id).operands[0]) {
      result.array_sizes.push_back(length_of(module_.type(id)));
    }
    const SpirvType &type = module_.type(id);
    const SpirvType &column = type.op == spv::OpTypeMatrix ? module_.type(type.operands[0]) : type;
    const auto [scalar, start] = scalar_name(column.op == spv::OpTypeVector ? column.operands[0] : id);
    result.scalar = scalar;
    if (type.op == spv::OpTypeStruct) {
      result.is_struct = true;
      result.name = module_.name(id);
    }
    else if (type.op == spv::OpTypeMatrix) {
      result.row_count = int(column.operands[1]);
      result.name = fmt::format("{}mat{}x{}", start, type.operands[1], result.row_count);
    }
    else if (type.op == spv::OpTypeVector) {
      result.vector_size = int(type.operands[1]);
      result.name = fmt::format("{}vec{}", start, result.vector_size);
    }
    else {
      result.name = scalar.empty() ? opaque_name(id) : scalar;
    }
    return result;
  }

  int location_count(std::uint32_t id, bool is_vertex_input) const
  {
    const SpirvType &type = module_.type(id);
    if (is_array(type)) {
      return std::max(length_of(type), 1) * location_count(type.operands[0], is_vertex_input);
    }
    switch (type.op) {
      case spv::OpTypeStruct: {
        int count = 0;
        for (const std::uint32_t member : type.operands) {
          count += location_count(member, is_vertex_input);
        }
        return count;
      }
      case spv::OpTypeMatrix: return int(type.operands[1]) * location_count(type.operands[0], is_vertex_input);
      case spv::OpTypeVector:
        return type.operands[1] > 2 && module_.type(type.operands[0]).operands[0] == 64 && !is_vertex_input ? 2 : 1;
      default: return 1;
    }
  }

  /** Size of a member or element of \a id in a block. \a member: its decorations. */
  std::uint32_t size_of(std::uint32_t id, const Decorations &member) const
  {
    const SpirvType &type = module_.type(id);
    switch (type.op) {
      case spv::OpTypeArray: return std::uint32_t(length_of(type) * value_or(find(id, spv::DecorationArrayStride), 0));
      case spv::OpTypeMatrix: {
        const bool is_row_major = find(member, spv::DecorationRowMajor) != nullptr;
        const std::uint32_t count = is_row_major ? module_.type(type.operands[0]).operands[1] : type.operands[1];
        return count * std::uint32_t(value_or(find(member, spv::DecorationMatrixStride), 0));
      }
      case spv::OpTypeStruct: {
        std::uint32_t end = 0;
        for (std::uint32_t i = 0; i < type.operands.size(); i++) {
          const Decorations &decorations = member_of(type, i).decorations;
          end = std::max(end, std::uint32_t(value_or(find(decorations, spv::DecorationOffset), 0)) +
                                  size_of(type.operands[i], decorations));
        }
        return end;
      }
      case spv::OpTypeVector: return type.operands[1] * size_of(type.operands[0], member);
      case spv::OpTypeInt:
      case spv::OpTypeFloat: return type.operands[0] / 8;
      // An address.
      case spv::OpTypePointer: return 8;
      default: return 0;
    }
  }

  /** \a first_byte: where the struct \a id begins in \a block. \a outer: the arrays that it is an element of. */
  void add_members(std::uint32_t id, const std::string &prefix, const std::string &structure, SourcePosition position,
                   std::uint32_t first_byte, const std::vector<ProgramBinding::Array> &outer, Declaration &block)
  {
    const SpirvType &type = module_.type(id);
    for (std::uint32_t i = 0; i < type.operands.size(); i++) {
      const SpirvType::Member &member = member_of(type, i);
      const std::string name = prefix + member.name;
      const std::uint32_t offset_bytes =
          first_byte + std::uint32_t(value_or(find(member.decorations, spv::DecorationOffset), 0));
      std::vector<ProgramBinding::Array> arrays = outer;
      std::string first = name;
      std::uint32_t element = type.operands[i];
      for (; is_array(module_.type(element)); element = module_.type(element).operands[0]) {
        arrays.push_back({std::uint32_t(std::max(length_of(module_.type(element)), 0)),
                          std::uint32_t(value_or(find(element, spv::DecorationArrayStride), 0))});
        first += "[0]";
      }
      if (module_.type(element).op == spv::OpTypeStruct) {
        const std::string inner = module_.name(element);
        add_members(element, first + ".", inner, lines_.find_declaration(inner, "struct"), offset_bytes, arrays, block);
        continue;
      }
      block.members.push_back({name, structure, lines_.find_member(position, member.name),
                               declared_type(type.operands[i]), offset_bytes,
                               size_of(type.operands[i], member.decorations), std::move(arrays),
                               std::uint32_t(value_or(find(member.decorations, spv::DecorationMatrixStride), 0)),
                               find(member.decorations, spv::DecorationRowMajor) != nullptr});
      const bool has_rows = value_or(find(type.operands[i], spv::DecorationArrayStride), 0) == 16;
      check_array(declared_type(type.operands[i]), has_rows, block.members.back(), facts.findings);
    }
  }

  /** Whether the outermost array of an input or output holds the vertices or primitives that the stage works on. */
  bool is_arrayed(std::uint32_t id, bool is_input) const
  {
    switch (stage_) {
      case Stage::TessControl: return find(id, spv::DecorationPatch) == nullptr;
      case Stage::TessEvaluation: return is_input && find(id, spv::DecorationPatch) == nullptr;
      case Stage::Geometry: return is_input;
      case Stage::Mesh: return !is_input;
      case Stage::Fragment: return is_input && find(id, spv::DecorationPerVertexKHR) != nullptr;
      default: return false;
    }
  }

  /** Whether a function uses the member \a index of the block \a variable. */
  bool is_member_used(const SpirvVariable &variable, bool is_array, std::uint32_t index) const
  {
    return std::ranges::any_of(module_.accesses, [&](const std::array<std::uint32_t, 3> &access) {
      const auto value = module_.constants.find(access[is_array ? 2 : 1]);
      return access[0] == variable.id && value != module_.constants.end() && value->second == index;
    });
  }

  /** Adds the members of the struct \a id of an input or output. \a outer: the sizes of the arrays around it. */
  void add_fields(std::uint32_t id, const std::string &prefix, const std::vector<int> &outer,
                  std::vector<BlockMember> &fields) const
  {
    const SpirvType &type = module_.type(id);
    const std::string structure = module_.name(id);
    for (std::uint32_t i = 0; i < type.operands.size(); i++) {
      const std::string &name = member_of(type, i).name;
      BlockMember field{prefix + name, structure,
                        lines_.find_member(lines_.find_declaration(structure, "struct"), name),
                        declared_type(type.operands[i])};
      field.type.array_sizes.insert(field.type.array_sizes.begin(), outer.begin(), outer.end());
      if (field.type.is_struct) {
        add_fields(element_of(type.operands[i]), field.name + ".", field.type.array_sizes, fields);
      }
      else {
        fields.push_back(std::move(field));
      }
    }
  }

  void set_locations(Declaration &declaration, std::uint32_t type, const Decorations &decorations, bool is_input) const
  {
    declaration.type = declared_type(type);
    declaration.location = value_or(find(decorations, spv::DecorationLocation), -1);
    const std::uint32_t element =
        declaration.is_arrayed && is_array(module_.type(type)) ? module_.type(type).operands[0] : type;
    declaration.location_count = std::max(location_count(element, is_input && stage_ == Stage::Vertex), 1);
    const DeclaredType &declared = declaration.type;
    if (location_count(element_of(type), is_input && stage_ == Stage::Vertex) == 1) {
      set_components(declaration, value_or(find(decorations, spv::DecorationComponent), 0));
    }
    declaration.index = value_or(find(decorations, spv::DecorationIndex), 0);
    if (declared.is_struct) {
      std::vector<int> outer = declared.array_sizes;
      outer.erase(outer.begin(), outer.begin() + (declaration.is_arrayed && !outer.empty() ? 1 : 0));
      add_fields(element_of(type), declaration.name + ".", outer, declaration.members);
    }
  }

  void add_varying(const SpirvVariable &variable, std::uint32_t type, Declaration declaration)
  {
    const bool is_input = variable.storage == spv::StorageClassInput;
    declaration.position = lines_.find_declaration(declaration.name, is_input ? "in" : "out");
    declaration.is_arrayed = is_arrayed(variable.id, is_input);
    declaration.is_captured = find(variable.id, spv::DecorationOffset) != nullptr;
    if (is_input && find(variable.id, spv::DecorationPassthroughNV) != nullptr) {
      // GL_NV_geometry_shader_passthrough: the stage writes it as it reads it.
      declaration.is_used = true;
      add_varying(type, declaration, true, facts.outputs, variable);
    }
    add_varying(type, std::move(declaration), is_input, is_input ? facts.inputs : facts.outputs, variable);
  }

  void add_varying(std::uint32_t type, Declaration declaration, bool is_input, std::vector<Declaration> &list,
                   const SpirvVariable &variable)
  {
    const std::uint32_t element = element_of(type);
    const SpirvType &block = module_.type(element);
    static const Decorations none;
    const auto own = module_.decorations.find(variable.id);
    const bool has_locations = std::ranges::any_of(block.members, [](const auto &entry) {
      return find(entry.second.decorations, spv::DecorationLocation) != nullptr;
    });
    const bool is_block = find(element, spv::DecorationBlock) != nullptr;
    int next_location = value_or(find(variable.id, spv::DecorationLocation), -1);
    // The elements of other arrays of blocks have locations of their own.
    const bool is_one = (declaration.is_arrayed ? module_.type(type).operands[0] : type) == element;
    if (!has_locations && !(is_block && is_one && next_location >= 0)) {
      set_locations(declaration, type, own == module_.decorations.end() ? none : own->second, is_input);
      list.push_back(std::move(declaration));
      return;
    }
    declaration.is_block_used = declaration.is_used;
    // A stage that only passes the block through uses all members.
    const bool is_passed = find(variable.id, spv::DecorationPassthroughNV) != nullptr;
    for (std::uint32_t i = 0; i < block.operands.size(); i++) {
      const SpirvType::Member &entry = member_of(block, i);
      Declaration member = declaration;
      member.name += "." + entry.name;
      member.position = lines_.find_member(declaration.position, entry.name);
      member.is_used = is_passed || is_member_used(variable, is_array(module_.type(type)), i);
      member.is_arrayed = false;
      member.is_captured |= find(entry.decorations, spv::DecorationOffset) != nullptr;
      set_locations(member, block.operands[i], entry.decorations, is_input);
      member.location = member.location < 0 ? next_location : member.location;
      next_location = member.location < 0 ? -1 : member.location + member.location_count;
      list.push_back(std::move(member));
    }
  }

  void add(const SpirvVariable &variable)
  {
    const std::uint32_t type = module_.type(variable.type).operands[1];
    const std::uint32_t element = element_of(type);
    const bool is_buffer = find(element, spv::DecorationBufferBlock) != nullptr;
    const bool is_block = is_buffer || find(element, spv::DecorationBlock) != nullptr;
    Declaration declaration;
    declaration.name = module_.name(is_block ? element : variable.id);
    declaration.is_used = module_.used[variable.id];
    declaration.set = value_or(find(variable.id, spv::DecorationDescriptorSet), 0);
    declaration.slot = value_or(find(variable.id, spv::DecorationBinding), -1);
    if (declaration.name.starts_with("gl_") || find(variable.id, spv::DecorationBuiltIn) != nullptr) {
      return;
    }
    switch (variable.storage) {
      case spv::StorageClassInput:
      case spv::StorageClassOutput: add_varying(variable, type, std::move(declaration)); break;
      case spv::StorageClassUniform:
      case spv::StorageClassPushConstant:
        if (is_block) {
          add_block(variable, type, is_buffer, std::move(declaration));
        }
        break;
      case spv::StorageClassStorageBuffer:
      case spv::StorageClassShaderRecordBufferKHR: add_block(variable, type, true, std::move(declaration)); break;
      case spv::StorageClassUniformConstant:
      case spv::StorageClassAtomicCounter: add_texture(variable, type, std::move(declaration)); break;
      default: break;
    }
  }

  void add_block(const SpirvVariable &variable, std::uint32_t type, bool is_buffer, Declaration declaration)
  {
    const std::uint32_t element = element_of(type);
    declaration.type = declared_type(type);
    declaration.position = lines_.find_declaration(declaration.name, is_buffer ? "buffer" : "uniform");
    declaration.is_push_constant =
        variable.storage == spv::StorageClassPushConstant || declaration.name == gpu::push_constant_block_name;
    declaration.size_bytes = size_of(element, {});
    declaration.qualifiers = is_buffer ? qualifiers(variable.id, &module_.type(element)) : declaration.qualifiers;
    add_members(element, "", "", declaration.position, 0, {}, declaration);
    (is_buffer ? facts.storage_blocks : facts.uniform_blocks).push_back(std::move(declaration));
  }

  /**
   * Adds a uniform outside of blocks, of structs each member, as OpenGL names them. Of an array of structs, the first
   * element stands for all. \return the number of its locations
   */
  std::uint32_t add_uniform(std::uint32_t type, const std::string &name, int location, const Declaration &declaration)
  {
    std::uint32_t element_count = 1;
    std::string first = name;
    std::uint32_t element = type;
    for (; is_array(module_.type(element)); element = module_.type(element).operands[0]) {
      element_count *= std::uint32_t(std::max(length_of(module_.type(element)), 1));
      first += "[0]";
    }
    const SpirvType &structure = module_.type(element);
    if (structure.op != spv::OpTypeStruct) {
      Declaration &uniform = facts.uniforms.emplace_back(declaration);
      uniform.name = name;
      uniform.type = declared_type(type);
      uniform.location = location;
      return element_count;
    }
    std::uint32_t member_count = 0;
    for (std::uint32_t i = 0; i < structure.operands.size(); i++) {
      member_count += add_uniform(structure.operands[i], first + "." + member_of(structure, i).name,
                                  location < 0 ? -1 : int(std::uint32_t(location) + member_count), declaration);
    }
    return element_count * member_count;
  }

  void add_texture(const SpirvVariable &variable, std::uint32_t type, Declaration declaration)
  {
    declaration.type = declared_type(type);
    const SpirvType &element = module_.type(element_of(type));
    declaration.is_image =
        element.op == spv::OpTypeImage && element.operands[5] == 2 && element.operands[1] != spv::DimSubpassData;
    const bool is_atomic = element.op == spv::OpTypeInt && declaration.slot >= 0;
    if (!is_atomic && (declaration.type.is_struct || !declaration.type.scalar.empty())) {
      add_uniform(type, declaration.name, value_or(find(variable.id, spv::DecorationLocation), -1), declaration);
      return;
    }
    declaration.position = lines_.find_declaration(declaration.name, "uniform");
    declaration.attachment = value_or(find(variable.id, spv::DecorationInputAttachmentIndex), -1);
    if (is_atomic) {
      declaration.type.name = "atomic_uint";
      declaration.offset_bytes = std::uint32_t(value_or(find(variable.id, spv::DecorationOffset), 0));
    }
    if (declaration.is_image) {
      declaration.format = format_name(element.operands[6]);
      declaration.qualifiers = qualifiers(variable.id, nullptr);
    }
    facts.textures.push_back(std::move(declaration));
  }

  void add(const SpirvModule::SpecConstant &constant)
  {
    const std::uint32_t *id = find(constant.id, spv::DecorationSpecId);
    if (id == nullptr) {
      return;
    }
    ProgramConstant added{module_.name(constant.id), scalar_name(constant.type).first, *id, {}};
    const SpirvType &type = module_.type(constant.type);
    const std::uint32_t bits = type.operands.empty() ? 0U : type.operands[0];
    if (type.op == spv::OpTypeBool) {
      added.value = constant.bits != 0;
    }
    else if (type.op == spv::OpTypeFloat) {
      added.value = bits == 64   ? std::bit_cast<double>(constant.bits)
                    : bits == 32 ? double(std::bit_cast<float>(std::uint32_t(constant.bits)))
                                 : double(glm::unpackHalf1x16(std::uint16_t(constant.bits)));
    }
    else if (type.operands[1] == 0) {
      added.value = constant.bits;
    }
    else {
      // Words hold narrow values with their signs.
      added.value = bits == 64 ? std::int64_t(constant.bits) : std::int64_t(std::int32_t(constant.bits));
    }
    if (std::ranges::find(facts.constants, added) == facts.constants.end()) {
      facts.constants.push_back(std::move(added));
    }
  }

  void set_workgroup()
  {
    if (module_.local_size.size() != 3) {
      return;
    }
    // Before SPIR-V 1.6 the built-in vector has the ids.
    std::vector<std::uint32_t> ids = module_.has_local_size_ids ? module_.local_size : std::vector<std::uint32_t>(3);
    for (const auto &[id, parts] : module_.constituents) {
      const std::uint32_t *built_in = find(id, spv::DecorationBuiltIn);
      if (built_in != nullptr && *built_in == spv::BuiltInWorkgroupSize) {
        ids = parts;
      }
    }
    facts.workgroup = Workgroup{stage_};
    for (std::size_t i = 0; i < 3; i++) {
      const auto value = module_.constants.find(ids.at(i));
      facts.workgroup->size[i] = value == module_.constants.end() ? module_.local_size[i] : value->second;
      facts.workgroup->constant_ids[i] = value_or(find(ids[i], spv::DecorationSpecId), -1);
    }
  }

  const SpirvModule &module_;
  Stage stage_;
  const SourceLines &lines_;
};

}  // namespace

StageFacts read_spirv(std::span<const std::uint32_t> spirv, Stage stage, const SourceLines &lines)
{
  const SpirvModule module(spirv);
  return std::move(SpirvReader(module, stage, lines).facts);
}

}  // namespace gnomon::shader_check
