// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::gpu {

/**
 * The interfaces of all variants of one program. The build generates them as constant data
 * (shader_check_interfaces.hh), so a host needs no shader compiler other than the driver's.
 *
 * All variants share one list of bindings: a name has the same slot and layout in each of them. Each variant lists
 * exactly the bindings that it reads, because binding any other name must have no effect.
 */
struct InterfaceTable {
  /** The same as ShaderInterface::Member. */
  struct Member {
    std::string_view name;
    std::uint32_t offset_bytes;
    std::uint32_t size_bytes;
  };
  /** The same as ShaderInterface::Binding. */
  struct Binding {
    std::string_view name;
    BindingKind kind;
    int slot;
    std::uint32_t size_bytes;
    std::span<const Member> members;
    /** Mask of the stages that read the binding in any variant. */
    std::uint32_t stages = 0;
  };
  struct Variant {
    /** Identifies the variant; the engine's feature bits. */
    std::uint32_t key;
    /** Mask: bit i is set if the variant reads bindings[i]. */
    std::uint64_t bindings;
    bool has_push_constants;
    /** The same as ShaderInterface::reads_object. */
    bool reads_object;
    /** The same as ShaderInterface::varying_locations. */
    int varying_locations;

    bool operator==(const Variant &) const = default;
  };

  /** ShaderDesc::name of all variants. */
  std::string_view name;
  /** Bindings of all variants, sorted by kind and then by slot; at most 64. */
  std::span<const Binding> bindings;
  std::span<const Member> push_constant_members;
  std::uint32_t push_constant_size_bytes;
  int push_constant_slot;
  std::span<const Variant> variants;

  /** Interface of the variant with \a key. \throws Error if it does not exist */
  [[nodiscard]] ShaderInterface interface_of(std::uint32_t key) const;
};

}  // namespace gnomon::gpu
