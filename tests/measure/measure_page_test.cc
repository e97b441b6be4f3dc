// SPDX-License-Identifier: MIT
#include "measure_page.hh"

#include <gtest/gtest.h>

#include <limits>

namespace gnomon::measure {
namespace {

std::size_t count(const std::string &text, const std::string &what)
{
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
    n++;
  }
  return n;
}

TEST(Page, TextIsNotHtml)
{
  Page page("a < b & \"c\"");
  page.heading("<script>");
  page.table({{"<h>"}, {{"<td>"}}});
  page.compare({"<fig>", {{"<img>", {}}}});
  const std::string html = page.html();
  EXPECT_NE(html.find("<title>a &lt; b &amp; &quot;c&quot;</title>"), std::string::npos);
  EXPECT_NE(html.find("<h2>&lt;script&gt;</h2>"), std::string::npos);
  EXPECT_NE(html.find("<th>&lt;h&gt;</th>"), std::string::npos);
  EXPECT_NE(html.find("<td>&lt;td&gt;</td>"), std::string::npos);
  EXPECT_NE(html.find("alt=\"&lt;img&gt;\""), std::string::npos);
}

TEST(Page, ChartLeavesOutPointsThatItsAxesCannotShow)
{
  Page page("title");
  page.chart({"chart",
              {"x", true},
              {"y", false},
              {{"one",
                {{1.0, -2.0, "negative y"},
                 {0.0, 2.0, "no logarithm"},
                 {1.0, std::numeric_limits<double>::quiet_NaN(), "no number"}}}}});
  const std::string html = page.html();
  EXPECT_NE(html.find("negative y"), std::string::npos);
  EXPECT_EQ(html.find("no logarithm"), std::string::npos);
  EXPECT_EQ(html.find("no number"), std::string::npos);
}

TEST(Page, LabelDoesNotEndTheScript)
{
  Page page("title");
  const std::size_t before = count(page.html(), "</script>");
  page.chart({"chart", {"x"}, {"y"}, {{"</script><b>", {{1.0, 1.0, "</script>"}}}}});
  EXPECT_EQ(count(page.html(), "</script>"), before + 1);
}

TEST(Page, NeedsNoOtherFile)
{
  Page page("title");
  page.chart({"chart", {"x"}, {"y"}, {}});
  page.compare({"pictures", {{"one", {std::byte(1), std::byte(2), std::byte(3)}}}});
  const std::string html = page.html();
  EXPECT_NE(html.find("Chart.js v"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,AQID\""), std::string::npos);
  EXPECT_EQ(count(html, "src="), 1U);
  EXPECT_EQ(html.find("<link"), std::string::npos);
}

}  // namespace
}  // namespace gnomon::measure
