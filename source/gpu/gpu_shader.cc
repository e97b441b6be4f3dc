// SPDX-License-Identifier: MIT
#include "gpu_shader.hh"

#include "gpu_error.hh"

#include <algorithm>
#include <regex>
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

std::string ShaderSource::name_files(std::string_view log) const
{
  // glslang writes "ERROR: 2:15: …", Mesa "2:15(3): error: …", NVIDIA "2(15) : error …".
  static const std::regex position(R"((^|ERROR: |WARNING: )(\d+)(?::(\d+)|\((\d+)\) :))");
  std::istringstream lines{std::string(log)};
  std::string named;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, position)) {
      const std::size_t file = std::stoul(match[2]);
      if (file < files.size()) {
        const bool is_nvidia = match[4].matched;
        line = fmt::format("{}{}{}:{}{}{}", match.prefix().str(), match[1].str(), files[file],
                           is_nvidia ? match[4].str() : match[3].str(), is_nvidia ? ":" : "", match.suffix().str());
      }
    }
    named += line + "\n";
  }
  return named;
}

namespace {

/** Expands one stage. */
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
      throw SourceError(path, 1, fmt::format("shader '{}': a stage begins with '#version 450 core'", desc_.name));
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
    std::istringstream stream{std::string(*text)};
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) {
      lines.push_back(line.ends_with('\r') ? line.substr(0, line.size() - 1) : line);
    }
    const std::size_t outer_branches = branches_.size();
    const std::size_t guard = include_guard(lines);
    if (!includer.empty()) {
      append_position(1, file);
    }
    open_files_.push_back(path);
    for (std::size_t i = 0; i < lines.size(); i++) {
      const bool is_position_lost = follow_branch(lines[i], i == guard);
      append_line(lines[i], path, int(i) + 1, file);
      if (is_position_lost) {
        append_position(int(i) + 2, file);
      }
    }
    open_files_.pop_back();
    // What a file leaves open is the compiler's to report.
    branches_.resize(outer_branches);
  }

  void append_line(const std::string &line, const std::string &path, int number, std::size_t file)
  {
    static const std::regex include_line(R"rx(^\s*#\s*include\s+"([^"]+)"\s*(//.*)?$)rx");
    static const std::regex version_line(R"(^\s*#\s*version\b.*)");
    static const std::regex once_line(R"(^\s*#\s*pragma\s+once\b.*)");
    std::smatch match;
    if (std::regex_match(line, match, include_line)) {
      const std::string named = match[1];
      append_include(include_path_ ? include_path_(named, path) : named, path, number);
      append_position(number + 1, file);
    }
    else if (std::regex_match(line, version_line)) {
      has_version_ = true;
      source_.text += line + "\n";
      for (const std::string &define : desc_.defines) {
        source_.text += "#define " + define + "\n";
      }
      append_position(number + 1, file);
    }
    else {
      source_.text += (std::regex_match(line, once_line) ? "" : line) + "\n";
    }
  }

  void append_include(const std::string &path, const std::string &includer, int number)
  {
    if (std::ranges::find(open_files_, path) != open_files_.end() || is_included(path)) {
      return;
    }
    // Only the compiler knows whether an earlier `#include`, in some other branch, was an active one.
    const auto index = std::ranges::find(source_.files, path) - source_.files.begin();
    for (Branch &branch : branches_) {
      branch.has_include = true;
    }
    source_.text += fmt::format("#ifndef GNOMON_INCLUDED_{0}\n#define GNOMON_INCLUDED_{0}\n", index);
    append_file(path, includer, number);
    source_.text += "#endif\n";
    included_.emplace_back(path, open_branches());
  }

  /** Whether the file stands before here, in branches that all hold here too. */
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

  static std::string directive(const std::string &line)
  {
    static const std::regex DIRECTIVE(R"(^\s*#\s*(\w+).*)");
    std::smatch match;
    return std::regex_match(line, match, DIRECTIVE) ? match[1].str() : std::string();
  }

  /** Line of an `#ifndef X` that holds always, because `#define X` follows it; past the end where there is none. */
  static std::size_t include_guard(const std::vector<std::string> &lines)
  {
    static const std::regex GUARD(R"(^\s*#\s*(ifndef|define)\s+(\w+)\s*(//.*)?$)");
    const auto next = [&](std::size_t i) {
      while (i < lines.size() && directive(lines[i]).empty()) {
        i++;
      }
      return i;
    };
    const std::size_t first = next(0);
    const std::size_t second = first < lines.size() ? next(first + 1) : first;
    std::smatch ifndef;
    std::smatch define;
    if (second < lines.size() && std::regex_match(lines[first], ifndef, GUARD) &&
        std::regex_match(lines[second], define, GUARD) && ifndef[1] == "ifndef" && define[1] == "define" &&
        ifndef[2] == define[2]) {
      return first;
    }
    return lines.size();
  }

  /**
   * Keep the stack of open branches. True: \a line ends one that holds an include, so that the lines after it are
   * miscounted where the branch is not taken, `#line` and all.
   */
  bool follow_branch(const std::string &line, bool is_include_guard)
  {
    const std::string name = directive(line);
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

  /** From an #if, #elif or #else to the next of them or the #endif. */
  struct Branch {
    /** No other has it. */
    int number = 0;
    /** A file's include guard. */
    bool is_always = false;
    /** In it, or in an earlier branch of the same #if. */
    bool has_include = false;
  };

  const ShaderDesc &desc_;
  const ShaderFiles &files_;
  const IncludePath &include_path_;
  ShaderSource source_;
  /** Being expanded, outermost first. */
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

}  // namespace gnomon::gpu
