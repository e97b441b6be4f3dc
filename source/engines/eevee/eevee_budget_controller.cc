// SPDX-License-Identifier: MIT
#include "eevee_budget_controller.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Shares of the budget. \see BudgetController */
constexpr double leave_share = 0.95;
constexpr double choose_share = 0.8;
constexpr double enter_share = 0.7;
constexpr double setup_share_max = 0.5;
constexpr double larger_setup_share = 0.4;
constexpr double later_share = 0.85;

double within_limits(double budget)
{
  // Also false for NaN.
  return budget >= BudgetController::budget_min ? std::min(budget, BudgetController::budget_max)
                                                : BudgetController::budget_min;
}

}  // namespace

glm::ivec2 BudgetController::size_at(int level, glm::ivec2 size_px)
{
  return glm::max(glm::ivec2(glm::round(glm::dvec2(size_px) * std::exp2(-0.5 * level))), 1);
}

double BudgetController::expected(int level, double setup, double pixel, std::int64_t pixel_count) const
{
  return setup + pixel * double(pixel_count) * std::exp2(-level) + write_.value().value_or(0.0);
}

std::optional<double> BudgetController::whole_seconds(std::int64_t pixel_count) const
{
  const std::optional<double> setup = first_setup_.value();
  const std::optional<double> pixel = pixel_.value();
  return setup && pixel ? std::optional(expected(0, *setup, *pixel, pixel_count)) : std::nullopt;
}

BudgetController::FirstPlan BudgetController::plan_first(double budget, std::int64_t pixel_count)
{
  budget = within_limits(budget);
  const std::optional<double> whole = whole_seconds(pixel_count);
  if (whole) {
    is_whole_ = *whole <= (is_whole_ ? leave_share : enter_share) * budget;
  }
  else {
    const std::optional<double> setup = preview_setup_.value();
    const double factor = double(shadow_divisor_ * shadow_divisor_);
    is_whole_ = level_ == 0 && setup &&
                expected(0, factor * *setup, preview_pixel_.value().value_or(0.0), pixel_count) <= enter_share * budget;
  }
  if (!is_whole_) {
    plan_preview(budget, pixel_count);
  }
  return {is_whole_, level_, shadow_divisor_};
}

void BudgetController::plan_preview(double budget, std::int64_t pixel_count)
{
  const std::optional<double> known_setup = preview_setup_.value();
  if (!known_setup) {
    return;
  }
  const double setup = *known_setup;
  const double pixel = preview_pixel_.value().value_or(0.0);
  const int level_before = level_;
  const int divisor_before = shadow_divisor_;
  if (expected(level_, setup, pixel, pixel_count) > leave_share * budget) {
    while (level_ < level_max && expected(level_, setup, pixel, pixel_count) > choose_share * budget) {
      level_++;
    }
  }
  else if (level_ > 0 && expected(level_ - 1, setup, pixel, pixel_count) <= enter_share * budget) {
    level_--;
  }
  const bool fits = expected(level_, setup, pixel, pixel_count) <= leave_share * budget;
  const double larger_setup = 4.0 * setup;
  if ((setup > setup_share_max * budget || !fits) && shadow_divisor_ < shadow_divisor_max) {
    shadow_divisor_ *= 2;
  }
  else if (level_ == 0 && shadow_divisor_ > 1 && larger_setup <= larger_setup_share * budget &&
           expected(0, larger_setup, pixel, pixel_count) <= enter_share * budget) {
    shadow_divisor_ /= 2;
  }
  if (shadow_divisor_ != divisor_before) {
    preview_setup_ = {};
  }
  is_new_ = is_new_ || level_ != level_before || shadow_divisor_ != divisor_before;
}

bool BudgetController::fits_setup(double budget, double spent, bool is_first) const
{
  const std::optional<double> setup = (is_first ? first_setup_ : later_setup_).value();
  return setup && spent + *setup + write_.value().value_or(0.0) <= later_share * within_limits(budget);
}

bool BudgetController::fits_beginning(double budget, double spent) const
{
  const std::optional<double> beginning = beginning_.value();
  return beginning && spent + *beginning + write_.value().value_or(0.0) <= later_share * within_limits(budget);
}

/** A sixteenth of \a count, rounded up. */
static int least_of(int count, bool must_advance)
{
  return must_advance ? std::max((count + 15) / 16, 1) : 0;
}

int BudgetController::plan_shadow_parts(double budget, double spent, int part_count, bool must_advance) const
{
  const int least = least_of(part_count, must_advance);
  const double left = later_share * within_limits(budget) - spent - write_.value().value_or(0.0);
  const std::optional<double> part = shadow_part_.value();
  if (!part || !(left > 0.0)) {
    return part ? least : std::max(least, 1);
  }
  constexpr double most = 1e6;
  return std::max(least, int(std::min(left / std::max(*part, 1e-9), most)));
}

int BudgetController::plan_rows(double budget, double spent, int row_px, int rows_left, int row_count,
                                bool must_advance) const
{
  const int least = std::min(least_of(row_count, must_advance), rows_left);
  const std::optional<double> pixel = pixel_.value();
  if (!pixel) {
    return std::min(std::max(least, (row_count + 7) / 8), rows_left);
  }
  const double left = later_share * within_limits(budget) - spent - write_.value().value_or(0.0);
  const double row = *pixel * double(row_px);
  if (!(left > 0.0)) {
    return least;
  }
  return row * double(rows_left) <= left ? rows_left : std::max(least, int(left / row));
}

void BudgetController::add_preview(double setup, double rows, std::int64_t pixel_count)
{
  if (std::exchange(is_new_, false)) {
    return;
  }
  preview_setup_.add(setup);
  preview_pixel_.add(rows / double(std::max<std::int64_t>(pixel_count, 1)));
}

void BudgetController::add_setup(double setup, bool is_first)
{
  (is_first ? first_setup_ : later_setup_).add(setup);
}

void BudgetController::add_beginning(double seconds)
{
  beginning_.add(seconds);
}

void BudgetController::add_shadow_parts(double seconds, int part_count)
{
  shadow_part_.add(seconds / double(std::max(part_count, 1)));
}

void BudgetController::add_rows(double seconds, std::int64_t pixel_count)
{
  pixel_.add(seconds / double(std::max<std::int64_t>(pixel_count, 1)));
}

void BudgetController::add_write(double seconds)
{
  write_.add(seconds);
}

}  // namespace gnomon::eevee
