// SPDX-License-Identifier: MIT
#include "shader_check_log.hh"

#include "gpu_shader_text.hh"
#include "shader_check_mangled.hh"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace gnomon::shader_check {

namespace {

constexpr std::size_t message_bytes_max = 400;

std::string_view without_space_at_end(std::string_view text)
{
  return text.substr(0, text.find_last_not_of(" \t\r\n\v\f") + 1);
}

/** \a text without the `highp` before types, which glslang adds for Vulkan. */
std::string without_precision(std::string_view text)
{
  constexpr std::string_view precision = "highp ";
  std::string result;
  std::size_t from = 0;
  for (std::size_t at = text.find(precision); at != std::string_view::npos; at = text.find(precision, from)) {
    const bool is_word = at == 0 || !gpu::is_word_character(text[at - 1]);
    result += text.substr(from, at - from + (is_word ? 0 : precision.size()));
    from = at + precision.size();
  }
  return result += text.substr(from);
}

/** Takes `ERROR: ` or `WARNING: `, with or without a word before it. */
std::optional<Severity> take_severity(gpu::TextScanner &scanner)
{
  if (scanner.take("WARNING: ")) {
    return Severity::Warning;
  }
  for (const std::string_view mark : {"ERROR: ", "INTERNAL ERROR: ", "UNIMPLEMENTED: "}) {
    if (scanner.take(mark)) {
      return Severity::Error;
    }
  }
  return std::nullopt;
}

/** Takes `:LINE: ` or `:LINE:COLUMN: `. \return the line, which may be negative, and the column, 0: none */
std::optional<std::pair<int, int>> take_line(gpu::TextScanner &scanner)
{
  if (!scanner.take(":")) {
    return std::nullopt;
  }
  // The absolute value of the least number is no int, so the sign is read with it.
  int number = 0;
  const std::string_view rest = scanner.rest();
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error != std::errc()) {
    return std::nullopt;
  }
  scanner = gpu::TextScanner(rest.substr(std::size_t(end - rest.data())));
  if (scanner.take(": ")) {
    return std::pair(number, 0);
  }
  const std::optional<int> column = scanner.take(":") ? scanner.take_number() : std::nullopt;
  return column && scanner.take(": ") ? std::optional(std::pair(number, *column)) : std::nullopt;
}

/** A number of errors, which the messages themselves show. */
bool is_count(std::string_view text)
{
  gpu::TextScanner scanner(text);
  return scanner.take_number() && scanner.take(" compilation errors");
}

/** The line of the preamble that glslang's message names; empty: it has no such line. */
std::string_view define_at(const StageSource &source, int line)
{
  std::string_view rest = source.preamble();
  for (; line > 1 && rest.find('\n') != std::string_view::npos; line--) {
    rest.remove_prefix(rest.find('\n') + 1);
  }
  return rest.substr(0, rest.find('\n'));
}

/** `ERROR: NAME:LINE: TEXT` or, about the version, `ERROR: TEXT`. */
std::optional<CompileMessage> compile_message(std::string_view line, StageSource &source)
{
  gpu::TextScanner scanner(line);
  const std::optional<Severity> severity = take_severity(scanner);
  if (!severity || is_count(scanner.rest())) {
    return std::nullopt;
  }
  const std::string_view rest = scanner.rest();
  for (std::size_t at = rest.find(':'); at != std::string_view::npos; at = rest.find(':', at + 1)) {
    gpu::TextScanner behind(rest.substr(at));
    const auto place = take_line(behind);
    // The preamble has the number -1. glslang also reads a too great number of a file in a `#line` as -1.
    const std::string_view define =
        place && rest.substr(0, at) == "-1" ? define_at(source, place->first) : std::string_view();
    if (!define.empty()) {
      return CompileMessage{
          *severity, "compile", {}, fmt::format("'{}': {}", define, without_space_at_end(behind.rest()))};
    }
    if (place) {
      return CompileMessage{*severity, "compile", source.position(rest.substr(0, at), place->first, place->second),
                            without_precision(without_space_at_end(behind.rest()))};
    }
  }
  const SourcePosition version{0, version_in(source.text()).value_or(Version()).line, 0};
  return CompileMessage{*severity, "compile", version, std::string(without_space_at_end(rest))};
}

/** \a text with the names of files for ours. */
std::string with_file_names(std::string_view text, const StageSource &source)
{
  std::string result;
  for (std::size_t mark = text.find(name_mark); mark != std::string_view::npos; mark = text.find(name_mark)) {
    result += text.substr(0, mark);
    const std::size_t end = std::min(text.find_first_not_of("0123456789", mark + 1), text.size());
    const std::optional<std::size_t> file = file_named(text.substr(mark, end - mark));
    result += file && *file < source.files().size() ? source.files()[*file] : "";
    text.remove_prefix(end);
  }
  return result += text;
}

/** Gives messages that are our own their texts and rules: of an include that failed, or a limit. */
void name_rule(CompileMessage &message)
{
  constexpr std::string_view start = "'#include' : ";
  const std::size_t end = message.text.find(" for header name: ");
  if (message.text.starts_with(start) && end != std::string::npos) {
    message.text = message.text.substr(start.size(), end - start.size());
    message.rule = "include";
  }
  if (message.text == too_long_text()) {
    message.rule = "limit";
  }
}

/** Whether the message only follows from an earlier error. */
bool is_consequence(const CompileMessage &message)
{
  return message.text.starts_with("'' : compilation terminated") || message.text.starts_with("'' : missing #endif");
}

}  // namespace

std::string bounded(std::string_view text)
{
  if (text.size() <= message_bytes_max) {
    return std::string(text);
  }
  std::size_t end = message_bytes_max;
  // Do not split a UTF-8 character.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
    end--;
  }
  return fmt::format("{}… ({} bytes)", text.substr(0, end), text.size());
}

std::string bounded_lines(std::string_view text)
{
  std::istringstream lines{std::string(text)};
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    result += bounded(line) + "\n";
  }
  return result;
}

std::vector<CompileMessage> compile_messages(std::string_view log, StageSource &source)
{
  std::vector<CompileMessage> messages;
  std::istringstream lines{std::string(log)};
  for (std::string line; std::getline(lines, line);) {
    if (std::optional<CompileMessage> message = compile_message(line, source)) {
      name_rule(*message);
      message->text = with_file_names(message->text, source);
      messages.push_back(std::move(*message));
    }
    else if (!messages.empty() && !line.empty() && !line.starts_with("ERROR: ")) {
      // The rest of a message of several lines.
      messages.back().text += fmt::format(" {}", gpu::TextScanner(line).skip_space().rest());
    }
  }
  const bool has_cause = std::ranges::any_of(messages, [](const CompileMessage &message) {
    return message.severity == Severity::Error && !is_consequence(message);
  });
  if (has_cause) {
    std::erase_if(messages, is_consequence);
  }
  return messages;
}

std::vector<LinkMessage> link_messages(std::string_view log)
{
  // `ERROR: Linking STAGE stage: TEXT`, followed by lines about the same mistake.
  std::vector<LinkMessage> messages;
  std::istringstream lines{std::string(log)};
  for (std::string line; std::getline(lines, line);) {
    gpu::TextScanner scanner(line);
    const std::optional<Severity> severity = take_severity(scanner);
    // Some of those lines have a severity as well, and are indented.
    if (severity && (messages.empty() || !scanner.rest().starts_with(' '))) {
      messages.push_back({*severity, std::string(without_space_at_end(scanner.rest()))});
    }
    else if (!messages.empty() && !line.empty()) {
      messages.back().text += fmt::format(" {}", without_space_at_end(scanner.skip_space().rest()));
    }
  }
  for (LinkMessage &message : messages) {
    message.text = with_plain_functions(message.text);
    // glslang's name for the uniforms of all stages before.
    for (const auto &[name, plain] :
         {std::pair<std::string_view, std::string_view>("unknown stage stage", "earlier stage"),
          {"unknown stage", "earlier"}}) {
      for (std::size_t at = message.text.find(name); at != std::string::npos; at = message.text.find(name)) {
        message.text.replace(at, name.size(), plain);
      }
    }
  }
  return messages;
}

}  // namespace gnomon::shader_check
