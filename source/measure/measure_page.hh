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
  /** What a pointer over it is told. */
  std::string label;
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
  /** Joined by a line, in their order; otherwise dots alone. */
  bool is_line = false;
  /** Drawn large, before the others: what the eye should go to. */
  bool is_marked = false;
};

struct ChartAxis {
  /** With the unit. */
  std::string title;
  bool is_logarithmic = true;
};

struct Chart {
  std::string title;
  ChartAxis x;
  ChartAxis y;
  std::vector<ChartSeries> series;
};

/** Pictures of one size, to be compared by a slider between any two of them. */
struct Comparison {
  std::string title;
  struct Picture {
    std::string name;
    /** A PNG file. */
    std::vector<std::byte> png;
  };
  /** The first two are shown at first. */
  std::vector<Picture> pictures;
};

/** Rows as long as the head; what reads as a number is set to the right. */
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/**
 * A page of measurements in one HTML file that needs no other: scripts, styles and pictures are inside it. All text is
 * taken as it is, and not as HTML.
 */
class Page {
 public:
  explicit Page(std::string title);

  void heading(const std::string &text);
  void paragraph(const std::string &text);
  void table(const Table &table);
  void chart(const Chart &chart);
  void compare(const Comparison &comparison);

  /** The whole file. */
  [[nodiscard]] std::string html() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace gnomon::measure
