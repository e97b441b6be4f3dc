// SPDX-License-Identifier: MIT
#include "shader_check_log.hh"

#include "gpu_shader_text.hh"

#include <algorithm>
#include <sstream>

namespace gnomon::shader_check {

namespace {

constexpr std::size_t message_bytes_max = 400;

std::string_view without_space_at_end(std::string_view text)
{
  return text.substr(0, text.find_last_not_of(" \t\r\n\v\f") + 1);
}

/** \a text without `highp`, which glslang adds for Vulkan and our sources do not contain. */
std::string without_precision(std::string_view text)
{
  constexpr std::string_view precision = "highp";
  std::string result;
  std::size_t from = 0;
  for (std::size_t at = find_word(text, precision); at != std::string_view::npos;
       at = find_word(text, precision, from)) {
    result += text.substr(from, at - from);
    from = std::min(at + precision.size() + 1, text.size());
  }
  return result += text.substr(from);
}

/** `ERROR: FILE:LINE: TEXT`, FILE a number. */
std::optional<CompileMessage> compile_message(std::string_view line)
{
  gpu::TextScanner scanner(line);
  const bool is_error = scanner.take("ERROR: ");
  if (!is_error && !scanner.take("WARNING: ")) {
    return std::nullopt;
  }
  const std::optional<int> file = scanner.take_number();
  const bool has_colon = scanner.take(":");
  const std::optional<int> number = scanner.take_number();
  if (!file || !has_colon || !number || !scanner.take(": ")) {
    return std::nullopt;
  }
  return CompileMessage{is_error ? Severity::Error : Severity::Warning,
                        {std::size_t(*file), *number},
                        without_precision(without_space_at_end(scanner.rest()))};
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

std::vector<CompileMessage> compile_messages(std::string_view log)
{
  std::vector<CompileMessage> messages;
  std::istringstream lines{std::string(log)};
  for (std::string line; std::getline(lines, line);) {
    if (std::optional<CompileMessage> message = compile_message(line)) {
      messages.push_back(std::move(*message));
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
  // `ERROR: Linking STAGE stage: TEXT`, followed by indented lines that begin with the name of the faulty declaration.
  std::vector<LinkMessage> messages;
  std::istringstream lines{std::string(log)};
  for (std::string line; std::getline(lines, line);) {
    gpu::TextScanner scanner(line);
    if (scanner.take("ERROR: ")) {
      messages.push_back({std::string(without_space_at_end(scanner.rest())), ""});
    }
    else if (!messages.empty() && !line.empty()) {
      LinkMessage &message = messages.back();
      const bool is_indented = line.front() == ' ' || line.front() == '\t';
      const std::string_view text = scanner.skip_space().rest();
      message.text += fmt::format(" {}", text);
      if (message.name.empty() && is_indented) {
        message.name = scanner.take_word();
      }
    }
  }
  return messages;
}

}  // namespace gnomon::shader_check
