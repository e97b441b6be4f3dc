// SPDX-License-Identifier: MIT
#include "cli_shader_jobs.hh"

#include "cli.hh"
#include "cli_shader_checker.hh"
#include "cli_system.hh"

#include "output_file.hh"

#include <xxhash.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;
using shader_check::CheckMessage;
using shader_check::ProgramCheck;

std::string to_bytes(const ProgramCheck &check)
{
  json messages = json::array();
  for (const CheckMessage &m : check.messages) {
    const auto rule = std::ranges::find(shader_check::check_rules(), m.rule, &shader_check::CheckRule::name);
    messages.push_back({int(m.severity), m.file, m.line, m.column, m.text, rule - shader_check::check_rules().begin(),
                        m.shader, m.variant, int(m.target)});
  }
  json spirv = json::array();
  for (const auto &[stage, words] : check.spirv) {
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(words.data());
    spirv.push_back({int(stage), json::binary({bytes, bytes + words.size() * sizeof(std::uint32_t)})});
  }
  const json document = {messages, int(check.target), check.target_reason, check.files, check.absent, spirv};
  const std::vector<std::uint8_t> bytes = json::to_cbor(document);
  return {bytes.begin(), bytes.end()};
}

/** \throws json::exception for other bytes. */
ProgramCheck from_bytes(const std::string &bytes)
{
  const json document = json::from_cbor(bytes);
  ProgramCheck check;
  for (const json &m : document.at(0)) {
    check.messages.push_back({shader_check::Severity(m.at(0).get<int>()), m.at(1), m.at(2), m.at(4),
                              shader_check::check_rules()[m.at(5).get<std::size_t>()].name, m.at(6), m.at(7),
                              shader_check::CheckTarget(m.at(8).get<int>()), m.at(3)});
  }
  check.target = shader_check::CheckTarget(document.at(1).get<int>());
  check.target_reason = document.at(2);
  check.files = document.at(3).get<std::vector<std::string>>();
  check.absent = document.at(4).get<std::vector<std::string>>();
  for (const json &stage : document.at(5)) {
    const std::vector<std::uint8_t> &words = stage.at(1).get_binary();
    check.spirv.emplace_back(shader_check::Stage(stage.at(0).get<int>()),
                             std::vector<std::uint32_t>(words.size() / sizeof(std::uint32_t)));
    std::memcpy(check.spirv.back().second.data(), words.data(), words.size());
  }
  return check;
}

std::string hash_of(std::string_view text)
{
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

/** Results by the inputs that they depend on. */
class Cache {
 public:
  Cache(fs::path folder, const gpu::ShaderFiles &files) : folder_(std::move(folder)), files_(files) {}

  std::optional<ProgramCheck> find(const ShaderJob &job)
  {
    const std::optional<std::string> text = read(path_of(job));
    if (!text) {
      return std::nullopt;
    }
    try {
      const json entry = json::from_cbor(*text);
      const auto result = entry.at("result").get<std::string>();
      if (entry.at("result_hash") != hash_of(result)) {
        return std::nullopt;
      }
      ProgramCheck check = from_bytes(result);
      const auto hashes = entry.at("hashes").get<std::vector<std::string>>();
      bool is_current = hashes.size() == check.files.size();
      for (std::size_t i = 0; i < check.files.size() && is_current; i++) {
        is_current = content(check.files[i]) == hashes[i];
      }
      is_current = is_current &&
                   std::ranges::all_of(check.absent, [&](const std::string &path) { return content(path).empty(); });
      return is_current ? std::optional(std::move(check)) : std::nullopt;
    }
    catch (const json::exception &) {
      // Another version wrote it, or it is damaged: it is written again.
      return std::nullopt;
    }
  }
  void keep(const ShaderJob &job, const ProgramCheck &check)
  {
    std::vector<std::string> hashes;
    std::ranges::transform(check.files, std::back_inserter(hashes),
                           [&](const std::string &path) { return content(path); });
    const std::string result = to_bytes(check);
    const std::vector<std::uint8_t> bytes =
        json::to_cbor(json{{"result", result}, {"result_hash", hash_of(result)}, {"hashes", hashes}});
    std::error_code error;
    fs::create_directories(folder_, error);
    try {
      output::write_file(path_of(job), {reinterpret_cast<const char *>(bytes.data()), bytes.size()},
                         output::Flush::None);
    }
    catch (const output::Error &reason) {
      if (!is_failure_reported_) {
        is_failure_reported_ = true;
        print_message("warning: --cache keeps nothing: {}\n", reason.what());
      }
    }
  }

 private:
  fs::path path_of(const ShaderJob &job) const
  {
    // Another checker may find other mistakes, as may one with other rules.
    const std::size_t left_out_count = shader_check::left_out_rules(shader_check::CheckTarget::OpenGl).size();
    return folder_ / hash_of(fmt::format("{}{}\n{}", GNOMON_SHADER_CHECKER, left_out_count, job.key));
  }
  static std::optional<std::string> read(const fs::path &path)
  {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) {
      return std::nullopt;
    }
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  /** A hash of a file; empty if there is no such file. */
  const std::string &content(const std::string &path)
  {
    const auto [entry, is_new] = contents_.try_emplace(path);
    if (is_new) {
      const std::optional<std::string_view> text = files_(path);
      entry->second = text ? hash_of(*text) : "";
    }
    return entry->second;
  }

  fs::path folder_;
  const gpu::ShaderFiles &files_;
  std::map<std::string, std::string> contents_;
  bool is_failure_reported_ = false;
};

/** Shows a progress bar on a terminal; silent in a pipe. */
void show_progress(std::size_t done, std::size_t count)
{
  constexpr std::size_t width = 40;
  const std::size_t full = done * width / std::max<std::size_t>(count, 1);
  print_message("\r[{}{}] {}/{}{}", std::string(full, '#'), std::string(width - full, ' '), done, count,
                done == count ? "\r\033[K" : "");
}

}  // namespace

std::vector<ProgramCheck> run_jobs(const std::vector<ShaderJob> &jobs, const JobOptions &options)
{
  std::vector<ProgramCheck> results(jobs.size());
  std::optional<Cache> cache;
  if (!options.cache.empty()) {
    cache.emplace(options.cache, options.files);
  }
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < jobs.size(); i++) {
    std::optional<ProgramCheck> known = cache ? cache->find(jobs[i]) : std::nullopt;
    if (known) {
      results[i] = std::move(*known);
    }
    else {
      open.push_back(i);
    }
  }
  const bool is_terminal = stderr_is_terminal();
  std::vector<WorkResult> answers(jobs.size());
  const auto check_jobs = [&](const std::vector<std::size_t> &indices, shader_check::StageErrors errors) {
    std::vector<WorkResult> found = run_in_workers(
        indices.size(), options.limits, [&](std::size_t i) { return to_bytes(jobs[indices[i]].check(errors)); },
        [&](std::size_t done) {
          if (is_terminal) {
            show_progress(done, indices.size());
          }
        });
    for (std::size_t i = 0; i < indices.size(); i++) {
      answers[indices[i]] = std::move(found[i]);
    }
  };
  check_jobs(open, shader_check::StageErrors::All);
  // glslang crashes behind some errors if it does not stop at them. Their messages then come from a second check.
  std::vector<std::size_t> crashed;
  std::ranges::copy_if(open, std::back_inserter(crashed), [&](std::size_t i) { return answers[i].is_crash; });
  check_jobs(crashed, shader_check::StageErrors::First);
  for (const std::size_t i : open) {
    const ShaderJob &job = jobs[i];
    ProgramCheck &result = results[i];
    if (!answers[i].failure.empty()) {
      result.target = job.target;
      result.messages.push_back({shader_check::Severity::Error, job.file, 1,
                                 "the check of this program " + answers[i].failure, "limit", job.program, "",
                                 job.target});
      continue;
    }
    result = from_bytes(answers[i].bytes);
    if (cache) {
      cache->keep(job, result);
    }
  }
  return results;
}

}  // namespace gnomon::cli
