// SPDX-License-Identifier: MIT
#include "internal/gltf_json_fault.hh"

#include "internal/gltf_report.hh"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace gnomon::gltf {

namespace {

struct JsonFault {
  std::size_t at = 0;
  std::string found;
};

std::string hexadecimal_byte(char character)
{
  std::array<char, 8> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "0x%02X", unsigned(static_cast<unsigned char>(character)));
  return buffer.data();
}

/** Length of the UTF-8 sequence at the start of \a text (RFC 3629); 0: there is none. */
std::size_t utf8_length(std::string_view text)
{
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : static_cast<unsigned char>(0);
  };
  const auto continues = [&](std::size_t count) {
    for (std::size_t i = 1; i <= count; i++) {
      if ((byte(i) & 0xC0U) != 0x80U) {
        return false;
      }
    }
    return true;
  };
  const unsigned first = byte(0);
  const unsigned second = byte(1);
  if (first < 0x80U) {
    return 1;
  }
  if (first >= 0xC2U && first <= 0xDFU) {
    return continues(1) ? 2 : 0;
  }
  if (first >= 0xE0U && first <= 0xEFU) {
    const bool is_overlong = first == 0xE0U && second < 0xA0U;
    const bool is_surrogate = first == 0xEDU && second > 0x9FU;
    return continues(2) && !is_overlong && !is_surrogate ? 3 : 0;
  }
  if (first >= 0xF0U && first <= 0xF4U) {
    const bool is_out_of_range = (first == 0xF0U && second < 0x90U) || (first == 0xF4U && second > 0x8FU);
    return continues(3) && !is_out_of_range ? 4 : 0;
  }
  return 0;
}

bool is_digit(char character)
{
  return character >= '0' && character <= '9';
}

/** Whether \a token follows the grammar of numbers. */
bool is_number(std::string_view token)
{
  std::size_t i = token.starts_with('-') ? 1 : 0;
  const auto take_digits = [&] {
    const std::size_t first = i;
    while (i < token.size() && is_digit(token[i])) {
      i++;
    }
    return i - first;
  };
  const bool starts_with_zero = i < token.size() && token[i] == '0';
  const std::size_t digit_count = take_digits();
  if (digit_count == 0 || (starts_with_zero && digit_count > 1)) {
    return false;
  }
  if (i < token.size() && token[i] == '.') {
    i++;
    if (take_digits() == 0) {
      return false;
    }
  }
  if (i < token.size() && (token[i] == 'e' || token[i] == 'E')) {
    i++;
    i += i < token.size() && (token[i] == '+' || token[i] == '-') ? 1 : 0;
    if (take_digits() == 0) {
      return false;
    }
  }
  return i == token.size();
}

/** Reads a text from its start to the first fault. */
class JsonScanner {
 public:
  explicit JsonScanner(std::string_view text) : text_(text) {}

  std::optional<JsonFault> scan()
  {
    if (text_.starts_with("\xEF\xBB\xBF")) {
      at_ = 3;
    }
    else if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
      fail(0, "the byte-order mark of UTF-16, and glTF is UTF-8");
    }
    while (!fault_ && step()) {
    }
    return fault_;
  }

 private:
  enum class Expected { Value, ValueOrEnd, Key, KeyOrEnd, Colon, CommaOrEnd, Nothing };

  std::string_view text_;
  std::size_t at_ = 0;
  std::optional<JsonFault> fault_;
  Expected expected_ = Expected::Value;
  /** The bracket that ends each object and array around the place. */
  std::vector<char> ends_;
  /** The comma that was read last. */
  std::size_t comma_ = 0;

  void fail(std::size_t at, std::string found)
  {
    if (!fault_) {
      fault_ = JsonFault{at, std::move(found)};
    }
  }

  [[nodiscard]] char end() const
  {
    return ends_.empty() ? '\0' : ends_.back();
  }

  /** The forms that may stand at the place, for messages. */
  [[nodiscard]] std::string wanted() const
  {
    const std::string end_text = std::string("'") + end() + "'";
    switch (expected_) {
      case Expected::Value: return "a value";
      case Expected::ValueOrEnd: return "a value or " + end_text;
      case Expected::Key: return "a name in double quotes";
      case Expected::KeyOrEnd: return "a name in double quotes or " + end_text;
      case Expected::Colon: return "':'";
      case Expected::CommaOrEnd: return "',' or " + end_text;
      case Expected::Nothing: break;
    }
    return "the end";
  }

  void after_value()
  {
    expected_ = ends_.empty() ? Expected::Nothing : Expected::CommaOrEnd;
  }

  /** \return false at the end of the text. */
  bool step()
  {
    at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
    if (at_ == text_.size()) {
      if (expected_ != Expected::Nothing) {
        fail(at_, "the end of the text, where " + wanted() + " must stand");
      }
      return false;
    }
    const char character = text_[at_];
    const bool is_value = expected_ == Expected::Value || expected_ == Expected::ValueOrEnd;
    const bool is_key = expected_ == Expected::Key || expected_ == Expected::KeyOrEnd;
    if (character == end() &&
        (expected_ == Expected::CommaOrEnd || expected_ == Expected::ValueOrEnd || expected_ == Expected::KeyOrEnd)) {
      ends_.pop_back();
      at_++;
      after_value();
    }
    else if (character == '"' && (is_value || is_key)) {
      read_string();
      after_value();
      expected_ = is_key ? Expected::Colon : expected_;
    }
    else if ((character == '{' || character == '[') && is_value) {
      ends_.push_back(character == '{' ? '}' : ']');
      expected_ = character == '{' ? Expected::KeyOrEnd : Expected::ValueOrEnd;
      at_++;
    }
    else if (character == ':' && expected_ == Expected::Colon) {
      expected_ = Expected::Value;
      at_++;
    }
    else if (character == ',' && expected_ == Expected::CommaOrEnd) {
      comma_ = at_++;
      expected_ = end() == '}' ? Expected::Key : Expected::Value;
    }
    else {
      read_word(is_value);
    }
    return true;
  }

  /** Reads a number, a literal, or an invalid word. */
  void read_word(bool is_value)
  {
    const std::size_t first = at_;
    const char character = text_[first];
    const bool follows_comma = !ends_.empty() && (expected_ == Expected::Key || expected_ == Expected::Value) &&
                               text_.find_first_not_of(" \t\r\n", comma_ + 1) == first && text_[comma_] == ',';
    const std::size_t last = std::min(text_.find_first_of(" \t\r\n,:[]{}\"'/", first), text_.size());
    const std::string_view word = text_.substr(first, std::max<std::size_t>(last - first, 1));
    const std::string quoted_word = "'" + printable(word) + "'";
    if (character == '/' || character == '#') {
      fail(first, "a comment, which JSON does not have");
    }
    else if ((character == '}' || character == ']') && follows_comma && character == end()) {
      fail(comma_, std::string("a comma before '") + character + "', which JSON does not allow");
    }
    else if (character == '\'') {
      fail(first, "a single quote, where " + wanted() + " must stand");
    }
    else if (utf8_length(text_.substr(first)) == 0) {
      fail(first, "the byte " + hexadecimal_byte(character) + ", which is not UTF-8");
    }
    else if (static_cast<unsigned char>(character) < 0x20U) {
      fail(first, "the control character " + hexadecimal_byte(character) + ", where " + wanted() + " must stand");
    }
    else if (is_value && (word == "true" || word == "false" || word == "null")) {
      at_ = last;
      after_value();
    }
    else if (is_value && is_number(word)) {
      check_range(word);
      at_ = last;
      after_value();
    }
    else if (is_value && (is_digit(character) || character == '-' || character == '+' || character == '.')) {
      fail(first, quoted_word + ", which is no number of JSON");
    }
    else if (is_value && (word == "NaN" || word == "nan" || word == "Infinity" || word == "inf")) {
      fail(first, quoted_word + ", which is no number of JSON");
    }
    else {
      fail(first, quoted_word + ", where " + wanted() + " must stand");
    }
  }

  void check_range(std::string_view number)
  {
    double value = 0.0;
    const auto [after, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    // Numbers too small for a double are read as 0.
    const bool is_small = number.find("e-") != number.npos || number.find("E-") != number.npos;
    if (error == std::errc::result_out_of_range && !is_small) {
      fail(at_, "'" + printable(number) + "', a number too large for a double");
    }
  }

  void read_string()
  {
    const std::size_t first = at_++;
    while (at_ < text_.size() && text_[at_] != '"') {
      const char character = text_[at_];
      if (character == '\\') {
        read_escape();
      }
      else if (static_cast<unsigned char>(character) < 0x20U) {
        fail(at_, "the control character " + hexadecimal_byte(character) + " in a string, where an escape must stand");
      }
      else if (const std::size_t length = utf8_length(text_.substr(at_)); length == 0) {
        fail(at_, "the byte " + hexadecimal_byte(character) + " in a string that is not UTF-8");
      }
      else {
        at_ += length;
      }
      if (fault_) {
        return;
      }
    }
    if (at_ == text_.size()) {
      fail(first, "a string without an end");
      return;
    }
    at_++;
  }

  /** The number of four hexadecimal digits at \a at. */
  [[nodiscard]] std::optional<unsigned> code_at(std::size_t at) const
  {
    const std::string_view digits = text_.substr(std::min(at, text_.size())).substr(0, 4);
    unsigned code = 0;
    const auto [after, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    const bool is_read = error == std::errc() && digits.size() == 4 && after == digits.data() + 4;
    return is_read ? std::optional(code) : std::nullopt;
  }

  void read_escape()
  {
    constexpr std::string_view single = "\"\\/bfnrt";
    const char escaped = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
    if (escaped != '\0' && single.find(escaped) != single.npos) {
      at_ += 2;
      return;
    }
    const std::optional<unsigned> code = escaped == 'u' ? code_at(at_ + 2) : std::nullopt;
    if (!code) {
      fail(at_, "'" + printable(text_.substr(at_, escaped == 'u' ? 6 : 2)) + "', which is no escape of JSON");
      return;
    }
    const bool is_high = *code >= 0xD800U && *code <= 0xDBFFU;
    const bool is_low = *code >= 0xDC00U && *code <= 0xDFFFU;
    // 0, which is no half of a pair, where none follows.
    const unsigned second = text_.substr(at_ + 6).starts_with("\\u") ? code_at(at_ + 8).value_or(0) : 0;
    const bool is_pair = is_high && second >= 0xDC00U && second <= 0xDFFFU;
    if (is_low || (is_high && !is_pair)) {
      fail(at_, "'" + printable(text_.substr(at_, 6)) + "', half of a surrogate pair");
      return;
    }
    at_ += is_pair ? 12 : 6;
  }
};

}  // namespace

std::string json_fault(std::string_view text)
{
  const std::optional<JsonFault> fault = JsonScanner(text).scan();
  if (!fault) {
    return {};
  }
  const std::string_view before = text.substr(0, fault->at);
  // Lines end with \n, \r\n, or, in old files, \r alone.
  std::size_t line = 1;
  std::size_t line_start = 0;
  for (std::size_t i = 0; i < before.size(); i++) {
    if (before[i] == '\n' || (before[i] == '\r' && !text.substr(i).starts_with("\r\n"))) {
      line++;
      line_start = i + 1;
    }
  }
  return "line " + std::to_string(line) + ", column " + std::to_string(fault->at - line_start + 1) + " (byte " +
         std::to_string(fault->at) + "): found " + fault->found;
}

}  // namespace gnomon::gltf
