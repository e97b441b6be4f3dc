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

/** The lines of \a text without their ends. */
std::vector<std::string_view> lines_of(std::string_view text)
{
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    lines.push_back(line.ends_with('\r') ? line.substr(0, end - 1) : line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/** Expands the includes and defines of one stage. */
class Preprocessor {
 public:
  Preprocessor(const ShaderDesc &desc, const ShaderFiles &files, const IncludePath &include_path, ShaderStage stage)
      : desc_(desc), files_(files), include_path_(include_path), source_{stage, {}, {}}
  {
  }

  ShaderSource run(const std::string &path)
  {
    append_file(path, {}, 0);
    if (!has_version_) {
      throw SourceError(path, 1, fmt::format("shader '{}': a stage must begin with '#version 450 core'", desc_.name));
    }
    return std::move(source_);
  }

 private:
  void append_file(const std::string &path, const std::string &includer, int includer_line)
  {
    const std::optional<std::string_view> text = files_(path);
    if (!text) {
      if (includer.empty()) {
        throw Error("shader '{}': no shader file '{}'", desc_.name, path);
      }
      throw SourceError(includer, includer_line, fmt::format("no shader file '{}'", path));
    }
    const auto known = std::ranges::find(source_.files, path);
    const auto file = std::size_t(known - source_.files.begin());
    if (known == source_.files.end()) {
      source_.files.push_back(path);
    }
    // A copy, because files_ may be asked for other files while the lines are read.
    const std::string copy(*text);
    const std::vector<std::string_view> lines = lines_of(copy);
    const std::size_t outer_branches = branches_.size();
    const std::size_t guard = include_guard(lines);
    if (!includer.empty()) {
      append_position(1, file);
    }
    open_files_.push_back(path);
    for (std::size_t i = 0; i < lines.size(); i++) {
      const std::string_view directive = directive_of(lines[i]);
      const bool is_position_lost = follow_branch(directive, i == guard);
      append_line(lines[i], directive, path, int(i) + 1, file);
      if (is_position_lost) {
        append_position(int(i) + 2, file);
      }
    }
    open_files_.pop_back();
    // The compiler reports branches that the file does not close.
    branches_.resize(outer_branches);
  }

  /** \a name: directive_of(line). */
  void append_line(std::string_view line, std::string_view name, const std::string &path, int number, std::size_t file)
  {
    const std::string_view named = name == "include" ? included_name(line) : std::string_view();
    if (!named.empty()) {
      append_include(include_path_ ? include_path_(named, path) : std::string(named), path, number);
      append_position(number + 1, file);
    }
    else if (name == "version") {
      has_version_ = true;
      (source_.text += line) += '\n';
      for (const std::string &define : desc_.defines) {
        source_.text += "#define " + define + "\n";
      }
      append_position(number + 1, file);
    }
    else {
      (source_.text += name == "pragma" && argument_of(line) == "once" ? std::string_view() : line) += '\n';
    }
  }

  /** A scanner at the text after the name of the directive. */
  static TextScanner behind_directive(std::string_view line)
  {
    TextScanner scanner(line);
    scanner.skip_space().take("#");
    scanner.skip_space().take_word();
    return scanner.skip_space();
  }
  /** The word that follows the name of the directive. */
  static std::string_view argument_of(std::string_view line)
  {
    return behind_directive(line).take_word();
  }
  /** NAMED of `#include "NAMED"`. Empty if the line has another form; the compiler then reports it. */
  static std::string_view included_name(std::string_view line)
  {
    TextScanner scanner = behind_directive(line);
    const bool has_quote = scanner.take("\"");
    const std::string_view named = scanner.rest().substr(0, scanner.rest().find('"'));
    return has_quote && scanner.take(named) && scanner.take("\"") && scanner.is_at_end() ? named : std::string_view();
  }

  void append_include(const std::string &path, const std::string &includer, int number)
  {
    if (std::ranges::find(open_files_, path) != open_files_.end() || is_included(path)) {
      return;
    }
    // An earlier `#include` in another branch may be inactive. Only the compiler knows, so the guard below decides.
    const auto index = std::ranges::find(source_.files, path) - source_.files.begin();
    for (Branch &branch : branches_) {
      branch.has_include = true;
    }
    source_.text += fmt::format("#ifndef GNOMON_INCLUDED_{0}\n#define GNOMON_INCLUDED_{0}\n", index);
    append_file(path, includer, number);
    source_.text += "#endif\n";
    included_.emplace_back(path, open_branches());
  }

  /** Whether the file was already included, inside branches that are all open here too. */
  bool is_included(const std::string &path) const
  {
    const std::vector<int> here = open_branches();
    return std::ranges::any_of(included_, [&](const auto &earlier) {
      const auto &[name, branches] = earlier;
      return name == path && branches.size() <= here.size() &&
             std::equal(branches.begin(), branches.end(), here.begin());
    });
  }

  std::vector<int> open_branches() const
  {
    std::vector<int> numbers;
    for (const Branch &branch : branches_) {
      if (!branch.is_always) {
        numbers.push_back(branch.number);
      }
    }
    return numbers;
  }

  /** NAME of a line `#ifndef NAME` or `#define NAME`, according to \a directive; empty for all other lines. */
  static std::string_view guard_name(std::string_view line, std::string_view directive)
  {
    TextScanner scanner = behind_directive(line);
    const std::string_view name = scanner.take_word();
    return directive_of(line) == directive && scanner.is_at_end() ? name : std::string_view();
  }

  /** Index of the line `#ifndef X` of an include guard, which `#define X` follows; lines.size() if there is none. */
  static std::size_t include_guard(const std::vector<std::string_view> &lines)
  {
    const auto next = [&](std::size_t i) {
      while (i < lines.size() && directive_of(lines[i]).empty()) {
        i++;
      }
      return i;
    };
    const std::size_t first = next(0);
    const std::size_t second = first < lines.size() ? next(first + 1) : first;
    if (second == lines.size()) {
      return second;
    }
    const std::string_view name = guard_name(lines[first], "ifndef");
    return !name.empty() && name == guard_name(lines[second], "define") ? first : lines.size();
  }

  /**
   * Update the stack of open branches. \a name: the directive of a line, or empty. \return true if it ends a branch
   * that contains an include: if the compiler skips that branch, it also skips the `#line` directives in it, so the
   * position must be set again
   */
  bool follow_branch(std::string_view name, bool is_include_guard)
  {
    if (name.empty()) {
      return false;
    }
    if (name == "if" || name == "ifdef" || name == "ifndef") {
      branches_.push_back({++branch_count_, is_include_guard});
    }
    else if ((name == "elif" || name == "else" || name == "endif") && !branches_.empty()) {
      const bool had_include = branches_.back().has_include;
      if (name == "endif") {
        branches_.pop_back();
      }
      else {
        branches_.back().number = ++branch_count_;
      }
      return had_include;
    }
    return false;
  }

  void append_position(int next_line, std::size_t file)
  {
    source_.text += fmt::format("#line {} {}\n", next_line, file);
  }

  /** The lines from an #if, #elif or #else to the next #elif, #else or #endif. */
  struct Branch {
    /** Unique within the stage. */
    int number = 0;
    /** Whether it is an include guard, which always holds. */
    bool is_always = false;
    /** Whether it, or an earlier branch of the same #if, contains an include. */
    bool has_include = false;
  };

  const ShaderDesc &desc_;
  const ShaderFiles &files_;
  const IncludePath &include_path_;
  ShaderSource source_;
  /** Files that are being expanded, outermost first. */
  std::vector<std::string> open_files_;
  std::vector<std::pair<std::string, std::vector<int>>> included_;
  std::vector<Branch> branches_;
  int branch_count_ = 0;
  bool has_version_ = false;
};

}  // namespace

std::vector<ShaderSource> preprocess(const ShaderDesc &desc, const ShaderFiles &files, const IncludePath &include_path)
{
  std::vector<ShaderSource> stages;
  const auto add = [&](ShaderStage stage, const std::string &path) {
    if (!path.empty()) {
      stages.push_back(Preprocessor(desc, files, include_path, stage).run(path));
    }
  };
  add(ShaderStage::Vertex, desc.vertex_path);
  add(ShaderStage::Geometry, desc.geometry_path);
  add(ShaderStage::Fragment, desc.fragment_path);
  return stages;
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
