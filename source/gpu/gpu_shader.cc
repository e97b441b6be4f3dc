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
  // glslang writes "ERROR: 2:15: …", Mesa "2:15(3): error: …".
  static const std::regex POSITION(R"((^|ERROR: |WARNING: )(\d+):(\d+))");
  std::istringstream lines{std::string(log)};
  std::string named;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, POSITION)) {
      const std::size_t file = std::stoul(match[2]);
      if (file < files.size()) {
        line = match.prefix().str() + match[1].str() + files[file] + ":" + match[3].str() + match.suffix().str();
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
  Preprocessor(const ShaderDesc &desc, const ShaderFiles &files, ShaderStage stage)
      : desc_(desc), files_(files), source_{stage, {}, {}}
  {
  }

  ShaderSource run(const std::string &path)
  {
    append_file(path, fmt::format("shader '{}'", desc_.name));
    if (!has_version_) {
      throw Error("{}: shader '{}': a stage begins with '#version 450 core'", path, desc_.name);
    }
    return std::move(source_);
  }

 private:
  void append_file(const std::string &path, const std::string &who)
  {
    const std::optional<std::string_view> text = files_(path);
    if (!text) {
      throw Error("{}: no shader file '{}'", who, path);
    }
    const std::size_t file = source_.files.size();
    source_.files.push_back(path);
    std::istringstream lines{std::string(*text)};
    int number = 0;
    if (file > 0) {
      append_position(1, file);
    }
    for (std::string line; std::getline(lines, line);) {
      number++;
      if (line.ends_with('\r')) {
        line.pop_back();
      }
      append_line(line, path, number, file);
    }
  }

  void append_line(const std::string &line, const std::string &path, int number, std::size_t file)
  {
    static const std::regex INCLUDE(R"rx(^\s*#\s*include\s+"([^"]+)"\s*(//.*)?$)rx");
    static const std::regex VERSION(R"(^\s*#\s*version\b.*)");
    static const std::regex ONCE(R"(^\s*#\s*pragma\s+once\b.*)");
    std::smatch match;
    if (std::regex_match(line, match, INCLUDE)) {
      const std::string included = match[1];
      if (std::ranges::find(source_.files, included) == source_.files.end()) {
        append_file(included, fmt::format("{}:{}", path, number));
      }
      append_position(number + 1, file);
    }
    else if (std::regex_match(line, VERSION)) {
      has_version_ = true;
      source_.text += line + "\n";
      for (const std::string &define : desc_.defines) {
        source_.text += "#define " + define + "\n";
      }
      append_position(number + 1, file);
    }
    else {
      source_.text += (std::regex_match(line, ONCE) ? "" : line) + "\n";
    }
  }

  void append_position(int next_line, std::size_t file)
  {
    source_.text += fmt::format("#line {} {}\n", next_line, file);
  }

  const ShaderDesc &desc_;
  const ShaderFiles &files_;
  ShaderSource source_;
  bool has_version_ = false;
};

}  // namespace

std::vector<ShaderSource> preprocess(const ShaderDesc &desc, const ShaderFiles &files)
{
  std::vector<ShaderSource> stages;
  const auto add = [&](ShaderStage stage, const std::string &path) {
    if (!path.empty()) {
      stages.push_back(Preprocessor(desc, files, stage).run(path));
    }
  };
  add(ShaderStage::Vertex, desc.vertex_path);
  add(ShaderStage::Geometry, desc.geometry_path);
  add(ShaderStage::Fragment, desc.fragment_path);
  return stages;
}

}  // namespace gnomon::gpu
