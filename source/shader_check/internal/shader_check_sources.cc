// SPDX-License-Identifier: MIT
#include "shader_check_sources.hh"

#include "gpu_shader_text.hh"

#include <algorithm>
#include <limits>
#include <sstream>

namespace gnomon::shader_check {

std::size_t find_word(std::string_view text, std::string_view word, std::size_t from)
{
  for (std::size_t at = text.find(word, from); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !gpu::is_word_character(text[at - 1])) &&
        (end == text.size() || !gpu::is_word_character(text[end]))) {
      return at;
    }
  }
  return std::string_view::npos;
}

namespace {

/**
 * \a line without comments. \a is_in_comment: whether the line begins within a comment; on return, whether it ends
 * within one.
 */
std::string without_comments(std::string_view line, bool &is_in_comment)
{
  // Most lines have no comment.
  if (!is_in_comment && line.find('/') == std::string_view::npos) {
    return std::string(line);
  }
  std::string code;
  for (std::size_t i = 0; i < line.size(); i++) {
    const std::string_view two = line.substr(i, 2);
    if (is_in_comment) {
      if (two == "*/") {
        is_in_comment = false;
        i++;
      }
    }
    else if (two == "/*") {
      is_in_comment = true;
      i++;
    }
    else if (two == "//") {
      break;
    }
    else {
      code += line[i];
    }
  }
  return code;
}

/** The position set by a line `#line LINE FILE` of preprocess(); empty for other lines. */
std::optional<SourcePosition> position_set_by(std::string_view text)
{
  gpu::TextScanner scanner(text);
  if (!scanner.take("#line ")) {
    return std::nullopt;
  }
  const std::optional<int> line = scanner.take_number();
  const bool has_space = scanner.take(" ");
  const std::optional<int> file = scanner.take_number();
  if (!line || !has_space || !file || !scanner.rest().empty()) {
    return std::nullopt;
  }
  return SourcePosition{std::size_t(*file), *line};
}

}  // namespace

SourceLines::SourceLines(const gpu::ShaderSource &source)
{
  std::istringstream stream(source.text);
  SourcePosition position;
  bool is_in_comment = false;
  for (std::string text; std::getline(stream, text);) {
    if (const std::optional<SourcePosition> set = position_set_by(text)) {
      position = *set;
      continue;
    }
    std::string code = without_comments(text, is_in_comment);
    lines_.push_back({position, std::move(text), std::move(code)});
    // A `#line` in the user's source may have any number.
    position.line += position.line < std::numeric_limits<int>::max() ? 1 : 0;
  }
}

std::string_view SourceLines::line(SourcePosition position) const
{
  const auto found = std::ranges::find(lines_, position, &Line::position);
  return found == lines_.end() ? std::string_view() : std::string_view(found->text);
}

SourcePosition SourceLines::find_declaration(std::string_view name, std::string_view keyword) const
{
  const Line *first = nullptr;
  for (const Line &line : lines_) {
    const std::size_t at = find_word(line.code, name);
    if (at == std::string_view::npos) {
      continue;
    }
    if (find_word(std::string_view(line.code).substr(0, at), keyword) != std::string_view::npos) {
      return line.position;
    }
    first = first == nullptr ? &line : first;
  }
  return first == nullptr ? SourcePosition() : first->position;
}

}  // namespace gnomon::shader_check
