// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace gnomon::eevee {

/** The largest of the last \a Count costs, so that a plan follows a rise at once and a fall after \a Count costs. */
template <int Count>
class RecentCost {
 public:
  /** \a seconds: NaN and less than 0 are 0; at most 1000. */
  void add(double seconds)
  {
    constexpr double most = 1000.0;
    costs_[std::size_t(count_ % Count)] = seconds > 0.0 ? std::min(seconds, most) : 0.0;
    count_ = count_ + 1 < 2 * Count ? count_ + 1 : Count;
  }
  /** Empty before the first add. */
  [[nodiscard]] std::optional<double> value() const
  {
    return count_ == 0 ? std::nullopt
                       : std::optional(*std::max_element(costs_.begin(), costs_.begin() + std::min(count_, Count)));
  }

 private:
  std::array<double, Count> costs_{};
  int count_ = 0;
};

/**
 * Plans a draw call within a time budget, from the times that the last calls took. It uses no clock and
 * no device. All times are in seconds.
 *
 * The first call after an edit draws either a whole sample of the picture, or a preview: one sample in a lower
 * resolution, with smaller shadows. The expected time of a preview is its set-up, plus the time of a pixel times its
 * pixels, plus the time of writing it to the target. Rules, with B = the budget:
 * - more than 0.95 B is expected: the largest size of which at most 0.8 B is expected, or the smallest there is;
 * - at most 0.7 B is expected of the next larger size: that size;
 * - the set-up takes more than 0.5 B, or the smallest size does not fit: shadows of half the edge. The edge is doubled
 *   again if the preview has all pixels and, with four times the set-up, at most 0.7 B is expected of it, and at most
 *   0.4 B of its set-up;
 * - at most 0.7 B is expected of a whole sample: a whole sample, until more than 0.95 B is expected. If its time is not
 *   known, it is expected to be that of a preview with all pixels, with a set-up that grows as the shadows' texels.
 * Where the time of a preview is a constant plus a share for each pixel and each texel of its shadows, a change in one
 * direction is never followed by one in the other: the next larger size takes at most what is expected of it, and
 * shadows of twice the edge take at most four times as long.
 *
 * Later calls draw the picture in parts that fit into 0.85 B: the set-up of a sample, or its depth and then as many
 * parts of its shadows as fit; then as many rows as fit. However slow the machine is, a call draws at least a sixteenth
 * of the parts or of the rows, so that a sample takes at most 33 calls.
 */
class BudgetController {
 public:
  static constexpr double budget_min = 1e-4;
  static constexpr double budget_max = 10.0;
  /** Largest level of a preview. Level 0 has all pixels of the picture, each other one half of those of the last. */
  static constexpr int level_max = 8;
  static constexpr int shadow_divisor_max = 8;

  struct FirstPlan {
    /** Draw a whole sample of the picture; otherwise a preview. */
    bool is_whole = false;
    int level = 0;
    /** The edges of shadows are divided by it: 1, 2, 4 or 8. */
    int shadow_divisor = 1;

    bool operator==(const FirstPlan &) const = default;
  };

  /** Plan the first call after an edit. \a pixel_count: of the picture. A budget out of the range is moved into it. */
  FirstPlan plan_first(double budget, std::int64_t pixel_count);
  /** Expected time of a whole sample after an edit and of writing it to the target. Empty: not known. */
  [[nodiscard]] std::optional<double> whole_seconds(std::int64_t pixel_count) const;
  /** Whether the set-up of a sample is expected to fit into the rest of a call. */
  [[nodiscard]] bool fits_setup(double budget, double spent, bool is_first) const;
  /** Whether the part of the set-up before its shadows is expected to fit into the rest of a call. */
  [[nodiscard]] bool fits_beginning(double budget, double spent) const;
  /**
   * Number of parts of shadows that are expected to fit into the rest of a call. With \a must_advance, it is at least a
   * sixteenth of the \a part_count of the set-up. While no time is known, it is 1.
   */
  [[nodiscard]] int plan_shadow_parts(double budget, double spent, int part_count, bool must_advance) const;
  /**
   * Number of rows that are expected to fit into the rest of a call, at most \a rows_left, of \a row_px pixels each.
   * With \a must_advance, it is at least a sixteenth of the \a row_count of the sample. While no time is known, it is
   * an eighth of \a row_count.
   */
  [[nodiscard]] int plan_rows(double budget, double spent, int row_px, int rows_left, int row_count,
                              bool must_advance) const;

  /** Times of a preview as it was last planned. The first one after a change is not counted: it creates its textures.
   */
  void add_preview(double setup, double rows, std::int64_t pixel_count);
  /** A preview was drawn that was not planned: the next one creates its textures. */
  void skip_preview()
  {
    is_new_ = true;
  }
  /** \a is_first: of the first sample after an edit. */
  void add_setup(double setup, bool is_first);
  void add_beginning(double seconds);
  void add_shadow_parts(double seconds, int part_count);
  void add_rows(double seconds, std::int64_t pixel_count);
  void add_write(double seconds);

  /** Size of a preview in \a level of a picture of \a size_px: at least 1x1. */
  [[nodiscard]] static glm::ivec2 size_at(int level, glm::ivec2 size_px);

 private:
  [[nodiscard]] double expected(int level, double setup, double pixel, std::int64_t pixel_count) const;
  void plan_preview(double budget, std::int64_t pixel_count);

  /** A quarter of the edges: the first previews, whose cost is not known. */
  int level_ = 4;
  int shadow_divisor_ = 2;
  bool is_whole_ = false;
  /** The next times of a preview are those of its creation. */
  bool is_new_ = true;
  RecentCost<4> preview_setup_;
  RecentCost<4> preview_pixel_;
  RecentCost<4> first_setup_;
  RecentCost<4> later_setup_;
  RecentCost<4> beginning_;
  /** A call draws several, of lamps with different costs. */
  RecentCost<16> shadow_part_;
  RecentCost<4> pixel_;
  RecentCost<4> write_;
};

}  // namespace gnomon::eevee
