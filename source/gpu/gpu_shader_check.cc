// SPDX-License-Identifier: MIT
#include "gpu_shader_check.hh"

#include "internal/gpu_shader_lint.hh"
#include "shared_types.h"

#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/libspirv.hpp>

#include <algorithm>
#include <array>
#include <regex>
#include <sstream>
#include <tuple>

namespace gnomon::gpu {

std::string_view to_string(CheckTarget target)
{
  return target == CheckTarget::OpenGl ? "OpenGL 4.5" : "Vulkan 1.2";
}

std::string_view to_string(Severity severity)
{
  return severity == Severity::Error ? "error" : "warning";
}

namespace {

/** What no device promises for a uniform block, though many take it. */
constexpr std::uint32_t uniform_block_bytes_limit = 65536;

constexpr std::array<CheckRule, 16> rules = {{
    {"include", "a file that is included, or named as a stage, exists"},
    {"compile", "glslang accepts the stage"},
    {"link", "glslang accepts the stages together"},
    {"spirv", "SPIRV-Tools accepts what glslang makes of the stage"},
    {"slot", "each block and texture has a slot of its own, the same in each stage"},
    {"missing-varying", "what a stage reads, the stage before it writes"},
    {"varying-type", "what a stage reads has the type that the stage before it writes"},
    {"layout", "a block that C++ and GLSL share is laid out alike in both"},
    {"block-array", "an array in a block has elements that fill rows of 16 bytes"},
    {"block-size", "a uniform block is not larger than every device takes"},
    {"recursion", "no function calls itself"},
    {"unused-binding", "a block or texture that is declared is read"},
    {"unread-output", "an output is read by the next stage"},
    {"implicit-conversion", "a block's member is not converted without saying so"},
    {"unbounded-loop", "a loop ends evidently"},
    {"unguarded-math", "a function with a limited domain is not given what may leave it"},
}};

/** One shader for one target: sources, glslang's view of them, and what was read from it. */
struct Compilation {
  std::vector<ShaderSource> sources;
  std::vector<SourceLines> lines;
  GlslangProgram glslang;
  /** Parallel to sources; empty until linked. */
  std::vector<StageFacts> facts;

  const glslang::TIntermediate *tree(std::size_t stage)
  {
    return glslang.program().getIntermediate(glslang_language(sources[stage].stage));
  }
  void read_facts()
  {
    for (std::size_t i = 0; i < sources.size(); i++) {
      facts.push_back(tree(i) == nullptr ? StageFacts() : read_stage(*tree(i), lines[i]));
    }
  }
  const std::string &file(std::size_t stage, SourcePosition position) const
  {
    const std::vector<std::string> &files = sources[stage].files;
    return position.file < files.size() ? files[position.file] : files.front();
  }
};

/** A declaration and the stage that it is in. */
struct Found {
  std::size_t stage;
  const Declaration *declaration;
};

/** The first uniform or storage block \a name. */
std::optional<Found> find_block(const Compilation &compilation, BindingKind kind, std::string_view name)
{
  for (std::size_t i = 0; i < compilation.facts.size(); i++) {
    const StageFacts &facts = compilation.facts[i];
    const auto &blocks = kind == BindingKind::UniformBlock ? facts.uniform_blocks : facts.storage_blocks;
    const auto found = std::ranges::find(blocks, name, &Declaration::name);
    if (found != blocks.end()) {
      return Found{i, &*found};
    }
  }
  return std::nullopt;
}

/** \a name without its last part: `lights[0].color` gives `lights[0].`. */
std::string_view parent_of(std::string_view name)
{
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : name.substr(0, dot + 1);
}

BlockComparison compare(const Compilation &compilation, const ShaderInterface::Binding &binding, const Found &found,
                        const BlockLayout &layout)
{
  const Declaration &block = *found.declaration;
  BlockComparison comparison;
  comparison.block = layout.name;
  comparison.cpp_size_bytes = layout.size_bytes;
  comparison.glsl_size_bytes = binding.size_bytes;
  comparison.file = compilation.file(found.stage, block.position);
  comparison.line = block.position.line;
  for (const BlockMember &member : block.members) {
    BlockComparison::Field &field = comparison.fields.emplace_back();
    field.structure = member.structure;
    field.name = member.name;
    field.file = compilation.file(found.stage, member.position);
    field.line = member.position.line;
    const auto glsl = std::ranges::find(binding.members, member.name, &ShaderInterface::Member::name);
    if (glsl != binding.members.end()) {
      field.glsl_offset_bytes = glsl->offset_bytes;
    }
    const auto cpp = std::ranges::find(layout.fields, member.name, &BlockLayout::Field::name);
    if (cpp != layout.fields.end()) {
      field.cpp_offset_bytes = cpp->offset_bytes;
    }
  }
  for (const BlockLayout::Field &cpp : layout.fields) {
    if (std::ranges::find(block.members, cpp.name, &BlockMember::name) != block.members.end()) {
      continue;
    }
    const auto sibling = std::ranges::find_if(
        block.members, [&](const BlockMember &member) { return parent_of(member.name) == parent_of(cpp.name); });
    BlockComparison::Field field;
    field.structure = sibling == block.members.end() ? "" : sibling->structure;
    const SourcePosition position = field.structure.empty()
                                        ? block.position
                                        : compilation.lines[found.stage].find_declaration(field.structure, "struct");
    field.name = cpp.name;
    field.cpp_offset_bytes = cpp.offset_bytes;
    field.file = compilation.file(found.stage, position);
    field.line = position.line;
    comparison.fields.push_back(std::move(field));
  }
  return comparison;
}

class Checker {
 public:
  Checker(const ShaderDesc &desc, const ShaderFiles &files, const CheckOptions &options)
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
    // A header is in each stage.
    messages_.erase(std::unique(messages_.begin(), messages_.end()), messages_.end());
    return std::move(messages_);
  }

 private:
  void add(Severity severity, std::string_view rule, std::string file, int line, std::string text)
  {
    messages_.push_back(
        {severity, std::move(file), line, std::move(text), rule, desc_.name, variant_, options_.target});
  }
  void add(Severity severity, std::string_view rule, std::size_t stage, SourcePosition position, std::string text)
  {
    add(severity, rule, c_.file(stage, position), position.line, std::move(text));
  }
  bool has_errors() const
  {
    return std::ranges::any_of(messages_, [](const CheckMessage &m) { return m.severity == Severity::Error; });
  }

  bool preprocess_stages()
  {
    try {
      c_.sources = preprocess(desc_, files_, options_.include_path);
    }
    catch (const SourceError &error) {
      add(Severity::Error, "include", error.file, error.line, error.text);
      return false;
    }
    catch (const Error &error) {
      const std::string &file = !desc_.vertex_path.empty()     ? desc_.vertex_path
                                : !desc_.geometry_path.empty() ? desc_.geometry_path
                                                               : desc_.fragment_path;
      add(Severity::Error, "include", file, 1, error.what());
      return false;
    }
    for (const ShaderSource &source : c_.sources) {
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
      add_compile_log(i, c_.glslang.log());
      if (!is_compiled && !has_errors()) {
        add(Severity::Error, "compile", i, {}, std::string(c_.glslang.log()));
      }
      is_done &= is_compiled;
    }
    return is_done;
  }

  /** `ERROR: FILE:LINE: TEXT`, FILE a number. */
  void add_compile_log(std::size_t stage, std::string_view log)
  {
    static const std::regex message_pattern(R"(^(ERROR|WARNING): (\d+):(\d+): (.*?)\s*$)");
    // What follows from having stopped at the message before.
    static const std::regex aftermath_pattern(R"(^'' : (compilation terminated|missing #endif))");
    // Vulkan has precisions, OpenGL none; nobody here wrote any.
    static const std::regex precision_pattern(R"(\bhighp )");
    struct Entry {
      Severity severity;
      SourcePosition position;
      std::string text;
      bool is_aftermath;
    };
    std::vector<Entry> entries;
    std::istringstream lines{std::string(log)};
    for (std::string line; std::getline(lines, line);) {
      std::smatch match;
      if (std::regex_match(line, match, message_pattern)) {
        const std::string text = match[4];
        entries.push_back({match[1] == "ERROR" ? Severity::Error : Severity::Warning,
                           {std::stoul(match[2]), std::stoi(match[3])},
                           std::regex_replace(text, precision_pattern, ""),
                           std::regex_search(text, aftermath_pattern)});
      }
    }
    const bool has_cause = std::ranges::any_of(
        entries, [](const Entry &entry) { return entry.severity == Severity::Error && !entry.is_aftermath; });
    for (Entry &entry : entries) {
      if (!has_cause || !entry.is_aftermath) {
        add(entry.severity, "compile", stage, entry.position, std::move(entry.text));
      }
    }
  }

  void link_stages()
  {
    const bool is_linked = c_.glslang.link();
    const std::string log(c_.glslang.log());
    c_.read_facts();
    check_findings();
    check_slots();
    check_varyings();
    // glslang names no line; where our own checks found the mistake, they do.
    if (!is_linked && !has_errors()) {
      add_link_log(log);
    }
    if (!is_linked) {
      return;
    }
    check_unused_bindings();
    check_blocks();
    check_spirv();
  }

  /** `ERROR: Linking STAGE stage: TEXT`, then indented lines that begin with the name at fault. */
  void add_link_log(const std::string &log)
  {
    static const std::regex message_pattern(R"(^ERROR: (.*?)\s*$)");
    static const std::regex name_pattern(R"(^\s+(\w+)\b.*)");
    std::istringstream lines(log);
    std::vector<std::pair<std::string, std::string>> errors;
    for (std::string line; std::getline(lines, line);) {
      std::smatch match;
      if (std::regex_match(line, match, message_pattern)) {
        errors.emplace_back(match[1], "");
      }
      else if (!errors.empty() && !line.empty()) {
        if (errors.back().second.empty() && std::regex_match(line, match, name_pattern)) {
          errors.back().second = match[1];
        }
        errors.back().first += " " + line.substr(std::min(line.find_first_not_of(' '), line.size()));
      }
    }
    for (const auto &[text, name] : errors) {
      const std::size_t stage = c_.sources.size() - 1;
      add(Severity::Error, "link", stage,
          name.empty() ? SourcePosition() : c_.lines[stage].find_declaration(name, "uniform"), text);
    }
  }

  void check_findings()
  {
    for (std::size_t i = 0; i < c_.facts.size(); i++) {
      for (const LintFinding &finding : c_.facts[i].findings) {
        add(finding.is_error ? Severity::Error : Severity::Warning, finding.rule, i, finding.position, finding.text);
      }
    }
  }

  void check_slots()
  {
    struct Slot {
      BindingKind kind;
      const Declaration *declaration;
    };
    std::vector<Slot> known;
    const auto take = [&](std::size_t stage, BindingKind kind, const Declaration &declaration) {
      const bool is_push_constant = declaration.name == push_constant_block_name && declaration.slot < 0;
      if (declaration.slot < 0 && !is_push_constant) {
        add(Severity::Error, "slot", stage, declaration.position,
            fmt::format("{} '{}' has no layout(binding = …)", to_string(kind), declaration.name));
      }
      for (const Slot &other : known) {
        // OpenGL has a space of slots for each kind, Vulkan one for all.
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
        take(i, BindingKind::UniformBlock, block);
      }
      for (const Declaration &block : c_.facts[i].storage_blocks) {
        take(i, BindingKind::StorageBlock, block);
      }
      for (const Declaration &texture : c_.facts[i].textures) {
        take(i, BindingKind::Texture, texture);
      }
    }
  }

  /** Whether the two meet, by location where they have any. */
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
      const bool is_arrayed = c_.sources[i].stage == ShaderStage::Geometry;
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
        const std::string written = interface_type(*output, false);
        const std::string read = interface_type(input, is_arrayed);
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
    std::map<std::pair<BindingKind, std::string>, std::pair<Found, bool>> bindings;
    const auto note = [&](std::size_t stage, BindingKind kind, const std::vector<Declaration> &declarations) {
      for (const Declaration &declaration : declarations) {
        const auto [entry, is_new] =
            bindings.try_emplace(std::pair(kind, declaration.name), std::pair(Found{stage, &declaration}, false));
        entry->second.second |= declaration.is_used;
      }
    };
    for (std::size_t i = 0; i < c_.facts.size(); i++) {
      note(i, BindingKind::UniformBlock, c_.facts[i].uniform_blocks);
      note(i, BindingKind::StorageBlock, c_.facts[i].storage_blocks);
      note(i, BindingKind::Texture, c_.facts[i].textures);
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
    const ShaderInterface interface = interface_of(c_.glslang.program());
    for (const ShaderInterface::Binding &binding : interface.bindings) {
      const std::optional<Found> found =
          binding.kind == BindingKind::Texture ? std::nullopt : find_block(c_, binding.kind, binding.name);
      if (!found) {
        continue;
      }
      if (binding.kind == BindingKind::UniformBlock) {
        check_block_size(binding, *found);
      }
      const auto layout = std::ranges::find(options_.blocks, binding.name, &BlockLayout::name);
      if (layout != options_.blocks.end()) {
        for (const BlockDifference &difference : differences(compare(c_, binding, *found, *layout))) {
          add(Severity::Error, "layout", difference.file, difference.line, difference.text);
        }
      }
      else if (!options_.blocks.empty()) {
        add(Severity::Error, "layout", found->stage, found->declaration->position,
            fmt::format("block '{}' is not in the table of C++ blocks", binding.name));
      }
    }
  }

  void check_block_size(const ShaderInterface::Binding &binding, const Found &found)
  {
    if (binding.size_bytes <= std::uint32_t(UNIFORM_BLOCK_BYTES_MAX)) {
      return;
    }
    const bool is_error = options_.is_block_size_strict || binding.size_bytes > uniform_block_bytes_limit;
    add(is_error ? Severity::Error : Severity::Warning, "block-size", found.stage, found.declaration->position,
        fmt::format("block '{}' takes {} bytes; every device takes {}, many {}, few more", binding.name,
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

  const ShaderDesc &desc_;
  const ShaderFiles &files_;
  const CheckOptions &options_;
  std::string variant_;
  Compilation c_;
  std::vector<CheckMessage> messages_;
};

/** \throws Error where \a desc does not compile. */
void compile(const ShaderDesc &desc, const ShaderFiles &files, Compilation &compilation)
{
  compilation.sources = preprocess(desc, files);
  for (const ShaderSource &source : compilation.sources) {
    compilation.lines.emplace_back(source);
    if (!compilation.glslang.add(source, GlslangTarget::OpenGlSpirv)) {
      throw Error("shader '{}', {} stage:\n{}", desc.name, to_string(source.stage),
                  source.name_files(compilation.glslang.log()));
    }
  }
  if (!compilation.glslang.link()) {
    throw Error("shader '{}' does not link:\n{}", desc.name, compilation.glslang.log());
  }
  compilation.read_facts();
}

std::vector<StageVariable> variables(const std::vector<Declaration> &declarations, bool is_arrayed)
{
  std::vector<StageVariable> variables;
  for (const Declaration &declaration : declarations) {
    variables.push_back({declaration.name, interface_type(declaration, is_arrayed), declaration.location});
  }
  std::ranges::stable_sort(variables, {}, &StageVariable::location);
  return variables;
}

}  // namespace

std::span<const CheckRule> check_rules()
{
  return rules;
}

std::vector<CheckMessage> check_shader(const ShaderDesc &desc, const ShaderFiles &files, const CheckOptions &options)
{
  return Checker(desc, files, options).run();
}

std::vector<BlockComparison> compare_blocks(const ShaderDesc &desc, const ShaderFiles &files,
                                            std::span<const BlockLayout> blocks)
{
  Compilation compilation;
  compile(desc, files, compilation);
  std::vector<BlockComparison> comparisons;
  for (const ShaderInterface::Binding &binding : interface_of(compilation.glslang.program()).bindings) {
    const auto layout = std::ranges::find(blocks, binding.name, &BlockLayout::name);
    const std::optional<Found> found = find_block(compilation, binding.kind, binding.name);
    if (layout != blocks.end() && found) {
      comparisons.push_back(compare(compilation, binding, *found, *layout));
    }
  }
  return comparisons;
}

std::vector<BlockDifference> differences(const BlockComparison &comparison)
{
  std::vector<BlockDifference> missing;
  std::vector<BlockDifference> moved;
  for (const BlockComparison::Field &field : comparison.fields) {
    const std::string where = field.structure.empty() ? std::string() : fmt::format(" of struct '{}'", field.structure);
    const std::string what = fmt::format("field '{}'{} in block '{}'", field.name, where, comparison.block);
    if (!field.cpp_offset_bytes) {
      missing.push_back({field.file, field.line, what + " is not in C++"});
    }
    else if (!field.glsl_offset_bytes) {
      missing.push_back({field.file, field.line, what + " is in C++ only"});
    }
    else if (*field.cpp_offset_bytes != *field.glsl_offset_bytes) {
      moved.push_back({field.file, field.line,
                       fmt::format("{} is at byte {}, in C++ at byte {}", what, *field.glsl_offset_bytes,
                                   *field.cpp_offset_bytes)});
    }
  }
  // A field too many or too few moves others: they say nothing new.
  if (!missing.empty()) {
    return missing;
  }
  if (moved.empty() && comparison.cpp_size_bytes != comparison.glsl_size_bytes) {
    moved.push_back({comparison.file, comparison.line,
                     fmt::format("block '{}' takes {} bytes, in C++ {}", comparison.block, comparison.glsl_size_bytes,
                                 comparison.cpp_size_bytes)});
  }
  return moved;
}

StageVariables stage_variables(const ShaderDesc &desc, const ShaderFiles &files)
{
  Compilation compilation;
  compile(desc, files, compilation);
  if (compilation.facts.empty()) {
    return {};
  }
  return {variables(compilation.facts.front().inputs, compilation.sources.front().stage == ShaderStage::Geometry),
          variables(compilation.facts.back().outputs, false)};
}

}  // namespace gnomon::gpu
