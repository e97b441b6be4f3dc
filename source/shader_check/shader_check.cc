// SPDX-License-Identifier: MIT
#include "shader_check.hh"

#include "internal/shader_check_block.hh"
#include "internal/shader_check_log.hh"
#include "internal/shader_check_tree.hh"
#include "shared_types.h"

#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/libspirv.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace gnomon::shader_check {

std::string_view to_string(CheckTarget target)
{
  return target == CheckTarget::OpenGl ? "OpenGL 4.5" : "Vulkan 1.2";
}

std::string_view to_string(Severity severity)
{
  return severity == Severity::Error ? "error" : "warning";
}

namespace {

/** Above this size a uniform block is an error, although some devices support more. */
constexpr std::uint32_t uniform_block_bytes_limit = 65536;

constexpr std::array<CheckRule, 16> rules = {{
    {"include", "included files and the files of stages exist"},
    {"compile", "glslang accepts the stage"},
    {"link", "glslang accepts the stages together"},
    {"spirv", "SPIRV-Tools accepts glslang's output for the stage"},
    {"slot", "each block and texture has a slot of its own, the same in each stage"},
    {"missing-varying", "each input of a stage is an output of the previous stage"},
    {"varying-type", "an input has the type of the previous stage's output"},
    {"layout", "a block has the same layout in C++ and GLSL"},
    {"block-array", "an array in a block has elements that fill rows of 16 bytes"},
    {"block-size", "a uniform block is within the limit that all devices support"},
    {"recursion", "no function calls itself"},
    {"unused-binding", "each declared block or texture is read"},
    {"unread-output", "an output is read by the next stage"},
    {"implicit-conversion", "a member of a block is converted only explicitly"},
    {"unbounded-loop", "a value that the loop steps bounds the loop"},
    {"unguarded-math", "the argument of a function with a limited domain is guarded"},
}};

class Checker {
 public:
  Checker(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files, const CheckOptions &options)
      : desc_(desc), files_(files), options_(options)
  {
    for (const std::string &define : desc.defines) {
      variant_ += (variant_.empty() ? "" : " ") + define;
    }
  }

  std::vector<CheckMessage> run()
  {
    if (preprocess_stages() && compile_stages()) {
      link_stages();
    }
    std::ranges::stable_sort(messages_, [](const CheckMessage &a, const CheckMessage &b) {
      return std::tie(a.file, a.line, a.text) < std::tie(b.file, b.line, b.text);
    });
    // A header that is part of several stages gives the same message several times.
    messages_.erase(std::unique(messages_.begin(), messages_.end()), messages_.end());
    return std::move(messages_);
  }

 private:
  void add(Severity severity, std::string_view rule, std::string file, int line, std::string_view text)
  {
    messages_.push_back({severity, std::move(file), line, bounded(text), rule, desc_.name, variant_, options_.target});
  }
  void add(Severity severity, std::string_view rule, std::size_t stage, SourcePosition position, std::string_view text)
  {
    add(severity, rule, c_.file(stage, position), position.line, text);
  }
  bool has_errors() const
  {
    return std::ranges::any_of(messages_, [](const CheckMessage &m) { return m.severity == Severity::Error; });
  }

  bool preprocess_stages()
  {
    try {
      c_.sources = gpu::preprocess(desc_, files_, options_.include_path);
    }
    catch (const gpu::SourceError &error) {
      add(Severity::Error, "include", error.file, error.line, error.text);
      return false;
    }
    catch (const gpu::Error &error) {
      const std::string &file = !desc_.vertex_path.empty()     ? desc_.vertex_path
                                : !desc_.geometry_path.empty() ? desc_.geometry_path
                                                               : desc_.fragment_path;
      add(Severity::Error, "include", file, 1, error.what());
      return false;
    }
    for (const gpu::ShaderSource &source : c_.sources) {
      c_.lines.emplace_back(source);
    }
    return true;
  }

  bool compile_stages()
  {
    const GlslangTarget target =
        options_.target == CheckTarget::OpenGl ? GlslangTarget::OpenGlSpirv : GlslangTarget::VulkanSpirv;
    bool is_done = true;
    for (std::size_t i = 0; i < c_.sources.size(); i++) {
      const bool is_compiled = c_.glslang.add(c_.sources[i], target);
      for (const CompileMessage &message : compile_messages(c_.glslang.log())) {
        add(message.severity, "compile", i, message.position, message.text);
      }
      if (!is_compiled && !has_errors()) {
        add(Severity::Error, "compile", i, {}, std::string(c_.glslang.log()));
      }
      is_done &= is_compiled;
    }
    return is_done;
  }

  void link_stages()
  {
    const bool is_linked = c_.glslang.link();
    const std::string log(c_.glslang.log());
    c_.read_facts();
    check_findings();
    check_slots();
    check_varyings();
    // glslang's link errors have no line. They are reported only if our own checks, whose messages have lines, found no
    // mistake.
    if (!is_linked && !has_errors()) {
      const std::size_t stage = c_.sources.size() - 1;
      for (const LinkMessage &message : link_messages(log)) {
        add(Severity::Error, "link", stage,
            message.name.empty() ? SourcePosition() : c_.lines[stage].find_declaration(message.name, "uniform"),
            message.text);
      }
    }
    if (!is_linked) {
      return;
    }
    check_unused_bindings();
    check_blocks();
    check_spirv();
  }

  void check_findings()
  {
    for (std::size_t i = 0; i < c_.facts.size(); i++) {
      for (const StageFinding &finding : c_.facts[i].findings) {
        add(finding.is_error ? Severity::Error : Severity::Warning, finding.rule, i, finding.position, finding.text);
      }
    }
  }

  void check_slots()
  {
    struct Slot {
      gpu::BindingKind kind;
      const Declaration *declaration;
    };
    std::vector<Slot> known;
    const auto take = [&](std::size_t stage, gpu::BindingKind kind, const Declaration &declaration) {
      const bool is_push_constant = declaration.name == gpu::push_constant_block_name && declaration.slot < 0;
      if (declaration.slot < 0 && !is_push_constant) {
        add(Severity::Error, "slot", stage, declaration.position,
            fmt::format("{} '{}' has no layout(binding = …)", to_string(kind), declaration.name));
      }
      for (const Slot &other : known) {
        // OpenGL has separate slots for each kind of resource, Vulkan one set for all.
        const bool is_same_space = kind == other.kind || options_.target == CheckTarget::Vulkan;
        const bool is_same_slot = declaration.slot >= 0 && declaration.slot == other.declaration->slot &&
                                  declaration.set == other.declaration->set;
        if (declaration.name == other.declaration->name && kind == other.kind) {
          if (!is_same_slot && !is_push_constant) {
            add(Severity::Error, "slot", stage, declaration.position,
                fmt::format("{} '{}' has slot {} here and {} in an earlier stage", to_string(kind), declaration.name,
                            declaration.slot, other.declaration->slot));
          }
          return;
        }
        if (is_same_slot && is_same_space) {
          add(Severity::Error, "slot", stage, declaration.position,
              fmt::format("{} '{}' has slot {}, as {} '{}' has", to_string(kind), declaration.name, declaration.slot,
                          to_string(other.kind), other.declaration->name));
        }
      }
      known.push_back({kind, &declaration});
    };
    for (std::size_t i = 0; i < c_.facts.size(); i++) {
      for (const Declaration &block : c_.facts[i].uniform_blocks) {
        take(i, gpu::BindingKind::UniformBlock, block);
      }
      for (const Declaration &block : c_.facts[i].storage_blocks) {
        take(i, gpu::BindingKind::StorageBlock, block);
      }
      for (const Declaration &texture : c_.facts[i].textures) {
        take(i, gpu::BindingKind::Texture, texture);
      }
    }
  }

  /** Whether an output and an input are connected: by location if they have one, otherwise by name. */
  static bool match(const Declaration &output, const Declaration &input)
  {
    if (output.location < 0 || input.location < 0) {
      return output.name == input.name;
    }
    return output.location < input.location + input.location_count &&
           input.location < output.location + output.location_count;
  }

  void check_varyings()
  {
    for (std::size_t i = 1; i < c_.facts.size(); i++) {
      const bool is_arrayed = c_.sources[i].stage == gpu::ShaderStage::Geometry;
      const std::string_view before = to_string(c_.sources[i - 1].stage);
      const std::vector<Declaration> &outputs = c_.facts[i - 1].outputs;
      for (const Declaration &input : c_.facts[i].inputs) {
        const auto output = std::ranges::find_if(outputs, [&](const Declaration &o) { return match(o, input); });
        if (output == outputs.end()) {
          if (input.is_used) {
            add(Severity::Error, "missing-varying", i, input.position,
                fmt::format("input '{}', location {}, is no output of the {} stage", input.name, input.location,
                            before));
          }
          continue;
        }
        const std::string written = type_name(*output->type);
        const std::string read = type_name(*input.type, is_arrayed);
        if (output->location == input.location && written != read && !input.type->isStruct()) {
          add(Severity::Error, "varying-type", i, input.position,
              fmt::format("input '{}', location {}, is {}, and the {} stage writes {}", input.name, input.location,
                          read, before, written));
        }
      }
      for (const Declaration &output : outputs) {
        if (std::ranges::none_of(c_.facts[i].inputs,
                                 [&](const Declaration &input) { return input.is_used && match(output, input); })) {
          add(Severity::Warning, "unread-output", i - 1, output.position,
              fmt::format("output '{}' is not read by the {} stage", output.name, to_string(c_.sources[i].stage)));
        }
      }
    }
  }

  void check_unused_bindings()
  {
    std::map<std::pair<gpu::BindingKind, std::string>, std::pair<StageDeclaration, bool>> bindings;
    const auto note = [&](std::size_t stage, gpu::BindingKind kind, const std::vector<Declaration> &declarations) {
      for (const Declaration &declaration : declarations) {
        const auto [entry, is_new] = bindings.try_emplace(std::pair(kind, declaration.name),
                                                          std::pair(StageDeclaration{stage, &declaration}, false));
        entry->second.second |= declaration.is_used;
      }
    };
    for (std::size_t i = 0; i < c_.facts.size(); i++) {
      note(i, gpu::BindingKind::UniformBlock, c_.facts[i].uniform_blocks);
      note(i, gpu::BindingKind::StorageBlock, c_.facts[i].storage_blocks);
      note(i, gpu::BindingKind::Texture, c_.facts[i].textures);
    }
    for (const auto &[key, value] : bindings) {
      const auto &[found, is_used] = value;
      if (!is_used) {
        add(Severity::Warning, "unused-binding", found.stage, found.declaration->position,
            fmt::format("{} '{}' is declared and never read", to_string(key.first), key.second));
      }
    }
  }

  void check_blocks()
  {
    const gpu::ShaderInterface interface = interface_of(c_.glslang.program());
    for (const gpu::ShaderInterface::Binding &binding : interface.bindings) {
      const std::optional<StageDeclaration> found =
          binding.kind == gpu::BindingKind::Texture ? std::nullopt : find_block(c_, binding.kind, binding.name);
      if (!found) {
        continue;
      }
      if (binding.kind == gpu::BindingKind::UniformBlock) {
        check_block_size(binding, *found);
      }
      const auto layout = std::ranges::find(options_.blocks, binding.name, &gpu::BlockLayout::name);
      if (layout != options_.blocks.end()) {
        for (const BlockDifference &difference : differences(compare_block(c_, binding, *found, *layout))) {
          add(Severity::Error, "layout", difference.file, difference.line, difference.text);
        }
      }
      else if (!options_.blocks.empty()) {
        add(Severity::Error, "layout", found->stage, found->declaration->position,
            fmt::format("block '{}' is not in the table of C++ blocks", binding.name));
      }
    }
  }

  void check_block_size(const gpu::ShaderInterface::Binding &binding, const StageDeclaration &found)
  {
    if (binding.size_bytes <= std::uint32_t(UNIFORM_BLOCK_BYTES_MAX)) {
      return;
    }
    const bool is_error = options_.is_block_size_strict || binding.size_bytes > uniform_block_bytes_limit;
    add(is_error ? Severity::Error : Severity::Warning, "block-size", found.stage, found.declaration->position,
        fmt::format("block '{}' takes {} bytes; all devices support {}, many {}, few more", binding.name,
                    binding.size_bytes, UNIFORM_BLOCK_BYTES_MAX, uniform_block_bytes_limit));
  }

  void check_spirv()
  {
    spvtools::SpirvTools tools(options_.target == CheckTarget::OpenGl ? SPV_ENV_OPENGL_4_5 : SPV_ENV_VULKAN_1_2);
    for (std::size_t i = 0; i < c_.sources.size(); i++) {
      std::vector<std::uint32_t> words;
      spv::SpvBuildLogger logger;
      glslang::GlslangToSpv(*c_.tree(i), words, &logger);
      std::string reason = logger.getAllMessages();
      bool is_warned = !reason.empty();
      tools.SetMessageConsumer(
          [&](spv_message_level_t, const char *, const spv_position_t &, const char *text) { reason += text; });
      const bool is_valid = tools.Validate(words);
      if (!is_valid || is_warned) {
        std::ranges::replace(reason, '\n', ' ');
        add(is_valid ? Severity::Warning : Severity::Error, "spirv", i, {}, reason);
      }
    }
  }

  const gpu::ShaderDesc &desc_;
  const gpu::ShaderFiles &files_;
  const CheckOptions &options_;
  std::string variant_;
  Compilation c_;
  std::vector<CheckMessage> messages_;
};

}  // namespace

std::span<const CheckRule> check_rules()
{
  return rules;
}

std::vector<CheckMessage> check_shader(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files,
                                       const CheckOptions &options)
{
  std::vector<CheckMessage> messages;
  with_large_stack([&] { messages = Checker(desc, files, options).run(); });
  return messages;
}

}  // namespace gnomon::shader_check
