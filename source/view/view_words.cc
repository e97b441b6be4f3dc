// SPDX-License-Identifier: MIT
#include "view_words.hh"

#include "scene_property.hh"

#include <charconv>
#include <cmath>
#include <sstream>

namespace gnomon::view {

std::vector<ScriptLine> parse_script(std::string_view text)
{
  std::vector<ScriptLine> lines;
  // Editors of Windows begin UTF-8 with a byte-order mark.
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  text.remove_prefix(text.starts_with(mark) ? mark.size() : 0);
  std::istringstream input{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(input, line); number++) {
    std::vector<std::string> words;
    for (std::size_t i = 0; i < line.size() && line[i] != '#';) {
      if (line[i] == ' ' || line[i] == '\t' || line[i] == '\r') {
        i++;
        continue;
      }
      const bool is_quoted = line[i] == '"';
      const std::size_t first = is_quoted ? i + 1 : i;
      const std::size_t end = line.find_first_of(is_quoted ? "\"" : " \t\r", first);
      if (is_quoted && end == std::string::npos) {
        throw std::runtime_error(fmt::format("{}: a quote is not closed", number));
      }
      words.push_back(line.substr(first, end - first));
      i = end == std::string::npos ? line.size() : end + 1;
    }
    if (!words.empty()) {
      lines.push_back({number, std::move(words)});
    }
  }
  return lines;
}

double number(const std::string &word)
{
  double value = 0.0;
  const char *end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || after != end || !(std::abs(value) <= scene::number_max)) {
    throw std::runtime_error(fmt::format("'{}' is not a number", word));
  }
  return value;
}

int integer(const std::string &word, int min, int max)
{
  const double value = number(word);
  // A value out of the range of int must not be converted.
  if (value < min || value > max || value != double(int(value))) {
    throw std::runtime_error(fmt::format("'{}' is not an integer from {} to {}", word, min, max));
  }
  return int(value);
}

glm::ivec2 pixel(const std::string &x, const std::string &y)
{
  return {integer(x, 0, 16384), integer(y, 0, 16384)};
}

}  // namespace gnomon::view
