// SPDX-License-Identifier: MIT
#include "gpu_interface_table.hh"

#include <algorithm>

namespace gnomon::gpu {

namespace {

std::vector<ShaderInterface::Member> copy_of(std::span<const InterfaceTable::Member> members)
{
  std::vector<ShaderInterface::Member> copies;
  for (const InterfaceTable::Member &member : members) {
    copies.push_back({std::string(member.name), member.offset_bytes, member.size_bytes});
  }
  return copies;
}

}  // namespace

ShaderInterface InterfaceTable::interface_of(std::uint32_t key) const
{
  const auto variant = std::ranges::find(variants, key, &Variant::key);
  if (variant == variants.end()) {
    throw Error("shader '{}': the generated table holds no interface for the variant with features {:#x}", name, key);
  }
  ShaderInterface interface;
  interface.reads_object = variant->reads_object;
  interface.varying_locations = variant->varying_locations;
  for (std::size_t i = 0; i < bindings.size(); i++) {
    if ((variant->bindings >> i & 1U) != 0) {
      const Binding &binding = bindings[i];
      interface.bindings.push_back({std::string(binding.name), binding.kind, binding.slot, binding.size_bytes,
                                    copy_of(binding.members), binding.stages});
    }
  }
  if (variant->has_push_constants) {
    interface.push_constant_members = copy_of(push_constant_members);
    interface.push_constant_size_bytes = push_constant_size_bytes;
    interface.push_constant_slot = push_constant_slot;
  }
  return interface;
}

}  // namespace gnomon::gpu
