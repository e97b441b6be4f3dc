// SPDX-License-Identifier: MIT
#include "gpu_shader.hh"

#include "gpu_error.hh"
#include "gpu_shader_text.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

namespace gnomon::gpu {

std::string_view to_string(ShaderStage stage)
{
  switch (stage) {
    case ShaderStage::Vertex: return "vertex";
    case ShaderStage::Geometry: return "geometry";
    case ShaderStage::Fragment: return "fragment";
  }
  return "?";
}

std::string_view to_string(BindingKind kind)
{
  switch (kind) {
    case BindingKind::UniformBlock: return "uniform";
    case BindingKind::StorageBlock: return "storage";
    case BindingKind::Texture: return "texture";
  }
  return "?";
}

const ShaderInterface::Binding *ShaderInterface::find(BindingKind kind, std::string_view name) const
{
  const auto found = std::ranges::find_if(bindings, [&](const Binding &b) { return b.kind == kind && b.name == name; });
  return found == bindings.end() ? nullptr : &*found;
}

const ShaderInterface::Member *ShaderInterface::find_push_constant(std::string_view name) const
{
  const auto found = std::ranges::find(push_constant_members, name, &Member::name);
  return found == push_constant_members.end() ? nullptr : &*found;
}

namespace {

/** The source position of a compiler message. */
struct LogPosition {
  int file = 0;
  int line = 0;
  /** Offset of the position in the line, and the text after the position. */
  std::size_t begin = 0;
  std::string_view rest;
};

/** Parse the position at \a begin: `FILE:LINE` (glslang, Mesa) or, if \a has_parentheses, `FILE(LINE)` (NVIDIA). */
std::optional<LogPosition> log_position_at(std::string_view line, std::size_t begin, bool has_parentheses)
{
  TextScanner scanner(line.substr(begin));
  const std::optional<int> file = scanner.take_number();
  const bool is_parenthesis = has_parentheses && scanner.take("(");
  if (!file || !(is_parenthesis || scanner.take(":"))) {
    return std::nullopt;
  }
  const std::optional<int> number = scanner.take_number();
  if (!number || (is_parenthesis && !scanner.take(")"))) {
    return std::nullopt;
  }
  return LogPosition{*file, *number, begin, scanner.rest()};
}

/** Find the position of the message \a line: at its start, or after `ERROR: ` or `WARNING: `. */
std::optional<LogPosition> log_position(std::string_view line)
{
  if (const auto position = log_position_at(line, 0, true)) {
    return position;
  }
  for (const std::string_view mark : {"ERROR: ", "WARNING: "}) {
    const std::size_t at = line.find(mark);
    if (at != std::string_view::npos) {
      if (const auto position = log_position_at(line, at + mark.size(), false)) {
        return position;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::string ShaderSource::name_files(std::string_view log) const
{
  std::istringstream lines{std::string(log)};
  std::string named;
  for (std::string line; std::getline(lines, line);) {
    const std::optional<LogPosition> position = log_position(line);
    if (position && std::size_t(position->file) < files.size()) {
      line = fmt::format("{}{}:{}{}", std::string_view(line).substr(0, position->begin),
                         files[std::size_t(position->file)], position->line, position->rest);
    }
    named += line + "\n";
  }
  return named;
}

namespace {

/** A line `SPECIALIZATION_CONSTANT(ID) const TYPE NAME = DEFAULT;`. */
struct DeclaredConstant {
  std::uint32_t id = 0;
  std::string_view type;
  std::string_view name;
  /** `DEFAULT;` and the text after it. */
  std::string_view rest;
};

std::optional<DeclaredConstant> declared_constant(std::string_view line)
{
  TextScanner scanner(line);
  const auto take = [&](std::string_view text) { return scanner.skip_space().take(text); };
  if (!take("SPECIALIZATION_CONSTANT") || !take("(")) {
    return std::nullopt;
  }
  const std::optional<int> id = scanner.skip_space().take_number();
  if (!id || !take(")") || !take("const")) {
    return std::nullopt;
  }
  const std::string_view type = scanner.skip_space().take_word();
  const std::string_view name = scanner.skip_space().take_word();
  const bool has_default = take("=") && scanner.rest().find(';') != std::string_view::npos;
  return has_default ? std::optional(DeclaredConstant{std::uint32_t(*id), type, name, scanner.rest()}) : std::nullopt;
}

}  // namespace

std::vector<StageConstant> stage_constants(const ShaderDesc &desc, const std::vector<ShaderSource> &stages)
{
  if (desc.constants.empty()) {
    return {};
  }
  std::vector<StageConstant> values;
  std::vector<std::string_view> declared;
  for (const ShaderSource &stage : stages) {
    for (const std::string_view line : lines_of(stage.text)) {
      const std::optional<DeclaredConstant> constant = declared_constant(line);
      if (!constant) {
        continue;
      }
      declared.push_back(constant->name);
      const auto set = std::ranges::find(desc.constants, constant->name, &ShaderConstant::name);
      if (set == desc.constants.end()) {
        continue;
      }
      if (constant->type != "int" && constant->type != "bool") {
        throw Error("shader '{}': the constant '{}' has the type {}, and only int and bool can be set", desc.name,
                    set->name, constant->type);
      }
      const StageConstant value{stage.stage, constant->id,
                                constant->type == "bool" ? std::int32_t(set->value != 0) : set->value};
      // Branches of the text may declare it again.
      if (std::ranges::find(values, value) == values.end()) {
        values.push_back(value);
      }
    }
  }
  for (const ShaderConstant &constant : desc.constants) {
    if (std::ranges::find(declared, constant.name) == declared.end()) {
      throw Error("shader '{}' has no specialisation constant '{}'; it has: {}", desc.name, constant.name,
                  declared.empty() ? "none" : fmt::format("{}", fmt::join(declared, ", ")));
    }
  }
  return values;
}

std::string with_constants(std::string_view text, const std::vector<ShaderConstant> &constants)
{
  std::string result;
  for (const std::string_view line : lines_of(text)) {
    const std::optional<DeclaredConstant> constant = declared_constant(line);
    const auto set = constant ? std::ranges::find(constants, constant->name, &ShaderConstant::name) : constants.end();
    if (set == constants.end()) {
      result += line;
    }
    else {
      const auto head = line.substr(0, std::size_t(constant->rest.data() - line.data()));
      result +=
          fmt::format("{} {}({}){}", head, constant->type, set->value, constant->rest.substr(constant->rest.find(';')));
    }
    result += '\n';
  }
  return result;
}

}  // namespace gnomon::gpu
