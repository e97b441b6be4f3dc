// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::gpu {

/**
 * Scans a line from left to right.
 *
 * Lines may have any length. std::regex is not used, because it recurses once per character and overflows the stack on
 * lines of about 100 KB.
 */
class TextScanner {
 public:
  /** \a text must outlive the scanner. */
  explicit TextScanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] std::string_view rest() const
  {
    return rest_;
  }
  TextScanner &skip_space();
  /** Skip \a prefix. \return false, without skipping, if the rest does not begin with it */
  bool take(std::string_view prefix);
  /** Skip and return the leading letters, digits and `_`; may be empty. */
  std::string_view take_word();
  /** Skip and return a decimal number. Skips nothing if there is none or if it exceeds an int. */
  std::optional<int> take_number();
  /** Whether the rest is empty, white space or a `//` comment. */
  [[nodiscard]] bool is_at_end() const;

 private:
  std::string_view rest_;
};

/** Whether \a c is a letter, a digit or `_`. */
[[nodiscard]] bool is_word_character(char c);

/** The lines of \a text without their ends. */
[[nodiscard]] std::vector<std::string_view> lines_of(std::string_view text);

/** Returns NAME for a line `#NAME …`, and an empty string for all other lines. */
[[nodiscard]] std::string_view directive_of(std::string_view line);

}  // namespace gnomon::gpu
