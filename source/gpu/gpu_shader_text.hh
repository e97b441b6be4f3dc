// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace gnomon::gpu {

/**
 * Reads a line from left to right.
 *
 * Shader lines and compiler messages may be of any length. std::regex recurses once per character and overflows the
 * stack on lines of some 100 KB, so that nothing here uses it.
 */
class TextScanner {
 public:
  /** \a text must outlive this. */
  explicit TextScanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] std::string_view rest() const
  {
    return rest_;
  }
  TextScanner &skip_space();
  /** Skip \a prefix if the rest begins with it; false otherwise. */
  bool take(std::string_view prefix);
  /** Letters, digits and `_`; empty if the rest begins with none. */
  std::string_view take_word();
  /** Decimal digits. Nothing, and no progress, if there are none or if the number exceeds an int. */
  std::optional<int> take_number();
  /** Whether only white space or a `//` comment follows. */
  [[nodiscard]] bool is_at_end() const;

 private:
  std::string_view rest_;
};

/** Whether \a c may stand in an identifier. */
[[nodiscard]] bool is_word_character(char c);

/** The NAME of a line `#NAME …`; empty for all other lines. */
[[nodiscard]] std::string_view directive_of(std::string_view line);

}  // namespace gnomon::gpu
