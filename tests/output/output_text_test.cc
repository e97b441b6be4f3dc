// SPDX-License-Identifier: MIT
#include "output_text.hh"

#include <gtest/gtest.h>

namespace gnomon::output {
namespace {

TEST(OutputText, NamesHaveNoCharactersThatTerminalsObey)
{
  EXPECT_EQ(printable("Lampe \"ü\" 灯 🙂"), "Lampe \"ü\" 灯 🙂");
  EXPECT_EQ(printable("a\x1B[31m\r\n\t\x7F"
                      "b"),
            "a?[31m????b");
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "?x");
  // Controls beyond ASCII: U+0085 and U+009B; lines: U+2028; directions: U+202E and U+2066.
  EXPECT_EQ(printable("\xC2\x85\xC2\x9B\xC2\xA0"), "??\xC2\xA0");
  EXPECT_EQ(printable("\xE2\x80\xA8 \xE2\x80\xAE \xE2\x81\xA6 \xE2\x80\xA6"), "? ? ? \xE2\x80\xA6");
  // No UTF-8: single bytes of another encoding, too long a spelling of '/', half of a pair, beyond Unicode, cut off.
  EXPECT_EQ(printable("Caf\xE9 \x9B"
                      "1m"),
            "Caf? ?1m");
  EXPECT_EQ(printable("\xC0\xAF \xE0\x80\xAF \xED\xA0\x80 \xF4\x90\x80\x80 \xF5 \xE2\x80"), "?? ??? ??? ???? ? ??");
}

TEST(OutputText, TextsKeepTheirLinesAndNoLineButTheFirstLooksLikeAMessage)
{
  EXPECT_EQ(printable_text("a\tb\nc\x1B\n"), "a\tb\nc?\n");
  EXPECT_EQ(printable_text("gnomon: a\ngnomon: b\n\nc\n", "  "), "gnomon: a\n  gnomon: b\n  \n  c\n");
  EXPECT_EQ(printable_text(""), "");
}

}  // namespace
}  // namespace gnomon::output
