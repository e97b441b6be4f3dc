// SPDX-License-Identifier: MIT
#include "shader_check_checker.hh"

#include "gpu_shader_text.hh"
#include "shader_check_block.hh"
#include "shader_check_spirv_place.hh"
#include "shared_types.h"

#include <spirv-tools/libspirv.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <tuple>

namespace gnomon::shader_check {

namespace {

/** Above this size a uniform block is an error, although some devices support more. */
constexpr int uniform_block_bytes_limit = 65536;

spv_target_env environment_of(CheckTarget target)
{
  switch (target) {
    case CheckTarget::Vulkan10: return SPV_ENV_VULKAN_1_0;
    case CheckTarget::Vulkan11: return SPV_ENV_VULKAN_1_1;
    case CheckTarget::Vulkan12: return SPV_ENV_VULKAN_1_2;
    case CheckTarget::Vulkan13: return SPV_ENV_VULKAN_1_3;
    default: return SPV_ENV_OPENGL_4_5;
  }
}

struct Feature {
  std::string_view name;
  void (spvtools::ValidatorOptions::*allow)(bool);
};

constexpr std::array<Feature, 5> features = {{
    {"scalarBlockLayout", &spvtools::ValidatorOptions::SetScalarBlockLayout},
    {"uniformBufferStandardLayout", &spvtools::ValidatorOptions::SetUniformBufferStandardLayout},
    {"relaxedBlockLayout", &spvtools::ValidatorOptions::SetRelaxBlockLayout},
    {"workgroupMemoryExplicitLayoutScalarBlockLayout", &spvtools::ValidatorOptions::SetWorkgroupScalarBlockLayout},
    {"maintenance4", &spvtools::ValidatorOptions::SetAllowLocalSizeId},
}};

/** Allows the features whose names \a is_allowed takes. */
template <typename IsAllowed>
void allow_features(spvtools::ValidatorOptions &options, IsAllowed &&is_allowed)
{
  for (const Feature &feature : features) {
    if (is_allowed(feature.name)) {
      (options.*feature.allow)(true);
    }
  }
}

/** Whether two stages are parts of one pipeline. */
bool is_pipeline(Stage stage)
{
  return stage <= Stage::Fragment;
}

const CheckRule &rule_of(std::string_view name)
{
  return *std::ranges::find(check_rules(), name, &CheckRule::name);
}

/**
 * Whether only a link would need what \a message misses: a program of OpenGL may have several shaders of one stage,
 * of which one has the `main` and the layouts of the stage, and others have functions that it calls.
 */
bool is_about_other_shaders(const LinkMessage &message)
{
  return std::ranges::any_of(std::array{"Missing entry point", "No function definition", "At least one shader must"},
                             [&](const char *part) { return message.text.find(part) != std::string::npos; });
}

bool is_difference_between_stages(const std::vector<LinkMessage> &errors)
{
  return std::ranges::all_of(errors, [](const LinkMessage &message) {
    // "Linking vertex and fragment stages: …", and from glslang 15 on
    // "Linking fragment stage: … vertex stage: … fragment stage: …".
    const std::string_view text = message.text;
    const std::size_t head_length = std::min(text.find(':'), text.size());
    return find_word(text.substr(0, head_length), "stages") != std::string_view::npos ||
           text.substr(head_length).find(" stage: ") != std::string_view::npos;
  });
}

/**
 * Whether \a message is about the sizes of arrays between two stages. glslang takes the arrays of `patch` variables for
 * those of vertices, and wants one size for gl_TexCoord in both stages.
 */
bool is_about_sizes_of_varyings(const LinkMessage &message)
{
  const bool is_of_one_stage = std::ranges::any_of(stage_names(), [&](const StageName &stage) {
    return message.text.find(fmt::format("{0} and {0} stages", stage.text)) != std::string::npos;
  });
  return !is_of_one_stage && message.text.find("Array sizes must be compatible: ") != std::string::npos &&
         message.text.find(" earlier stage: ") == std::string::npos;
}

/** Words of glslang's messages that are also words of GLSL. */
bool is_plain_word(std::string_view word)
{
  constexpr std::array<std::string_view, 12> words = {"in",      "out",    "uniform", "buffer", "layout", "location",
                                                      "binding", "shared", "const",   "stage",  "type",   "main"};
  return std::ranges::find(words, word) != words.end();
}

/** Whether an output and an input are connected: by location if they have one, otherwise by name. */
bool match(const Declaration &output, const Declaration &input)
{
  if (output.location < 0 || input.location < 0) {
    return output.location == input.location && output.name == input.name;
  }
  const bool has_components = output.component_count > 0 && input.component_count > 0;
  return output.location < input.location + input.location_count &&
         input.location < output.location + output.location_count &&
         !(has_components && (output.component >= input.component + input.component_count ||
                              input.component >= output.component + output.component_count));
}

/** Whether two types are equal without the outermost arrays of those that are arrayed. An array without a size has any.
 */
bool is_same_type(const DeclaredType &one, bool is_one_arrayed, const DeclaredType &other, bool is_other_arrayed)
{
  const auto sizes_of = [](const DeclaredType &type, bool is_arrayed) {
    return std::span(type.array_sizes).subspan(is_arrayed && !type.array_sizes.empty() ? 1 : 0);
  };
  return one.name == other.name && std::ranges::equal(sizes_of(one, is_one_arrayed), sizes_of(other, is_other_arrayed),
                                                      [](int size, int other_size) {
                                                        return size == other_size || size == 0 || other_size == 0;
                                                      });
}

/** Whether \a source has `#pragma STDGL invariant(all)`, which glslang reads for SPIR-V only. */
bool has_invariant_outputs(const std::unique_ptr<StageSource> &source)
{
  const std::string_view text = source->text();
  for (std::size_t at = find_word(text, "STDGL"); at != std::string_view::npos; at = find_word(text, "STDGL", at + 1)) {
    std::string pragma(text.substr(at, text.substr(at).find('\n')));
    std::erase_if(pragma, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    if (pragma.starts_with("STDGLinvariant(all)")) {
      return true;
    }
  }
  return false;
}

std::string named(const Declaration &varying)
{
  return varying.location < 0 ? fmt::format("'{}'", varying.name)
                              : fmt::format("'{}', location {},", varying.name, varying.location);
}

}  // namespace

std::span<const std::string_view> device_features()
{
  static const std::array<std::string_view, features.size()> names = [] {
    std::array<std::string_view, features.size()> list;
    std::ranges::transform(features, list.begin(), &Feature::name);
    return list;
  }();
  return names;
}

Checker::Checker(std::string name, const std::vector<std::string> &defines, const CheckSettings &settings)
    : name_(std::move(name)), options_(settings.options), settings_(settings), c_(settings.options.stage_errors)
{
  for (const std::string &define : defines) {
    variant_ += (variant_.empty() ? "" : " ") + define;
  }
}

void Checker::refuse(std::string_view rule, std::string file, int line, std::string_view text)
{
  add(Severity::Error, rule, std::move(file), line, text);
}

void Checker::compile(std::unique_ptr<StageSource> source)
{
  const std::size_t stage = c_.sources.size();
  const bool is_compiled = c_.add(std::move(source), options_.target);
  StageSource &added = *c_.sources.back();
  check_byte_order_mark(added);
  check_version(added);
  for (const SourceLines::CommentFault &fault : c_.lines[stage].comment_faults()) {
    add(Severity::Warning, "level-comment", stage, fault.position, fault.text);
  }
  if (check_bytes(added)) {
    // glslang's messages would only follow from it.
    is_compiled_ = false;
    return;
  }
  for (const CompileMessage &message : compile_messages(c_.glslang.log(), added)) {
    const bool is_warning = message.severity == Severity::Warning && message.rule == "compile";
    add(message.severity, is_warning ? "compile-warning" : message.rule, stage, message.position, message.text);
  }
  if (!is_compiled && !has_errors()) {
    add(Severity::Error, "compile", stage, {}, std::string(c_.glslang.log()));
  }
  is_compiled_ &= is_compiled;
}

void Checker::finish()
{
  if (is_compiled_ && !has_errors()) {
    const std::size_t compiled = messages_.size();
    link_stages();
    // Messages of one rule at one line stay in the order of the linker.
    std::stable_sort(messages_.begin() + std::ptrdiff_t(compiled), messages_.end(),
                     [](const CheckMessage &a, const CheckMessage &b) {
                       return std::tie(a.file, a.line, a.rule) < std::tie(b.file, b.line, b.rule);
                     });
  }
  // A header that is part of several stages gives the same message several times.
  std::set<std::tuple<std::string_view, int, std::string_view, std::string_view>> known;
  std::vector<CheckMessage> unique;
  for (CheckMessage &message : messages_) {
    if (known.emplace(message.file, message.line, message.rule, message.text).second) {
      unique.push_back(message);
    }
  }
  known.clear();
  messages_ = std::move(unique);
}

std::vector<CheckMessage> Checker::messages()
{
  return std::move(messages_);
}

const Compilation &Checker::compilation() const
{
  return c_;
}

std::vector<std::pair<Stage, std::vector<std::uint32_t>>> Checker::spirv()
{
  return std::move(spirv_);
}

std::optional<Severity> Checker::severity_of(Severity usual, std::string_view name, std::optional<RuleLevel> set) const
{
  const CheckRule &rule = rule_of(name);
  if (rule.is_optional && !set) {
    const auto found = options_.levels.find(name);
    set = found == options_.levels.end() ? std::nullopt : std::optional(found->second);
  }
  if (rule.is_optional && set) {
    return *set == RuleLevel::Off ? std::nullopt
                                  : std::optional(*set == RuleLevel::Error ? Severity::Error : Severity::Warning);
  }
  if (rule.is_own && !settings_.is_own) {
    return std::nullopt;
  }
  return options_.is_strict ? Severity::Error : usual;
}

void Checker::add(Severity usual, std::string_view rule, std::string file, int line, std::string_view text)
{
  if (const std::optional<Severity> severity = severity_of(usual, rule, std::nullopt)) {
    messages_.push_back({*severity, std::move(file), line, bounded(text), rule, name_, variant_, options_.target});
  }
}

void Checker::add(Severity usual, std::string_view rule, std::size_t stage, SourcePosition position,
                  std::string_view text)
{
  const SourceLines &lines = c_.lines[stage];
  const std::optional<Severity> severity = severity_of(usual, rule, lines.level(position.file, rule));
  if (severity && !(usual == Severity::Warning && lines.is_excused(position, rule))) {
    messages_.push_back({*severity, c_.file(stage, position), position.line, bounded(text), rule, name_, variant_,
                         options_.target, position.column});
  }
}

bool Checker::has_errors() const
{
  return std::ranges::any_of(messages_, [](const CheckMessage &m) { return m.severity == Severity::Error; });
}

void Checker::check_byte_order_mark(const StageSource &source)
{
  for (const std::size_t file : source.marked()) {
    add(Severity::Error, "compile", source.files()[file], 1,
        "the file begins with a byte-order mark (U+FEFF), which GLSL does not allow; save it as UTF-8 without one");
  }
}

bool Checker::check_bytes(const StageSource &source)
{
  bool is_any = false;
  for (const StageSource::File &file : source.texts()) {
    const bool has_mark = file.text.starts_with("\xFF\xFE") || file.text.starts_with("\xFE\xFF");
    const std::size_t zero = std::min(file.text.find('\0'), file.text.size());
    if (zero == file.text.size() && !has_mark) {
      continue;
    }
    is_any = true;
    // Text of ASCII has a 0 as every second byte in UTF-16, and as three bytes of four in UTF-32.
    const std::string_view first = file.text.substr(0, 4);
    const std::string_view mark("\xFF\xFE\0\0\xFE\xFF", 6);
    const bool is_utf32 =
        first == mark.substr(0, 4) || first == mark.substr(2) ||
        (first.size() == 4 && std::ranges::count(first, '\0') == 3 && (first[0] != '\0') != (first[3] != '\0'));
    const bool is_utf16 = has_mark || (zero <= 1 && file.text.size() > zero + 2 && file.text[zero + 1] != '\0' &&
                                       file.text[zero + 2] == '\0');
    const std::string_view before = file.text.substr(0, is_utf16 || is_utf32 ? 0 : zero);
    add(Severity::Error, "compile", source.files()[file.index], 1 + int(std::ranges::count(before, '\n')),
        is_utf32   ? "the file is text in UTF-32; save it as UTF-8 without a byte-order mark"
        : is_utf16 ? "the file is text in UTF-16; save it as UTF-8 without a byte-order mark"
                   : "the file has a NUL byte (0x00) here, which GLSL does not allow");
  }
  return is_any;
}

void Checker::check_version(const StageSource &source)
{
  const std::optional<Version> version = version_in(source.text());
  if (options_.target == CheckTarget::Es && version && !version->is_es()) {
    add(Severity::Error, "compile", source.files().front(), version->line,
        fmt::format("version {} is not of GLSL ES, and the target is OpenGL ES", version->number));
  }
}

void Checker::link_stages()
{
  bool is_linked = c_.link();
  const std::string log(c_.glslang.log());
  std::vector<LinkMessage> errors = is_linked ? std::vector<LinkMessage>() : link_messages(log);
  std::erase_if(errors, [](const LinkMessage &message) { return message.severity != Severity::Error; });
  if (!is_linked && c_.sources.size() == 1 && options_.target == CheckTarget::OpenGl &&
      std::ranges::all_of(errors, is_about_other_shaders)) {
    return;
  }
  // check_varyings() compares the sizes that a driver compares.
  if (!has_spirv(options_.target) && left_out_rules(options_.target).empty() &&
      std::erase_if(errors, is_about_sizes_of_varyings) > 0) {
    is_linked = errors.empty();
  }
  c_.read_facts(is_linked || is_difference_between_stages(errors), true);
  if (std::erase_if(errors, [&](const LinkMessage &error) { return is_about_unused_uniform(error); }) > 0) {
    is_linked = errors.empty();
  }
  check_findings();
  check_versions();
  if (is_vulkan(options_.target) && !settings_.is_own) {
    check_kinds();
  }
  check_slots();
  check_varyings();
  check_uniform_locations();
  if (!is_linked && may_differ(errors)) {
    add_block_differences(errors);
    is_linked = true;
  }
  // glslang's link errors have no line. They are reported only if our own checks, whose messages have lines, found no
  // mistake.
  if (!is_linked && !has_errors()) {
    for (const LinkMessage &message : errors) {
      const auto [stage, position] = place_of(message.text);
      const bool is_recursion = message.text.find("Recursion detected") != std::string::npos;
      add(Severity::Error, is_recursion ? "recursion" : "link", stage, position, message.text);
    }
    if (!has_errors()) {
      add(Severity::Error, "link", c_.sources.size() - 1, SourcePosition(), log);
    }
  }
  if (!is_linked) {
    return;
  }
  check_unused_bindings();
  check_blocks();
  if (has_spirv(options_.target)) {
    make_spirv();
  }
}

bool Checker::may_differ(const std::vector<LinkMessage> &errors) const
{
  return is_vulkan(options_.target) && !settings_.is_own && is_difference_between_stages(errors);
}

void Checker::add_block_differences(const std::vector<LinkMessage> &errors)
{
  for (const LinkMessage &message : errors) {
    const auto names_one = [&](const std::vector<Declaration> &declarations) {
      return std::ranges::any_of(declarations, [&](const Declaration &declaration) {
        // Stages often have parts of their own in the push constants.
        return !declaration.is_push_constant && find_word(message.text, declaration.name) != std::string_view::npos;
      });
    };
    // Inputs and outputs have rules of their own, and built-in blocks may differ.
    const bool is_binding = std::ranges::any_of(c_.facts, [&](const StageFacts &facts) {
      return names_one(facts.uniform_blocks) || names_one(facts.storage_blocks) || names_one(facts.textures);
    });
    if (is_binding) {
      const auto [stage, position] = place_of(message.text);
      add(Severity::Warning, "block-match", stage, position, message.text);
    }
  }
}

std::pair<std::size_t, SourcePosition> Checker::place_of(std::string_view text) const
{
  // "Linking fragment stage: …" or "Linking vertex and fragment stages: …".
  const std::string_view head = text.substr(0, text.find(':'));
  std::vector<std::size_t> stages_in_question;
  for (std::size_t i = c_.sources.size(); i-- > 0;) {
    if (find_word(head, to_string(c_.sources[i]->stage())) != std::string_view::npos) {
      stages_in_question.push_back(i);
    }
  }
  if (stages_in_question.empty()) {
    stages_in_question.push_back(c_.sources.size() - 1);
  }
  // A function, whose parameters may have types that the stage names before it.
  for (std::size_t at = text.find('('); at != std::string_view::npos; at = text.find('(', at + 1)) {
    std::size_t start = at;
    while (start > 0 && gpu::is_word_character(text[start - 1])) {
      start--;
    }
    const std::string_view name = text.substr(start, at - start);
    for (const std::size_t stage : stages_in_question) {
      const auto place = name.empty() || is_plain_word(name) ? std::nullopt : c_.lines[stage].find_name(name, {});
      if (place) {
        return {stage, *place};
      }
    }
  }
  for (const bool is_declared : {true, false}) {
    for (gpu::TextScanner scanner(text.substr(head.size())); !scanner.rest().empty();) {
      const std::string_view word = scanner.take_word();
      if (word.empty()) {
        scanner.take(scanner.rest().substr(0, 1));
        continue;
      }
      for (const std::size_t stage : stages_in_question) {
        for (const std::string_view keyword : {"uniform", "buffer", "in", "out", "shared"}) {
          const auto place = c_.lines[stage].find_name(word, is_declared ? keyword : std::string_view());
          const bool is_there =
              place && (!is_declared || find_word(c_.lines[stage].line(*place), keyword) != std::string_view::npos);
          if (is_there && !is_plain_word(word)) {
            return {stage, *place};
          }
        }
      }
    }
  }
  return {stages_in_question.front(), SourcePosition()};
}

void Checker::check_kinds()
{
  for (std::size_t i = 0; i < c_.facts.size(); i++) {
    for (std::size_t j = 0; j < c_.facts.size(); j++) {
      for (const Declaration &block : c_.facts[i].storage_blocks) {
        const std::vector<Declaration> &others = c_.facts[j].uniform_blocks;
        const auto other = std::ranges::find(others, block.name, &Declaration::name);
        if (i != j && other != others.end() && !other->is_push_constant) {
          add(Severity::Warning, "block-match", i, block.position,
              fmt::format("'{}' is a storage block here and a uniform block in the {} stage", block.name,
                          to_string(c_.sources[j]->stage())));
        }
      }
    }
  }
}

void Checker::check_findings()
{
  for (std::size_t i = 0; i < c_.facts.size(); i++) {
    for (const StageFinding &finding : c_.facts[i].findings) {
      add(finding.is_error ? Severity::Error : Severity::Warning, finding.rule, i, finding.position, finding.text);
    }
  }
}

void Checker::check_slots()
{
  struct Slot {
    gpu::BindingKind kind;
    const Declaration *declaration;
  };
  std::vector<Slot> known;
  const auto take = [&](std::size_t stage, gpu::BindingKind kind, const Declaration &declaration) {
    const bool is_push_constant = declaration.is_push_constant && declaration.slot < 0;
    if (declaration.slot < 0 && !is_push_constant) {
      add(Severity::Error, "slot", stage, declaration.position,
          fmt::format("{} '{}' has no layout(binding = …)", to_string(kind), declaration.name));
    }
    for (const Slot &other : known) {
      // OpenGL has separate slots for each kind of resource, Vulkan one set for all.
      const bool is_same_space =
          (kind == other.kind && declaration.is_image == other.declaration->is_image) || is_vulkan(options_.target);
      const bool is_same_slot = declaration.slot >= 0 && declaration.slot == other.declaration->slot &&
                                declaration.set == other.declaration->set;
      if (declaration.name == other.declaration->name && kind == other.kind) {
        const std::string type = type_name(declaration.type);
        const std::string earlier = type_name(other.declaration->type);
        // Vulkan connects textures by number. glslang's message about this names no stage and no type.
        if (kind == gpu::BindingKind::Texture && type != earlier && !is_vulkan(options_.target)) {
          add(Severity::Error, "link", stage, declaration.position,
              fmt::format("texture '{}' is {} here and {} in an earlier stage", declaration.name, type, earlier));
        }
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

bool Checker::is_about_unused_uniform(const LinkMessage &error) const
{
  if (options_.target != CheckTarget::Es || !left_out_rules(options_.target).empty() ||
      error.text.find("Precision qualifiers must match: ") == std::string::npos ||
      std::ranges::any_of(c_.sources, [](const std::unique_ptr<StageSource> &source) {
        return version_in(source->text()).value_or(Version{100, {}}).number >= 300;
      })) {
    return false;
  }
  return std::ranges::count_if(c_.facts, [&](const StageFacts &facts) {
           return std::ranges::any_of(facts.uniforms, [&](const Declaration &uniform) {
             return uniform.is_used && find_word(error.text, uniform.name) != std::string_view::npos;
           });
         }) < 2;
}

void Checker::check_uniform_locations()
{
  if (has_spirv(options_.target)) {
    return;
  }
  std::vector<StageDeclaration> known;
  for (std::size_t i = 0; i < c_.facts.size(); i++) {
    for (const Declaration &uniform : c_.facts[i].uniforms) {
      if (uniform.location < 0) {
        continue;
      }
      const auto other = std::ranges::find_if(known, [&](const StageDeclaration &one) {
        const Declaration &earlier = *one.declaration;
        return earlier.name != uniform.name && earlier.location < uniform.location + uniform.location_count &&
               uniform.location < earlier.location + earlier.location_count;
      });
      if (other != known.end()) {
        add(Severity::Error, "link", i, uniform.position,
            fmt::format("uniform '{}' has location {}, which uniform '{}' has in the {} stage", uniform.name,
                        std::max(uniform.location, other->declaration->location), other->declaration->name,
                        to_string(c_.sources[other->stage]->stage())));
      }
      known.push_back({i, &uniform});
    }
  }
}

bool Checker::is_part(const Declaration &output, const Declaration &input) const
{
  const bool is_allowed =
      options_.target == CheckTarget::Vulkan13 || (is_vulkan(options_.target) && has_feature("maintenance4"));
  return is_allowed && output.type.array_sizes.empty() && input.type.array_sizes.empty() && input.type.row_count == 0 &&
         output.type.scalar == input.type.scalar && input.type.vector_size < output.type.vector_size;
}

void Checker::check_versions()
{
  if (has_spirv(options_.target)) {
    return;
  }
  const Version usual{options_.target == CheckTarget::Es ? 100 : 110, {}};
  const Version first = version_in(c_.sources.front()->text()).value_or(usual);
  for (std::size_t i = 1; i < c_.sources.size(); i++) {
    const Version version = version_in(c_.sources[i]->text()).value_or(usual);
    if (version.is_es() != first.is_es() || (version.is_es() && version.number != first.number)) {
      const auto name_of = [](const Version &one) {
        return fmt::format("{} {}", one.is_es() ? "GLSL ES" : "GLSL", one.number);
      };
      add(Severity::Error, "link", i, {0, version.line},
          fmt::format("this stage is {}, and the {} stage {}; a driver does not link them", name_of(version),
                      to_string(c_.sources.front()->stage()), name_of(first)));
    }
  }
}

std::string_view Checker::stage_before(std::size_t stage) const
{
  return to_string(c_.sources[c_.stage_of(stage).begin - 1]->stage());
}

void Checker::check_qualifiers(std::size_t stage, const Declaration &input, const Declaration &output)
{
  if (has_spirv(options_.target)) {
    return;
  }
  // Rules are those of the newest version in the program.
  Version version{110, {}};
  for (const std::unique_ptr<StageSource> &source : c_.sources) {
    const Version other = version_in(source->text()).value_or(version);
    version = other.number > version.number ? other : version;
  }
  const std::string_view before = stage_before(stage);
  const auto name_of = [](const Declaration &one) {
    return one.is_flat ? "flat" : one.is_no_perspective ? "noperspective" : "smooth";
  };
  if ((version.is_es() || version.number < 440) && std::string_view(name_of(input)) != name_of(output)) {
    add(Severity::Error, "link", stage, input.position,
        fmt::format("input {} is {}, and the {} stage writes it {}; they may differ from GLSL 4.40 on", named(input),
                    name_of(input), before, name_of(output)));
  }
  // GLSL ES 3.00 and GLSL 4.20 made `invariant` a matter of outputs.
  if ((version.is_es() ? version.number < 300 : version.number < 420) && input.is_invariant != output.is_invariant &&
      std::ranges::none_of(c_.sources, has_invariant_outputs)) {
    add(Severity::Error, "link", stage, input.position,
        fmt::format("input {} is {}invariant, and the output of the {} stage is {}invariant; before GLSL 4.20 and GLSL "
                    "ES 3.00 both must be",
                    named(input), input.is_invariant ? "" : "not ", before, output.is_invariant ? "" : "not "));
  }
}

void Checker::check_members(std::size_t stage, const Declaration &input, const Declaration &output)
{
  const std::string_view before = stage_before(stage);
  const auto [read, written] =
      std::ranges::mismatch(input.members, output.members, [](const BlockMember &one, const BlockMember &other) {
        return is_same_type(one.type, false, other.type, false);
      });
  if (read != input.members.end() && written != output.members.end()) {
    add(Severity::Error, "varying-type", stage, read->position,
        fmt::format("member '{}' of the input {} is {}, and the {} stage writes {}", read->name, named(input),
                    type_name(read->type), before, type_name(written->type)));
  }
  else if (read != input.members.end() || written != output.members.end()) {
    add(Severity::Error, "varying-type", stage, input.position,
        fmt::format("input {} has {} members, and the {} stage writes {}", named(input), input.members.size(), before,
                    output.members.size()));
  }
}

void Checker::check_input(std::size_t stage, const Declaration &input, const std::vector<StageDeclaration> &outputs)
{
  const std::string_view before = stage_before(stage);
  const auto found =
      std::ranges::find_if(outputs, [&](const StageDeclaration &output) { return match(*output.declaration, input); });
  if (found == outputs.end()) {
    const auto named_alike = std::ranges::find_if(
        outputs, [&](const StageDeclaration &output) { return output.declaration->name == input.name; });
    if (input.is_used) {
      add(Severity::Error, "missing-varying", stage, input.position,
          fmt::format("input {} is no output of the {} stage{}", named(input), before,
                      named_alike == outputs.end()             ? ""
                      : named_alike->declaration->location < 0 ? fmt::format(", whose '{}' has no location", input.name)
                                                               : fmt::format(", whose '{}' has location {}", input.name,
                                                                             named_alike->declaration->location)));
    }
    return;
  }
  const Declaration &output = *found->declaration;
  check_qualifiers(stage, input, output);
  if (output.location != input.location || output.component != input.component) {
    // A part of an output, such as a column of a matrix, or parts of several.
    for (int i = 0; input.is_used && i < input.location_count; i++) {
      const int location = input.location + i;
      if (std::ranges::none_of(outputs, [&](const StageDeclaration &one) {
            return one.declaration->location <= location &&
                   location < one.declaration->location + one.declaration->location_count;
          })) {
        add(Severity::Error, "missing-varying", stage, input.position,
            fmt::format("input {} has location {} as well, which no output of the {} stage has", named(input), location,
                        before));
        break;
      }
    }
    return;
  }
  if (input.type.is_struct && output.type.is_struct) {
    check_members(stage, input, output);
  }
  else if (!is_same_type(output.type, output.is_arrayed, input.type, input.is_arrayed) && !input.type.is_struct &&
           !is_part(output, input)) {
    add(Severity::Error, "varying-type", stage, input.position,
        fmt::format("input {} is {}, and the {} stage writes {}", named(input), type_name(input.type, input.is_arrayed),
                    before, type_name(output.type, output.is_arrayed)));
  }
}

void Checker::check_varyings()
{
  std::vector<StageDeclaration> outputs;
  std::vector<StageDeclaration> inputs;
  for (std::size_t begin = 0; begin < c_.sources.size(); begin = c_.stage_of(begin).end) {
    inputs.clear();
    std::vector<StageDeclaration> next_outputs;
    for (std::size_t i = begin; i < c_.stage_of(begin).end; i++) {
      std::ranges::transform(c_.facts[i].inputs, std::back_inserter(inputs), [&](const Declaration &input) {
        return StageDeclaration{i, &input};
      });
      std::ranges::transform(c_.facts[i].outputs, std::back_inserter(next_outputs), [&](const Declaration &output) {
        return StageDeclaration{i, &output};
      });
    }
    const Stage stage = c_.sources[begin]->stage();
    if (begin > 0 && is_pipeline(stage) && c_.sources[begin - 1]->stage() != Stage::Task) {
      for (const StageDeclaration &input : inputs) {
        check_input(input.stage, *input.declaration, outputs);
      }
      for (const StageDeclaration &output : outputs) {
        if (!output.declaration->is_captured && std::ranges::none_of(inputs, [&](const StageDeclaration &input) {
              return (input.declaration->is_used || input.declaration->is_block_used) &&
                     match(*output.declaration, *input.declaration);
            })) {
          add(Severity::Warning, "unread-output", output.stage, output.declaration->position,
              fmt::format("output '{}' is not read by the {} stage", output.declaration->name, to_string(stage)));
        }
      }
    }
    outputs = std::move(next_outputs);
  }
}

void Checker::check_unused_bindings()
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

void Checker::check_blocks()
{
  std::set<std::string_view> known;
  for (std::size_t i = 0; i < c_.facts.size(); i++) {
    for (const Declaration &block : c_.facts[i].uniform_blocks) {
      if (known.insert(block.name).second && !block.is_push_constant) {
        check_block_size(i, block);
      }
    }
  }
  if (options_.blocks.empty()) {
    return;
  }
  const gpu::ShaderInterface interface = interface_of(c_.glslang.program());
  for (const gpu::ShaderInterface::Binding &binding : interface.bindings) {
    const std::optional<StageDeclaration> found =
        binding.kind == gpu::BindingKind::Texture ? std::nullopt : find_block(c_, binding.kind, binding.name);
    if (!found) {
      continue;
    }
    const auto layout = std::ranges::find(options_.blocks, binding.name, &gpu::BlockLayout::name);
    if (layout != options_.blocks.end()) {
      for (const BlockDifference &difference : differences(compare_block(c_, binding, *found, *layout))) {
        add(Severity::Error, "layout", difference.file, difference.line, difference.text);
      }
    }
    else {
      add(Severity::Error, "layout", found->stage, found->declaration->position,
          fmt::format("block '{}' is not in the table of C++ blocks", binding.name));
    }
  }
}

void Checker::check_block_size(std::size_t stage, const Declaration &block)
{
  // A block ends at the end of its last member's row of 16 bytes.
  const int bytes = int((block.size_bytes + 15) / 16 * 16);
  if (bytes <= UNIFORM_BLOCK_BYTES_MAX) {
    return;
  }
  const bool is_error = options_.is_block_size_strict || (settings_.is_own && bytes > uniform_block_bytes_limit);
  add(is_error ? Severity::Error : Severity::Warning, "block-size", stage, block.position,
      fmt::format("block '{}' takes {} bytes; all devices support {}, many {}, few more", block.name, bytes,
                  UNIFORM_BLOCK_BYTES_MAX, uniform_block_bytes_limit));
}

void Checker::make_spirv()
{
  for (std::size_t i = 0; i < c_.sources.size(); i++) {
    const Spirv &spirv = c_.spirv(i);
    if (severity_of(Severity::Error, "spirv", c_.lines[i].level(SourcePosition{}.file, "spirv"))) {
      validate(i, spirv.words, spirv.log);
    }
    spirv_.emplace_back(c_.sources[i]->stage(), spirv.words);
  }
}

bool Checker::has_feature(std::string_view name) const
{
  return std::ranges::find(settings_.features, name) != settings_.features.end();
}

SourcePosition Checker::place_in_spirv(std::size_t stage)
{
  const std::vector<std::uint32_t> words = c_.spirv_with_lines(stage);
  std::size_t number = 0;
  std::string text;
  spvtools::SpirvTools tools(environment_of(options_.target));
  tools.SetMessageConsumer([&](spv_message_level_t, const char *, const spv_position_t &position, const char *reason) {
    if (number == 0) {
      number = position.index;
      text = reason;
    }
  });
  spvtools::ValidatorOptions allowed;
  allowed.SetFriendlyNames(false);
  allow_features(allowed, [&](std::string_view name) { return has_feature(name); });
  tools.Validate(words.data(), words.size(), allowed);
  const SpirvPlace place = spirv_place(words, number);
  const SourceLines &lines = c_.lines[stage];
  // Without an includer, files have numbers, which SPIR-V does not keep.
  if (place.line > 0 && c_.sources[stage]->has_includer()) {
    return lines.position(place.file, place.line, 0);
  }
  for (const std::string &name : place.names) {
    const std::optional<SourcePosition> found = lines.find_name(name, {});
    if (found) {
      constexpr std::string_view mark = "member ";
      gpu::TextScanner scanner(std::string_view(text).substr(std::min(text.find(mark), text.size())));
      const std::optional<int> member = scanner.take(mark) ? scanner.take_number() : std::nullopt;
      return member && std::size_t(*member) < place.members.size() ? lines.find_member(*found, place.members[*member])
                                                                   : *found;
    }
  }
  return {};
}

void Checker::validate(std::size_t stage, const std::vector<std::uint32_t> &words, std::string text)
{
  bool is_warned = !text.empty();
  spvtools::SpirvTools tools(environment_of(options_.target));
  tools.SetMessageConsumer(
      [&](spv_message_level_t, const char *, const spv_position_t &, const char *reason) { text += reason; });
  // The validator searches linearly for a free name among equal ones, such as those of parameters. Without names its
  // time is linear; they are made again for the message about a mistake.
  constexpr std::size_t named_words_max = 1U << 16U;
  const auto is_valid_with = [&](auto &&is_allowed, bool has_names = false) {
    spvtools::ValidatorOptions allowed;
    allowed.SetFriendlyNames(has_names);
    allow_features(allowed, is_allowed);
    return tools.Validate(words.data(), words.size(), allowed);
  };
  const auto is_given = [&](std::string_view name) { return has_feature(name); };
  const std::string compiler_text = text;
  bool is_valid = is_valid_with(is_given);
  const SourcePosition place = is_valid ? SourcePosition() : place_in_spirv(stage);
  if (!is_valid && words.size() <= named_words_max) {
    text = compiler_text;
    is_valid_with(is_given, true);
  }
  if (!is_valid) {
    const std::string reason = text;
    for (const Feature &feature : features) {
      if (is_valid_with([&](std::string_view name) { return name == feature.name || is_given(name); })) {
        is_valid = is_warned = true;
        text = fmt::format("a device needs the feature {0}, which --feature {0} assumes: {1}", feature.name, reason);
        break;
      }
    }
    text = is_valid ? text : reason;
  }
  if (!is_valid || is_warned) {
    std::ranges::replace(text, '\n', ' ');
    add(is_valid ? Severity::Warning : Severity::Error, "spirv", stage, place, text);
  }
}

}  // namespace gnomon::shader_check
