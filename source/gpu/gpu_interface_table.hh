// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::gpu {

/**
 * The interfaces of all variants of one program, as constant data that the build generates
 * (shader_check_interfaces.hh), so that a host needs no shader compiler but the driver's.
 *
 * The variants share one list of bindings: a name has one slot and one layout in all of them. A variant reads a part of
 * the list. The part is exact, because binding a name that a variant does not read must do nothing.
 */
struct InterfaceTable {
  /** As ShaderInterface::Member. */
  struct Member {
    std::string_view name;
    std::uint32_t offset_bytes;
    std::uint32_t size_bytes;
  };
  /** As ShaderInterface::Binding. */
  struct Binding {
    std::string_view name;
    BindingKind kind;
    int slot;
    std::uint32_t size_bytes;
    std::span<const Member> members;
    /** Of all variants. */
    std::uint32_t stages = 0;
  };
  struct Variant {
    /** Chosen by the engine: its features as bits. */
    std::uint32_t key;
    /** Bit i is set: the variant reads bindings[i]. */
    std::uint64_t bindings;
    bool has_push_constants;
  };

  /** ShaderDesc::name of all variants. */
  std::string_view name;
  /** Of all variants; sorted by kind, then slot; at most 64. */
  std::span<const Binding> bindings;
  std::span<const Member> push_constant_members;
  std::uint32_t push_constant_size_bytes;
  int push_constant_slot;
  std::span<const Variant> variants;

  /** \throws Error if no variant has the key. */
  [[nodiscard]] ShaderInterface interface_of(std::uint32_t key) const;
};

}  // namespace gnomon::gpu
