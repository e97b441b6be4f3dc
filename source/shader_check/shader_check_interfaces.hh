// SPDX-License-Identifier: MIT
// Writes the interfaces of an engine's programs as C++ source. A tool of the build calls these functions.
#pragma once

#include "gpu_interface_table.hh"

namespace gnomon::shader_check {

/** One program for a table. */
struct TableEntry {
  /** gpu::InterfaceTable::Variant::key. Entries of one name and key must have equal interfaces. */
  std::uint32_t key;
  /** Entries of one name are variants of one program. */
  gpu::ShaderDesc desc;
};

/** The interfaces of all variants of one program, as in gpu::InterfaceTable. */
struct VariantInterfaces {
  std::string name;
  /** Union of the bindings and push constants of all variants. */
  gpu::ShaderInterface all;
  std::vector<gpu::InterfaceTable::Variant> variants;
};

/**
 * Reflects all entries. The result is in the order in which names and keys first occur.
 *
 * \throws gpu::Error that names the program and its variants: if a variant does not compile; if variants of one program
 * disagree about the slot or layout of a name, or use one slot for two names; if two entries with the same key read
 * different names.
 */
[[nodiscard]] std::vector<VariantInterfaces> variant_interfaces(std::span<const TableEntry> entries,
                                                                const gpu::ShaderFiles &files);

/** C++ source that defines `std::span<const gnomon::gpu::InterfaceTable> FUNCTION()`, which \a header declares. */
[[nodiscard]] std::string table_source(std::span<const VariantInterfaces> programs, std::string_view header,
                                       std::string_view function);

}  // namespace gnomon::shader_check
