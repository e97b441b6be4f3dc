// SPDX-License-Identifier: MIT
#include "measure_page.hh"

#include "image_base64.hh"
#include "internal/page_files.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>
#include <string_view>

namespace gnomon::measure {

namespace {

std::string escaped(std::string_view text)
{
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

bool is_number(const std::string &text)
{
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool is_drawn(const ChartPoint &point, const Chart &chart)
{
  const auto is_on = [](double value, const ChartAxis &axis) {
    return std::isfinite(value) && (!axis.is_logarithmic || value > 0.0);
  };
  return is_on(point.x, chart.x) && is_on(point.y, chart.y);
}

/** JSON for a script element, which a "</" would end. */
std::string embedded(const nlohmann::json &json)
{
  std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 1)) {
    text.replace(at, 2, "<\\/");
  }
  return text;
}

}  // namespace

Page::Page(std::string title) : title_(std::move(title)) {}

void Page::heading(const std::string &text)
{
  body_ += fmt::format("<h2>{}</h2>\n", escaped(text));
}

void Page::paragraph(const std::string &text)
{
  body_ += fmt::format("<p>{}</p>\n", escaped(text));
}

void Page::table(const Table &table)
{
  body_ += "<div class=\"table\"><table>\n<tr>";
  for (const std::string &cell : table.head) {
    body_ += fmt::format("<th>{}</th>", escaped(cell));
  }
  body_ += "</tr>\n";
  for (const std::vector<std::string> &row : table.rows) {
    body_ += "<tr>";
    for (const std::string &cell : row) {
      body_ += fmt::format("<td{}>{}</td>", is_number(cell) ? " class=\"number\"" : "", escaped(cell));
    }
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void Page::chart(const Chart &chart)
{
  nlohmann::json series = nlohmann::json::array();
  for (const ChartSeries &one : chart.series) {
    nlohmann::json points = nlohmann::json::array();
    for (const ChartPoint &point : one.points) {
      if (is_drawn(point, chart)) {
        points.push_back({{"x", point.x}, {"y", point.y}, {"label", point.label}});
      }
    }
    series.push_back({{"name", one.name}, {"points", points}, {"is_line", one.is_line}, {"is_marked", one.is_marked}});
  }
  const auto axis = [](const ChartAxis &one) {
    return nlohmann::json{{"title", one.title}, {"is_logarithmic", one.is_logarithmic}};
  };
  body_ += fmt::format(
      "<figure class=\"chart\"><figcaption>{}</figcaption><div><canvas></canvas></div>"
      "<script type=\"application/json\">{}</script></figure>\n",
      escaped(chart.title), embedded({{"x", axis(chart.x)}, {"y", axis(chart.y)}, {"series", series}}));
}

void Page::compare(const Comparison &comparison)
{
  body_ += fmt::format("<figure class=\"compare\"><figcaption>{}</figcaption>\n", escaped(comparison.title));
  for (const Comparison::Picture &picture : comparison.pictures) {
    const std::span bytes(reinterpret_cast<const unsigned char *>(picture.png.data()), picture.png.size());
    body_ +=
        fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", escaped(picture.name), image::base64(bytes));
  }
  body_ += "</figure>\n";
}

std::string Page::html() const
{
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n",
      escaped(title_));
  std::string scripts;
  for (const std::string_view name : page_files::paths()) {
    const std::string_view text = *page_files::file(name);
    if (name.ends_with(".css")) {
      page += fmt::format("<style>\n{}</style>\n", text);
    }
    else {
      scripts += fmt::format("<script>\n{}</script>\n", text);
    }
  }
  return page + fmt::format("</head>\n<body>\n<h1>{}</h1>\n{}{}</body>\n</html>\n", escaped(title_), body_, scripts);
}

}  // namespace gnomon::measure
