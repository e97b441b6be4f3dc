// SPDX-License-Identifier: MIT
#include "shader_check_interfaces.hh"

#include "shader_check_reflection.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace gnomon::shader_check {

namespace {

using Binding = gpu::ShaderInterface::Binding;
using Members = std::vector<gpu::ShaderInterface::Member>;

std::string variant_name(const gpu::ShaderDesc &desc)
{
  return desc.defines.empty() ? "without defines" : fmt::format("'{}'", fmt::join(desc.defines, " "));
}

/** Merges the interfaces of one program's variants. */
class Merger {
 public:
  explicit Merger(std::string name) : name_(std::move(name)) {}

  void add(const TableEntry &entry, const gpu::ShaderInterface &interface)
  {
    for (const Binding &binding : interface.bindings) {
      add_binding(entry.desc, binding);
    }
    if (interface.push_constant_size_bytes > 0) {
      add_push_constants(entry.desc, interface);
    }
    variants_.push_back({&entry, interface});
  }

  VariantInterfaces result()
  {
    VariantInterfaces result;
    result.name = name_;
    result.all.push_constant_members = push_constants_.push_constant_members;
    result.all.push_constant_size_bytes = push_constants_.push_constant_size_bytes;
    result.all.push_constant_slot = push_constants_.push_constant_slot;
    for (const Known &known : known_) {
      result.all.bindings.push_back(known.binding);
    }
    std::ranges::sort(result.all.bindings, [](const Binding &a, const Binding &b) {
      return std::tie(a.kind, a.slot) < std::tie(b.kind, b.slot);
    });
    if (result.all.bindings.size() > 64) {
      throw gpu::Error("shader '{}': its variants read {} names, and a table takes 64", name_, known_.size());
    }
    std::map<std::uint32_t, const TableEntry *> first_of_key;
    for (const auto &[entry, interface] : variants_) {
      const gpu::InterfaceTable::Variant variant = variant_of(entry->key, interface, result.all);
      const auto [first, is_new] = first_of_key.try_emplace(entry->key, entry);
      if (is_new) {
        result.variants.push_back(variant);
        continue;
      }
      const auto &same = *std::ranges::find(result.variants, entry->key, &gpu::InterfaceTable::Variant::key);
      if (same != variant) {
        throw gpu::Error("shader '{}': variants {} and {} share key {:#x} and read different names", name_,
                         variant_name(first->second->desc), variant_name(entry->desc), entry->key);
      }
    }
    return result;
  }

 private:
  struct Known {
    Binding binding;
    const gpu::ShaderDesc *desc;
  };

  void add_binding(const gpu::ShaderDesc &desc, const Binding &binding)
  {
    for (Known &known : known_) {
      const bool is_same_name = known.binding.kind == binding.kind && known.binding.name == binding.name;
      if (is_same_name && known.binding == binding) {
        known.binding.stages |= binding.stages;
        return;
      }
      if (is_same_name) {
        const bool is_same_slot = known.binding.slot == binding.slot;
        throw gpu::Error("shader '{}': {} '{}' has {} in variant {} and {} in variant {}", name_,
                         to_string(binding.kind), binding.name,
                         is_same_slot ? fmt::format("{} bytes", known.binding.size_bytes)
                                      : fmt::format("slot {}", known.binding.slot),
                         variant_name(*known.desc),
                         is_same_slot ? fmt::format("{} bytes or other members", binding.size_bytes)
                                      : fmt::format("slot {}", binding.slot),
                         variant_name(desc));
      }
      if (known.binding.slot == binding.slot) {
        throw gpu::Error("shader '{}': slot {} is {} '{}' in variant {} and {} '{}' in variant {}", name_, binding.slot,
                         to_string(known.binding.kind), known.binding.name, variant_name(*known.desc),
                         to_string(binding.kind), binding.name, variant_name(desc));
      }
    }
    known_.push_back({binding, &desc});
  }

  void add_push_constants(const gpu::ShaderDesc &desc, const gpu::ShaderInterface &interface)
  {
    if (push_constants_desc_ == nullptr) {
      push_constants_ = interface;
      push_constants_desc_ = &desc;
    }
    else if (std::tie(push_constants_.push_constant_members, push_constants_.push_constant_size_bytes,
                      push_constants_.push_constant_slot) != std::tie(interface.push_constant_members,
                                                                      interface.push_constant_size_bytes,
                                                                      interface.push_constant_slot)) {
      throw gpu::Error("shader '{}': the push constants of variants {} and {} differ in slot or layout", name_,
                       variant_name(*push_constants_desc_), variant_name(desc));
    }
  }

  static gpu::InterfaceTable::Variant variant_of(std::uint32_t key, const gpu::ShaderInterface &interface,
                                                 const gpu::ShaderInterface &all)
  {
    std::uint64_t bindings = 0;
    for (std::size_t i = 0; i < all.bindings.size(); i++) {
      const bool is_read = interface.find(all.bindings[i].kind, all.bindings[i].name) != nullptr;
      bindings |= std::uint64_t(is_read) << i;
    }
    return {key, bindings, interface.push_constant_size_bytes > 0, interface.reads_object, interface.varying_locations};
  }

  std::string name_;
  std::vector<Known> known_;
  gpu::ShaderInterface push_constants_;
  const gpu::ShaderDesc *push_constants_desc_ = nullptr;
  std::vector<std::pair<const TableEntry *, gpu::ShaderInterface>> variants_;
};

/** Writes each list of members once: many programs read the same blocks. */
class MemberArrays {
 public:
  /** The expression for \a members as a span. */
  std::string name_of(const Members &members)
  {
    if (members.empty()) {
      return "{}";
    }
    auto found = std::ranges::find(lists_, members);
    if (found == lists_.end()) {
      const std::size_t index = lists_.size();
      found = lists_.insert(lists_.end(), members);
      text_ += fmt::format("constexpr InterfaceTable::Member members_{}[] = {{\n", index);
      for (const gpu::ShaderInterface::Member &member : members) {
        text_ += fmt::format("    {{\"{}\", {}, {}}},\n", member.name, member.offset_bytes, member.size_bytes);
      }
      text_ += "};\n";
    }
    return fmt::format("members_{}", found - lists_.begin());
  }
  [[nodiscard]] const std::string &text() const
  {
    return text_;
  }

 private:
  std::vector<Members> lists_;
  std::string text_;
};

std::string_view kind_source(gpu::BindingKind kind)
{
  switch (kind) {
    case gpu::BindingKind::UniformBlock: return "BindingKind::UniformBlock";
    case gpu::BindingKind::StorageBlock: return "BindingKind::StorageBlock";
    case gpu::BindingKind::Texture: break;
  }
  return "BindingKind::Texture";
}

}  // namespace

std::vector<VariantInterfaces> variant_interfaces(std::span<const TableEntry> entries, const gpu::ShaderFiles &files)
{
  std::vector<std::pair<std::string, Merger>> mergers;
  for (const TableEntry &entry : entries) {
    auto merger = std::ranges::find(mergers, entry.desc.name, &std::pair<std::string, Merger>::first);
    if (merger == mergers.end()) {
      merger = mergers.insert(mergers.end(), {entry.desc.name, Merger(entry.desc.name)});
    }
    merger->second.add(entry, reflect(entry.desc.name, gpu::preprocess(entry.desc, files)));
  }
  std::vector<VariantInterfaces> programs;
  for (auto &[name, merger] : mergers) {
    programs.push_back(merger.result());
  }
  return programs;
}

std::string table_source(std::span<const VariantInterfaces> programs, std::string_view header,
                         std::string_view function)
{
  MemberArrays members;
  std::string arrays;
  std::string tables;
  for (std::size_t i = 0; i < programs.size(); i++) {
    const VariantInterfaces &program = programs[i];
    if (!program.all.bindings.empty()) {
      arrays += fmt::format("constexpr InterfaceTable::Binding bindings_{}[] = {{\n", i);
      for (const Binding &binding : program.all.bindings) {
        arrays += fmt::format("    {{\"{}\", {}, {}, {}, {}, {}}},\n", binding.name, kind_source(binding.kind),
                              binding.slot, binding.size_bytes, members.name_of(binding.members), binding.stages);
      }
      arrays += "};\n";
    }
    arrays += fmt::format("constexpr InterfaceTable::Variant variants_{}[] = {{\n", i);
    for (const gpu::InterfaceTable::Variant &variant : program.variants) {
      arrays += fmt::format("    {{{:#x}, {:#x}, {}, {}, {}}},\n", variant.key, variant.bindings,
                            variant.has_push_constants, variant.reads_object, variant.varying_locations);
    }
    arrays += "};\n";
    tables += fmt::format("    {{\"{}\", {}, {}, {}, {}, variants_{}}},\n", program.name,
                          program.all.bindings.empty() ? "{}" : fmt::format("bindings_{}", i),
                          members.name_of(program.all.push_constant_members), program.all.push_constant_size_bytes,
                          program.all.push_constant_slot, i);
  }
  return fmt::format(R"(// Generated by the build: shader_check_interfaces.hh.
#include "{}"

namespace {{

using gnomon::gpu::BindingKind;
using gnomon::gpu::InterfaceTable;

{}
{}
constexpr InterfaceTable tables[] = {{
{}}};

}}  // namespace

std::span<const InterfaceTable> {}()
{{
  return tables;
}}
)",
                     header, members.text(), arrays, tables, function);
}

}  // namespace gnomon::shader_check
