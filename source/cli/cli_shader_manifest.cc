// SPDX-License-Identifier: MIT
#include "cli_shader_manifest.hh"

#include "cli_shader_files.hh"

#include "output_file.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

/** A value of the manifest and its place, for messages. */
class ManifestValue {
 public:
  ManifestValue(const json &value, std::string place) : value_(value), place_(std::move(place)) {}

  [[noreturn]] void fail(std::string_view reason) const
  {
    throw std::runtime_error(fmt::format("{}: {}", place_.empty() ? "the whole" : place_, reason));
  }
  /** The member \a key, or null if there is none. */
  ManifestValue at(const char *key)
  {
    known_.insert(key);
    static const json none;
    const auto found = value_.find(key);
    return {found == value_.end() ? none : *found, place_ + "/" + key};
  }
  bool is_given() const
  {
    return !value_.is_null();
  }
  bool is_object() const
  {
    return value_.is_object();
  }
  /** Call it before at(). */
  void require_object() const
  {
    if (!is_object()) {
      fail("an object is needed");
    }
  }
  /** Call it after at() of all keys that are known. */
  void require_known_keys() const
  {
    for (const auto &[key, value] : value_.items()) {
      if (!known_.contains(key)) {
        fail(fmt::format("'{}' is unknown; known are {}", key, fmt::join(known_, ", ")));
      }
    }
  }
  std::string text() const
  {
    if (!value_.is_string() || value_.get_ref<const std::string &>().empty()) {
      fail("a string is needed");
    }
    return value_;
  }
  /** A string or number, as a define has it. The string may be empty. */
  std::string word() const
  {
    if (value_.is_string()) {
      return value_;
    }
    if (!value_.is_number_integer() && !value_.is_boolean()) {
      fail("a string or an integer is needed");
    }
    return value_.is_boolean() ? (value_.get<bool>() ? "1" : "0") : value_.dump();
  }
  /** Empty if it is not given. */
  std::vector<ManifestValue> list() const
  {
    if (is_given() && !value_.is_array()) {
      fail("an array is needed");
    }
    std::vector<ManifestValue> values;
    for (std::size_t i = 0; i < value_.size(); i++) {
      values.emplace_back(value_[i], fmt::format("{}/{}", place_, i));
    }
    return values;
  }
  std::vector<std::string> texts() const
  {
    std::vector<std::string> texts;
    std::ranges::transform(list(), std::back_inserter(texts), &ManifestValue::text);
    return texts;
  }
  /** Members by name; empty if it is not given. */
  std::vector<std::pair<std::string, ManifestValue>> members() const
  {
    std::vector<std::pair<std::string, ManifestValue>> members;
    if (is_given()) {
      require_object();
      for (const auto &[key, value] : value_.items()) {
        members.emplace_back(key, ManifestValue(value, place_ + "/" + key));
      }
    }
    return members;
  }

 private:
  const json &value_;
  std::string place_;
  std::set<std::string> known_;
};

std::vector<std::string> targets_in(const ManifestValue &value)
{
  std::vector<std::string> targets;
  for (const ManifestValue &target : value.list()) {
    targets.push_back(target.text());
    if (std::ranges::find(shader_check::check_targets(), targets.back(), &shader_check::TargetName::name) ==
        shader_check::check_targets().end()) {
      std::vector<std::string_view> names;
      std::ranges::transform(shader_check::check_targets(), std::back_inserter(names), &shader_check::TargetName::name);
      target.fail(fmt::format("'{}' is no target; there are {}", targets.back(), fmt::join(names, ", ")));
    }
  }
  return targets;
}

std::vector<std::string> features_in(const ManifestValue &value)
{
  std::vector<std::string> features;
  const auto known = shader_check::device_features();
  for (const ManifestValue &feature : value.list()) {
    features.push_back(feature.text());
    if (std::ranges::find(known, features.back()) == known.end()) {
      feature.fail(fmt::format("'{}' is no feature; there are {}", features.back(), fmt::join(known, ", ")));
    }
  }
  return features;
}

std::vector<std::string> defines_in(const ManifestValue &value)
{
  std::vector<std::string> defines;
  for (const ManifestValue &define : value.list()) {
    defines.push_back(shader_define(define.text()));
    if (defines.back().empty()) {
      define.fail("NAME or NAME=VALUE is needed");
    }
  }
  return defines;
}

/** All combinations of the values of each name. A value `null` leaves the name undefined. */
std::vector<std::vector<std::string>> permutations_in(const ManifestValue &value)
{
  std::vector<std::vector<std::string>> all{{}};
  for (const auto &[name, values] : value.members()) {
    if (!is_macro_name(name)) {
      values.fail(fmt::format("'{}' is no name of a macro", name));
    }
    std::vector<std::vector<std::string>> longer;
    const std::vector<ManifestValue> choices = values.list();
    if (choices.empty()) {
      values.fail("at least one value is needed");
    }
    if (all.size() * choices.size() > permutations_max) {
      values.fail(fmt::format("the program has more than {} permutations", permutations_max));
    }
    for (const std::vector<std::string> &defines : all) {
      for (const ManifestValue &choice : choices) {
        longer.push_back(defines);
        if (choice.is_given()) {
          longer.back().push_back(fmt::format("{} {}", name, choice.word()));
        }
      }
    }
    all = std::move(longer);
  }
  return all;
}

/** \a path without parts that change nothing. Behind a link to a folder, `..` is not the folder before it. */
std::string plain(const fs::path &path)
{
  const fs::path shorter = path.lexically_normal();
  std::error_code error;
  return (fs::exists(path, error) && !fs::equivalent(path, shorter, error) ? path : shorter).string();
}

/** A path, or an object of a path and its stage. */
shader_check::Program::File file_in(ManifestValue &value, const fs::path &folder)
{
  if (!value.is_object()) {
    const std::string path = plain(folder / value.text());
    const std::optional<shader_check::Stage> stage = stage_of(path);
    if (!stage) {
      value.fail("its name gives no stage; {\"path\": …, \"stage\": …} names one");
    }
    return {*stage, path};
  }
  const std::string path = plain(folder / value.at("path").text());
  const ManifestValue named = value.at("stage");
  value.require_known_keys();
  const auto stage = std::ranges::find(shader_check::stage_names(), named.text(), &shader_check::StageName::ending);
  if (stage == shader_check::stage_names().end()) {
    std::vector<std::string_view> names;
    std::ranges::transform(shader_check::stage_names(), std::back_inserter(names), &shader_check::StageName::ending);
    named.fail(fmt::format("'{}' is no stage; there are {}", named.text(), fmt::join(names, ", ")));
  }
  return {stage->stage, path};
}

shader_check::Program program_in(ManifestValue &value, const fs::path &folder)
{
  shader_check::Program program;
  const ManifestValue files = value.at("files");
  for (ManifestValue &value : files.list()) {
    shader_check::Program::File file = file_in(value, folder);
    if (std::ranges::any_of(program.files, [&](const shader_check::Program::File &other) {
          return other.path == file.path && other.stage == file.stage;
        })) {
      value.fail("the program has this file twice");
    }
    program.files.push_back(std::move(file));
  }
  if (program.files.empty()) {
    files.fail("at least one file is needed");
  }
  const ManifestValue name = value.at("name");
  program.name = name.is_given() ? name.text() : stem_of(program.files.front().path);
  return program;
}

ShaderManifest manifest_in(const json &document, const fs::path &folder)
{
  ShaderManifest manifest;
  ManifestValue root(document, "");
  root.require_object();
  static_cast<void>(root.at("$schema"));
  for (const std::string &include : root.at("include_folders").texts()) {
    manifest.include_folders.push_back(plain(folder / include));
  }
  manifest.levels = root.at("levels").texts();
  manifest.features = features_in(root.at("features"));
  const std::vector<std::string> targets = targets_in(root.at("targets"));
  const std::vector<std::string> defines = defines_in(root.at("defines"));
  const ManifestValue programs = root.at("programs");
  if (programs.list().empty()) {
    programs.fail("at least one program is needed");
  }
  root.require_known_keys();
  std::set<std::string> names;
  for (ManifestValue value : programs.list()) {
    value.require_object();
    shader_check::Program program = program_in(value, folder);
    const std::string name = program.name;
    for (int number = 2; !names.insert(program.name).second; number++) {
      program.name = fmt::format("{} {}", name, number);
    }
    const ManifestValue own_targets = value.at("targets");
    const std::vector<std::string> own_defines = defines_in(value.at("defines"));
    const std::vector<std::vector<std::string>> permutations = permutations_in(value.at("permutations"));
    for (const std::vector<std::string> &permutation : permutations) {
      ShaderManifest::Entry &entry = manifest.entries.emplace_back(
          ShaderManifest::Entry{program, own_targets.is_given() ? targets_in(own_targets) : targets});
      for (const auto &list : {defines, own_defines, permutation}) {
        for (const std::string &define : list) {
          add_define(entry.program.defines, define);
        }
      }
    }
    value.require_known_keys();
  }
  return manifest;
}

}  // namespace

/** \a path and the line of \a text in which the byte \a at is. */
static std::string place_of(const fs::path &path, std::string_view text, std::size_t at)
{
  return fmt::format("{}:{}", path.string(), 1 + std::ranges::count(text.substr(0, at), '\n'));
}

/** \throws std::runtime_error for no JSON, and for an object that has one key twice, whose first value would be lost */
static json parse_manifest(const fs::path &path, std::istream &stream)
{
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::istringstream source(text);
  std::vector<std::set<std::string>> open;
  const auto note = [&](int, json::parse_event_t event, const json &value) {
    if (event == json::parse_event_t::object_start) {
      open.emplace_back();
    }
    else if (event == json::parse_event_t::object_end) {
      open.pop_back();
    }
    else if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second) {
      throw std::runtime_error(fmt::format("{}: an object has the key '{}' twice",
                                           place_of(path, text, std::size_t(source.tellg())),
                                           value.get<std::string>()));
    }
    return true;
  };
  try {
    return json::parse(source, note);
  }
  catch (const json::parse_error &error) {
    const std::string_view what = error.what();
    const std::size_t detail = what.find(" - ");
    throw std::runtime_error(fmt::format("{}: no JSON: {}", place_of(path, text, error.byte == 0 ? 0 : error.byte - 1),
                                         detail == std::string_view::npos ? what : what.substr(detail + 3)));
  }
}

ShaderManifest read_shader_manifest(const fs::path &path)
{
  output::require_readable(path, path.string() + ": ");
  std::ifstream stream(path);
  if (!stream) {
    throw std::runtime_error(fmt::format("{}: the file cannot be read", path.string()));
  }
  const json document = parse_manifest(path, stream);
  // A stream, such as that of a shell's <(…), lies in no folder of shaders.
  const bool is_stream = path.string().starts_with("/dev/") || path.string().starts_with("/proc/");
  try {
    return manifest_in(document, is_stream ? fs::path() : path.parent_path());
  }
  catch (const std::exception &error) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace gnomon::cli
