// SPDX-License-Identifier: MIT
#include "gpu_error.hh"
#include "gpu_shader.hh"
#include "gpu_shader_macros.hh"
#include "gpu_shader_text.hh"

#include <algorithm>

namespace gnomon::gpu {

namespace {

/** Finds directives, which comments may precede. */
class Directives {
 public:
  /**
   * \return the next \a line from the `#` of its directive on; empty if it has none. A line that a comment contains, or
   * that continues another, has none
   */
  std::string_view next(std::string_view line)
  {
    std::string_view directive;
    bool has_text = is_continued_;
    bool is_in_line_comment = is_continued_ && is_in_line_comment_;
    is_continued_ = line.ends_with('\\');
    while (!is_in_line_comment && !line.empty()) {
      if (is_in_comment_) {
        const std::size_t end = line.find("*/");
        is_in_comment_ = end == std::string_view::npos;
        line.remove_prefix(is_in_comment_ ? line.size() : end + 2);
        continue;
      }
      if (!has_text) {
        line = TextScanner(line).skip_space().rest();
        has_text = !line.empty() && !line.starts_with("/*");
        directive = line.starts_with('#') ? line : std::string_view();
      }
      line.remove_prefix(std::min(line.find('/'), line.size()));
      is_in_comment_ = line.starts_with("/*");
      is_in_line_comment = line.starts_with("//");
      line.remove_prefix(std::min<std::size_t>(is_in_comment_ ? 2 : 1, line.size()));
    }
    is_in_line_comment_ = is_in_line_comment;
    return directive;
  }
  /** Whether the next line begins in a comment of several lines. */
  [[nodiscard]] bool is_in_comment() const
  {
    return is_in_comment_;
  }

 private:
  bool is_in_comment_ = false;
  bool is_continued_ = false;
  bool is_in_line_comment_ = false;
};

bool is_branch_start(std::string_view directive)
{
  return directive == "if" || directive == "ifdef" || directive == "ifndef";
}

bool is_branch_end(std::string_view directive)
{
  return directive == "elif" || directive == "else" || directive == "endif";
}

/** Expands the includes and defines of one stage, and leaves out what no compiler reads. */
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
    // Within a branch that is left out.
    int inner_branches = 0;
    for (std::size_t i = 0; i < lines.size(); i++) {
      const std::string_view from_directive = directives_.next(lines[i]);
      const std::string_view directive = directive_of(from_directive);
      std::string_view line = lines[i];
      if (!branches_.empty() && branches_.back().holds == Truth::No) {
        const bool is_inner = inner_branches > 0 || is_branch_start(directive);
        inner_branches += is_branch_start(directive) ? 1 : is_inner && directive == "endif" ? -1 : 0;
        if (is_inner || !is_branch_end(directive)) {
          // A comment that an earlier line of the text begins must end.
          (source_.text += is_comment_open_ ? line : std::string_view()) += '\n';
          is_comment_open_ &= directives_.is_in_comment();
          continue;
        }
        // The comment before the directive began in lines that are left out.
        line = is_comment_open_ ? line : from_directive;
      }
      is_comment_open_ = directives_.is_in_comment();
      const bool is_position_lost = follow_branch(from_directive, directive, i == guard);
      if (directive == "define" || directive == "undef") {
        macros_.set_defined(argument_of(from_directive), directive == "define" ? Truth::Yes : Truth::No, is_reached());
      }
      append_line(line, directive, path, int(i) + 1, file);
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
        macros_.set_defined(TextScanner(define).take_word(), Truth::Yes, is_reached());
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
      if (branch.holds != Truth::Yes) {
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
   * Update the stack of open branches. \a name: the directive of \a line, or empty. \return true if it ends a branch
   * that contains an include: if the compiler skips that branch, it also skips the `#line` directives in it, so the
   * position must be set again
   */
  bool follow_branch(std::string_view line, std::string_view name, bool is_include_guard)
  {
    if (is_branch_start(name)) {
      Truth holds = macros_.holds(name, behind_directive(line).rest());
      holds = is_include_guard && holds == Truth::Unknown ? Truth::Yes : holds;
      branches_.push_back({++branch_count_, holds, holds});
    }
    else if (is_branch_end(name) && !branches_.empty()) {
      Branch &branch = branches_.back();
      const bool had_include = branch.has_include;
      if (name == "endif") {
        branches_.pop_back();
        return had_include;
      }
      const Truth condition = name == "else" ? Truth::Yes : macros_.holds(name, behind_directive(line).rest());
      branch.number = ++branch_count_;
      branch.holds = conjunction(condition, negation(branch.this_or_earlier_holds));
      branch.this_or_earlier_holds = disjunction(branch.this_or_earlier_holds, condition);
      return had_include;
    }
    return false;
  }

  /** Whether compilers read the next line. */
  Truth is_reached() const
  {
    Truth truth = Truth::Yes;
    for (const Branch &branch : branches_) {
      truth = conjunction(truth, branch.holds);
    }
    return truth;
  }

  void append_position(int next_line, std::size_t file)
  {
    source_.text += fmt::format("#line {} {}\n", next_line, file);
  }

  /** The lines from an #if, #elif or #else to the next #elif, #else or #endif. */
  struct Branch {
    /** Unique within the stage. */
    int number = 0;
    /** Include guards always hold. */
    Truth holds = Truth::Unknown;
    /** Whether it, or an earlier branch of the same #if, holds. */
    Truth this_or_earlier_holds = Truth::Unknown;
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
  ShaderMacros macros_;
  Directives directives_;
  /** Whether `source_.text` ends in a comment. */
  bool is_comment_open_ = false;
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

}  // namespace gnomon::gpu
