// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gnomon::measure {

/** A point of a plot. Points that are not finite, or not positive on a logarithmic axis, are not drawn. */
struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
  /** Text shown at the pointer. */
  std::string label;
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
  /** Whether a line joins the points in their order; otherwise only dots are drawn. */
  bool is_line = false;
  /** Whether the series is emphasised: large and in front of the others. */
  bool is_marked = false;
};

struct ChartAxis {
  /** Title with the unit. */
  std::string title;
  bool is_logarithmic = true;
};

struct Chart {
  std::string title;
  ChartAxis x;
  ChartAxis y;
  std::vector<ChartSeries> series;
};

/** Pictures of one size. A slider compares any two of them. */
struct Comparison {
  std::string title;
  struct Picture {
    std::string name;
    /** A PNG file. */
    std::vector<std::byte> png;
  };
  /** The first two are shown initially. */
  std::vector<Picture> pictures;
};

/** Rows have as many cells as the head. Numbers are aligned to the right. */
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/**
 * A page of measurements in one self-contained HTML file with its scripts, styles and pictures. All text is escaped.
 */
class Page {
 public:
  explicit Page(std::string title);

  void heading(const std::string &text);
  void paragraph(const std::string &text);
  void table(const Table &table);
  void chart(const Chart &chart);
  void compare(const Comparison &comparison);

  /** The complete file. */
  [[nodiscard]] std::string html() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace gnomon::measure
