// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/** Parsers of scripts and of their arguments. They throw std::runtime_error, which names the line or the invalid word.
 */
namespace gnomon::view {

/** A line of a script: a command and its arguments. */
struct ScriptLine {
  int number = 0;
  std::vector<std::string> words;
};

/**
 * Parse the lines that are not empty. Spaces separate words; a word with spaces stands in double quotes; # starts a
 * comment. \throws std::runtime_error if a quote is not closed
 */
[[nodiscard]] std::vector<ScriptLine> parse_script(std::string_view text);

/** A number with an absolute value of at most scene::number_max. */
[[nodiscard]] double number(const std::string &word);
[[nodiscard]] int integer(const std::string &word, int min, int max);
/** Pixel coordinates, counted from 0. */
[[nodiscard]] glm::ivec2 pixel(const std::string &x, const std::string &y);

/** The index of \a word among \a names. */
template <std::size_t count>
int choice(const std::array<const char *, count> &names, const std::string &word, const char *what)
{
  const auto found = std::ranges::find(names, word, [](const char *name) { return std::string_view(name); });
  if (found == names.end()) {
    throw std::runtime_error(fmt::format("'{}' is no {}", word, what));
  }
  return int(found - names.begin());
}

}  // namespace gnomon::view
