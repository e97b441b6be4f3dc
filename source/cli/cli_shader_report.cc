// SPDX-License-Identifier: MIT
#include "cli_shader_report.hh"

#include "output_text.hh"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace gnomon::cli {

namespace {

using nlohmann::json;

/** Equal messages about one line. */
struct Group {
  const shader_check::CheckMessage *first = nullptr;
  std::vector<const shader_check::CheckMessage *> all;
};

/** In the order of their first messages. */
std::vector<Group> groups_of(const ShaderReport &report)
{
  using Key = std::tuple<std::string_view, int, shader_check::Severity, std::string_view, std::string_view>;
  std::map<Key, std::size_t> indices;
  std::vector<Group> groups;
  for (const shader_check::CheckMessage &message : report.messages) {
    const auto [entry, is_new] = indices.try_emplace(
        Key(message.file, message.line, message.severity, message.rule, message.text), groups.size());
    if (is_new) {
      groups.push_back({&message, {}});
    }
    groups[entry->second].all.push_back(&message);
  }
  return groups;
}

std::string join(const std::set<std::string> &words, std::string_view separator)
{
  return fmt::format("{}", fmt::join(words, separator));
}

/** The shaders and variants of a message. */
std::string where(const Group &group)
{
  std::set<std::string> shaders;
  std::set<std::string> targets;
  std::set<std::pair<std::string, std::string>> variants;
  for (const shader_check::CheckMessage *message : group.all) {
    shaders.insert(message->shader);
    variants.emplace(message->shader, message->variant);
    targets.emplace(to_string(message->target));
  }
  std::string what = join(shaders, ", ");
  if (variants.size() > 1) {
    what += fmt::format(", {} variants", variants.size());
  }
  else if (!group.first->variant.empty()) {
    what += " " + group.first->variant;
  }
  return fmt::format("{}; {}", what, join(targets, ", "));
}

std::size_t count(const std::vector<Group> &groups, shader_check::Severity severity)
{
  return std::size_t(
      std::ranges::count_if(groups, [&](const Group &group) { return group.first->severity == severity; }));
}

/** \a path as a part of a URI. */
std::string uri(std::string_view path)
{
  std::string text;
  for (const char c : path) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("/._-~").find(c) != std::string_view::npos;
    text += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return path.starts_with('/') ? "file://" + text : text;
}

/** Source files may not be UTF-8, so invalid characters are replaced. */
std::string dump(const json &document)
{
  return document.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace

bool ShaderReport::has_errors() const
{
  return std::ranges::any_of(messages,
                             [](const auto &message) { return message.severity == shader_check::Severity::Error; });
}

namespace {

/** The rules that this build does not check, by target. */
std::vector<std::pair<std::string_view, std::vector<std::string_view>>> left_out(const ShaderReport &report)
{
  std::vector<std::pair<std::string_view, std::vector<std::string_view>>> result;
  for (const shader_check::CheckTarget target : report.targets) {
    if (std::vector<std::string_view> rules = shader_check::left_out_rules(target); !rules.empty()) {
      result.emplace_back(to_string(target), std::move(rules));
    }
  }
  return result;
}

std::string left_out_text(std::string_view target, const std::vector<std::string_view> &rules)
{
  return fmt::format("not checked for {}, because this build has no syntax tree of glslang: {}", target,
                     fmt::join(rules, ", "));
}

/** A line of text for people. */
std::string line_of(std::string text)
{
  std::ranges::replace(text, '\n', '?');
  return output::printable_text(text) + '\n';
}

}  // namespace

std::string to_text(const ShaderReport &report)
{
  const std::vector<Group> groups = groups_of(report);
  std::string text;
  for (const Group &group : groups) {
    const shader_check::CheckMessage &m = *group.first;
    const std::string line = m.line > 0 ? fmt::format(":{}", m.line) : "";
    text += line_of(
        fmt::format("{}{}: {}: {} [{}] ({})", m.file, line, to_string(m.severity), m.text, m.rule, where(group)));
  }
  std::set<std::string> targets;
  for (const shader_check::CheckTarget target : report.targets) {
    targets.emplace(to_string(target));
  }
  text += fmt::format("{} programs, {} variants, {}: {} errors, {} warnings, {:.2f} s\n", report.program_count,
                      report.variant_count, join(targets, " and "), count(groups, shader_check::Severity::Error),
                      count(groups, shader_check::Severity::Warning), report.seconds);
  for (const shader_check::TargetName &target : shader_check::check_targets()) {
    const auto is_chosen = [&](const ShaderReport::Choice &choice) { return choice.target == target.target; };
    const auto first = std::ranges::find_if(report.choices, is_chosen);
    if (first != report.choices.end()) {
      text += line_of(fmt::format("{}: from the files of {} programs; {}: {}", target.text,
                                  std::ranges::count_if(report.choices, is_chosen), first->program, first->reason));
    }
  }
  for (const auto &[target, rules] : left_out(report)) {
    text += line_of(left_out_text(target, rules));
  }
  return text;
}

std::string to_json(const ShaderReport &report)
{
  const std::vector<Group> groups = groups_of(report);
  json messages = json::array();
  for (const Group &group : groups) {
    json places = json::array();
    for (const shader_check::CheckMessage *m : group.all) {
      places.push_back({{"shader", m->shader}, {"variant", m->variant}, {"target", to_string(m->target)}});
    }
    const shader_check::CheckMessage &m = *group.first;
    json message = {{"severity", to_string(m.severity)},
                    {"file", m.file},
                    {"text", m.text},
                    {"rule", m.rule},
                    {"where", std::move(places)}};
    if (m.line > 0) {
      message["line"] = m.line;
    }
    if (m.column > 0) {
      message["column"] = m.column;
    }
    messages.push_back(std::move(message));
  }
  json choices = json::array();
  for (const ShaderReport::Choice &choice : report.choices) {
    choices.push_back({{"program", choice.program}, {"target", to_string(choice.target)}, {"reason", choice.reason}});
  }
  json not_checked = json::array();
  for (const auto &[target, rules] : left_out(report)) {
    not_checked.push_back({{"target", target}, {"rules", rules}});
  }
  return dump({{"programs", report.program_count},
               {"variants", report.variant_count},
               {"errors", count(groups, shader_check::Severity::Error)},
               {"warnings", count(groups, shader_check::Severity::Warning)},
               {"seconds", report.seconds},
               {"targets", std::move(choices)},
               {"not_checked", std::move(not_checked)},
               {"messages", std::move(messages)}});
}

std::string to_sarif(const ShaderReport &report)
{
  json rules = json::array();
  for (const shader_check::CheckRule &rule : shader_check::check_rules()) {
    rules.push_back({{"id", rule.name}, {"shortDescription", {{"text", rule.purpose}}}});
  }
  json results = json::array();
  for (const Group &group : groups_of(report)) {
    const shader_check::CheckMessage &m = *group.first;
    json place = {{"artifactLocation", {{"uri", uri(m.file)}}}};
    if (m.line > 0) {
      place["region"]["startLine"] = m.line;
    }
    if (m.line > 0 && m.column > 0) {
      place["region"]["startColumn"] = m.column;
    }
    results.push_back({{"ruleId", m.rule},
                       {"level", to_string(m.severity)},
                       {"message", {{"text", fmt::format("{} ({})", m.text, where(group))}}},
                       {"locations", json::array({json{{"physicalLocation", std::move(place)}}})}});
  }
  json notes = json::array();
  for (const auto &[target, names] : left_out(report)) {
    notes.push_back({{"level", "note"}, {"message", {{"text", left_out_text(target, names)}}}});
  }
  const json invocation = {{"executionSuccessful", true}, {"toolExecutionNotifications", std::move(notes)}};
  const json driver = {{"name", "gnomon shaders check"}, {"version", GNOMON_VERSION}, {"rules", std::move(rules)}};
  return dump({{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
               {"version", "2.1.0"},
               {"runs", json::array({json{{"tool", {{"driver", driver}}},
                                          {"invocations", json::array({invocation})},
                                          {"results", std::move(results)}}})}});
}

}  // namespace gnomon::cli
