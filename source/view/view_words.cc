// SPDX-License-Identifier: MIT
#include "view_words.hh"

#include <charconv>
#include <cmath>

namespace gnomon::view {

double number(const std::string &word)
{
  double value = 0.0;
  const char *end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || after != end || !(std::abs(value) < 1e12)) {
    throw std::runtime_error(fmt::format("'{}' is not a number", word));
  }
  return value;
}

int integer(const std::string &word, int min, int max)
{
  const double value = number(word);
  if (value != double(int(value)) || value < min || value > max) {
    throw std::runtime_error(fmt::format("'{}' is not an integer from {} to {}", word, min, max));
  }
  return int(value);
}

glm::ivec2 pixel(const std::string &x, const std::string &y)
{
  return {integer(x, 0, 16384), integer(y, 0, 16384)};
}

}  // namespace gnomon::view
