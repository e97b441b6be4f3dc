// SPDX-License-Identifier: MIT
#include "output_text.hh"

#include <algorithm>
#include <cstddef>

namespace gnomon::output {

namespace {

/** The size of the UTF-8 character that \a text begins with. 0: it begins with none. \a code: receives it */
std::size_t character_size(std::string_view text, char32_t &code)
{
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  code = byte(0);
  const std::size_t size = code < 0x80 ? 1 : code < 0xC2 ? 0 : code < 0xE0 ? 2 : code < 0xF0 ? 3 : code < 0xF5 ? 4 : 0;
  if (size > text.size()) {
    return 0;
  }
  if (size > 1) {
    code &= 0xFFU >> (size + 1);
  }
  for (std::size_t i = 1; i < size; i++) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return 0;
    }
    code = code << 6U | (byte(i) & 0x3FU);
  }
  const bool is_overlong = (size == 3 && code < 0x800) || (size == 4 && code < 0x10000);
  const bool is_surrogate = code >= 0xD800 && code < 0xE000;
  return is_overlong || is_surrogate || code > 0x10FFFF ? 0 : size;
}

bool is_obeyed(char32_t code)
{
  const bool is_control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool begins_line = code == 0x2028 || code == 0x2029;
  const bool turns_text = code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x202A && code <= 0x202E) ||
                          (code >= 0x2066 && code <= 0x2069);
  return is_control || begins_line || turns_text;
}

}  // namespace

std::string printable(std::string_view name)
{
  std::string result;
  while (!name.empty()) {
    char32_t code = 0;
    const std::size_t size = character_size(name, code);
    result += size == 0 || is_obeyed(code) ? "?" : name.substr(0, size);
    name.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return result;
}

std::string printable_text(std::string_view text, std::string_view indent)
{
  std::string result;
  for (;;) {
    const std::size_t end = text.find_first_of("\n\t");
    result += printable(text.substr(0, end));
    if (end == text.npos) {
      return result;
    }
    result += text[end];
    text.remove_prefix(end + 1);
    if (result.back() == '\n' && !text.empty()) {
      result += indent;
    }
  }
}

}  // namespace gnomon::output
