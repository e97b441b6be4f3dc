// SPDX-License-Identifier: MIT
#include "gpu_shader_text.hh"

#include <algorithm>
#include <charconv>

namespace gnomon::gpu {

namespace {

constexpr std::string_view white_space = " \t\r\n\v\f";

}  // namespace

bool is_word_character(char c)
{
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

TextScanner &TextScanner::skip_space()
{
  rest_.remove_prefix(std::min(rest_.find_first_not_of(white_space), rest_.size()));
  return *this;
}

bool TextScanner::take(std::string_view prefix)
{
  const bool is_there = rest_.starts_with(prefix);
  rest_.remove_prefix(is_there ? prefix.size() : 0);
  return is_there;
}

std::string_view TextScanner::take_word()
{
  const auto end = std::ranges::find_if_not(rest_, is_word_character);
  const std::string_view word = rest_.substr(0, std::size_t(end - rest_.begin()));
  rest_.remove_prefix(word.size());
  return word;
}

std::optional<int> TextScanner::take_number()
{
  int number = 0;
  const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
  if (error != std::errc() || number < 0 || rest_.starts_with('-')) {
    return std::nullopt;
  }
  rest_.remove_prefix(std::size_t(end - rest_.data()));
  return number;
}

bool TextScanner::is_at_end() const
{
  const std::string_view rest = TextScanner(*this).skip_space().rest();
  return rest.empty() || rest.starts_with("//");
}

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

std::string_view directive_of(std::string_view line)
{
  // Asked of every line of every variant, and few lines are directives.
  const std::size_t begin = line.find_first_not_of(white_space);
  return begin < line.size() && line[begin] == '#' ? TextScanner(line.substr(begin + 1)).skip_space().take_word()
                                                   : std::string_view();
}

}  // namespace gnomon::gpu
