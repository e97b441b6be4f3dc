// SPDX-License-Identifier: MIT
#include "vulkan_shaders.hh"

#include <algorithm>
#include <map>

namespace gnomon::gpu {

namespace {

// Numbers of the SPIR-V specification. They are too few to depend on Debian's package of its headers.
constexpr std::uint32_t spirv_magic = 0x07230203;
constexpr std::size_t spirv_header_words = 5;
enum class Op : std::uint32_t {
  TypeMatrix = 24,
  TypeImage = 25,
  TypeSampledImage = 27,
  TypePointer = 32,
  Variable = 59,
  Decorate = 71,
};
enum class Decoration : std::uint32_t { Location = 30, Binding = 33 };
enum class StorageClass : std::uint32_t { UniformConstant = 0, Input = 1, Uniform = 2, StorageBuffer = 12 };
constexpr std::uint32_t dim_buffer = 5;

struct SpirvImage {
  bool is_buffer = false;
  bool is_array = false;
  bool is_comparison = false;
};

/** Declarations of one stage that its interface needs, by id. */
struct SpirvModule {
  struct Variable {
    std::uint32_t type = 0;
    StorageClass storage = StorageClass::Input;
  };
  std::map<std::uint32_t, std::uint32_t> slots;
  std::map<std::uint32_t, std::uint32_t> locations;
  std::map<std::uint32_t, SpirvImage> images;
  /** By the type of a pointer, the type that it points to. */
  std::map<std::uint32_t, std::uint32_t> pointers;
  /** Locations that a type takes, if they are more than one. */
  std::map<std::uint32_t, std::uint32_t> columns;
  std::map<std::uint32_t, Variable> variables;
};

SpirvModule module_of(const std::vector<std::uint32_t> &words)
{
  SpirvModule module;
  for (std::size_t i = spirv_header_words; i < words.size();) {
    const std::size_t count = std::max<std::size_t>(words[i] >> 16U, 1);
    // The operands, without the word of the operation.
    const std::span<const std::uint32_t> to = std::span(words).subspan(i + 1, std::min(count, words.size() - i) - 1);
    switch (Op(words[i] & 0xFFFFU)) {
      case Op::TypeMatrix: module.columns[to[0]] = to[2]; break;
      case Op::TypeImage:
        module.images[to[0]] = {.is_buffer = to[2] == dim_buffer, .is_array = to[4] == 1, .is_comparison = to[3] == 1};
        break;
      case Op::TypeSampledImage: module.images[to[0]] = module.images[to[1]]; break;
      case Op::TypePointer: module.pointers[to[0]] = to[2]; break;
      case Op::Variable: module.variables[to[1]] = {to[0], StorageClass(to[2])}; break;
      case Op::Decorate:
        if (Decoration(to[1]) == Decoration::Binding) {
          module.slots[to[0]] = to[2];
        }
        else if (Decoration(to[1]) == Decoration::Location) {
          module.locations[to[0]] = to[2];
        }
        break;
    }
    i += count;
  }
  return module;
}

VulkanBinding binding_of(const SpirvModule &module, std::uint32_t slot, const SpirvModule::Variable &variable)
{
  VulkanBinding binding{.slot = slot};
  const auto image = module.images.find(module.pointers.at(variable.type));
  if (image != module.images.end()) {
    binding.type =
        image->second.is_buffer ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    binding.is_array = image->second.is_array;
    binding.is_comparison = image->second.is_comparison;
  }
  else if (variable.storage == StorageClass::StorageBuffer) {
    binding.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  }
  return binding;
}

}  // namespace

VkShaderStageFlagBits vulkan_stage(ShaderStage stage)
{
  switch (stage) {
    case ShaderStage::Vertex: return VK_SHADER_STAGE_VERTEX_BIT;
    case ShaderStage::Geometry: return VK_SHADER_STAGE_GEOMETRY_BIT;
    case ShaderStage::Fragment: return VK_SHADER_STAGE_FRAGMENT_BIT;
  }
  return VK_SHADER_STAGE_VERTEX_BIT;
}

SpirvInterface interface_of(std::string_view name, const std::vector<SpirvStage> &stages)
{
  SpirvInterface interface;
  for (const SpirvStage &stage : stages) {
    const SpirvModule module = module_of(stage.words);
    for (const auto &[id, slot] : module.slots) {
      const auto variable = module.variables.find(id);
      if (variable == module.variables.end()) {
        continue;
      }
      VulkanBinding binding = binding_of(module, slot, variable->second);
      const auto known = std::ranges::find(interface.bindings, slot, &VulkanBinding::slot);
      if (known == interface.bindings.end()) {
        binding.stages = vulkan_stage(stage.stage);
        interface.bindings.push_back(binding);
      }
      else if (known->type != binding.type || known->is_array != binding.is_array) {
        throw Error("shader '{}': slot {} has two kinds of bindings", name, slot);
      }
      else {
        known->stages |= vulkan_stage(stage.stage);
      }
    }
    for (const auto &[id, location] : module.locations) {
      const auto variable = module.variables.find(id);
      if (stage.stage == ShaderStage::Vertex && variable != module.variables.end() &&
          variable->second.storage == StorageClass::Input) {
        const auto columns = module.columns.find(module.pointers.at(variable->second.type));
        const std::uint32_t count = columns == module.columns.end() ? 1 : columns->second;
        interface.vertex_inputs |= ((1U << count) - 1U) << location;
      }
    }
  }
  std::ranges::sort(interface.bindings, {}, &VulkanBinding::slot);
  return interface;
}

std::vector<std::byte> packed(const std::vector<SpirvStage> &stages)
{
  std::vector<std::uint32_t> words;
  for (const SpirvStage &stage : stages) {
    words.push_back(std::uint32_t(stage.stage));
    words.push_back(std::uint32_t(stage.words.size()));
    words.insert(words.end(), stage.words.begin(), stage.words.end());
  }
  const auto bytes = std::as_bytes(std::span(words));
  return {bytes.begin(), bytes.end()};
}

std::vector<SpirvStage> unpacked(const std::vector<std::byte> &bytes)
{
  std::vector<std::uint32_t> words(bytes.size() / sizeof(std::uint32_t));
  // memcpy() does not take the null pointers of empty lists.
  std::ranges::copy(std::span(bytes).first(words.size() * sizeof(std::uint32_t)),
                    std::as_writable_bytes(std::span(words)).begin());
  std::vector<SpirvStage> stages;
  for (std::size_t i = 0; i < words.size();) {
    if (i + 2 + spirv_header_words > words.size() || words[i] > std::uint32_t(ShaderStage::Fragment) ||
        words[i + 1] > words.size() - i - 2 || words[i + 2] != spirv_magic) {
      return {};
    }
    const auto first = words.begin() + std::ptrdiff_t(i) + 2;
    stages.push_back({ShaderStage(words[i]), {first, first + words[i + 1]}});
    i += 2 + words[i + 1];
  }
  return stages;
}

}  // namespace gnomon::gpu
