// SPDX-License-Identifier: MIT
#include "eevee_budget_controller.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace gnomon::eevee {
namespace {

constexpr double budget = 0.033;
constexpr std::int64_t pixel_count = 640 * 360;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/** A scene and a device: times of previews and of whole samples. */
struct Machine {
  /** Seconds of edits and depth, of shadows in full size, of a preview's lighting apart from its pixels, of all pixels.
   */
  double fixed = 0.002;
  double shadows = 0.01;
  double lighting = 0.001;
  double pixels = 0.04;
  double write = 0.002;

  [[nodiscard]] double preview(int level, int divisor) const
  {
    return setup(divisor) + rows(level) + write;
  }
  [[nodiscard]] double setup(int divisor) const
  {
    return fixed + shadows / double(divisor * divisor);
  }
  [[nodiscard]] double rows(int level) const
  {
    return lighting + pixels * std::exp2(-level);
  }
};

/** A host that edits the scene before each call. */
std::vector<BudgetController::FirstPlan> edited(BudgetController &controller, const Machine &machine, int calls,
                                                double seconds = budget)
{
  std::vector<BudgetController::FirstPlan> plans;
  for (int i = 0; i < calls; i++) {
    plans.push_back(controller.plan_first(seconds, pixel_count));
    const BudgetController::FirstPlan &plan = plans.back();
    if (plan.is_whole) {
      controller.add_setup(machine.setup(1), true);
      controller.add_rows(machine.rows(0), pixel_count);
    }
    else {
      controller.add_preview(machine.setup(plan.shadow_divisor), machine.rows(plan.level),
                             std::int64_t(double(pixel_count) * std::exp2(-plan.level)));
    }
    controller.add_write(machine.write);
  }
  return plans;
}

double cost(const Machine &machine, const BudgetController::FirstPlan &plan)
{
  return plan.is_whole ? machine.preview(0, 1) : machine.preview(plan.level, plan.shadow_divisor);
}

TEST(BudgetControllerTest, TheCostIsTheLargestOfTheLastFour)
{
  RecentCost<4> recent;
  EXPECT_FALSE(recent.value());
  std::vector<double> added;
  for (int i = 0; i < 40; i++) {
    added.push_back(double((7 * i) % 11));
    recent.add(added.back());
    EXPECT_EQ(*recent.value(), *std::max_element(added.end() - std::min(i + 1, 4), added.end())) << i;
  }
  for (const auto &[added_seconds, expected] :
       {std::pair(nan, 0.0), {-infinite, 0.0}, {-1.0, 0.0}, {infinite, 1000.0}}) {
    RecentCost<4> stiff;
    stiff.add(added_seconds);
    EXPECT_EQ(stiff.value(), expected) << added_seconds;
  }
}

TEST(BudgetControllerTest, PlansSettleAndStayWithinTheBudgetForAnyCosts)
{
  int reduced_count = 0;
  int whole_count = 0;
  for (const double fixed : {0.0, 0.001, 0.004, 0.012, 0.02}) {
    for (const double shadows : {0.0, 0.003, 0.012, 0.05, 0.2}) {
      for (const double lighting : {0.0, 0.001, 0.006}) {
        for (const double pixels : {0.0, 0.002, 0.01, 0.03, 0.1, 0.5, 3.0}) {
          const Machine machine{fixed, shadows, lighting, pixels, 0.001};
          BudgetController controller;
          edited(controller, machine, 80);
          const std::vector<BudgetController::FirstPlan> plans = edited(controller, machine, 200);
          SCOPED_TRACE(testing::Message() << fixed << " " << shadows << " " << lighting << " " << pixels);
          for (const BudgetController::FirstPlan &plan : plans) {
            ASSERT_EQ(plan, plans.front());
          }
          // Even the lowest level may exceed the budget.
          const bool fits = machine.preview(BudgetController::level_max, 8) <= 0.8 * budget;
          EXPECT_TRUE(!fits || cost(machine, plans.front()) <= 0.95 * budget) << cost(machine, plans.front());
          whole_count += plans.front().is_whole ? 1 : 0;
          reduced_count += plans.front().is_whole ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(whole_count, 50);
  EXPECT_GT(reduced_count, 200);
}

TEST(BudgetControllerTest, ARiseIsFollowedAtOnceAndAFallStepByStep)
{
  const Machine fast{.pixels = 0.03};
  Machine slow = fast;
  slow.pixels = 0.24;
  BudgetController controller;
  const BudgetController::FirstPlan before = edited(controller, fast, 60).back();
  ASSERT_FALSE(before.is_whole);
  // One call is too long, and the next is not.
  const std::vector<BudgetController::FirstPlan> risen = edited(controller, slow, 60);
  EXPECT_EQ(risen[0], before);
  for (std::size_t i = 1; i < risen.size(); i++) {
    EXPECT_LE(cost(slow, risen[i]), 0.95 * budget) << i;
  }
  // No call is too long, and the size never falls.
  const std::vector<BudgetController::FirstPlan> fallen = edited(controller, fast, 60);
  for (std::size_t i = 1; i < fallen.size(); i++) {
    EXPECT_LE(cost(fast, fallen[i]), 0.95 * budget) << i;
    EXPECT_LE(fallen[i].level, fallen[i - 1].level) << i;
    EXPECT_GE(fallen[i].level, fallen[i - 1].level - 1) << i;
  }
  EXPECT_EQ(fallen.back(), before);
}

TEST(BudgetControllerTest, CostsThatVaryByATenthDoNotChangeAPlan)
{
  BudgetController controller;
  Machine machine;
  const BudgetController::FirstPlan settled = edited(controller, machine, 60).back();
  int changes = 0;
  for (int i = 0; i < 400; i++) {
    Machine varied = machine;
    const double factor = 1.0 + 0.1 * std::sin(12.9898 * i);
    varied.fixed *= factor;
    varied.shadows *= factor;
    varied.pixels *= factor;
    changes += edited(controller, varied, 1).front() == settled ? 0 : 1;
  }
  EXPECT_EQ(changes, 0);
}

TEST(BudgetControllerTest, ALargerBudgetGivesAPictureThatIsNotSmallerUnlessItsShadowsAreLarger)
{
  for (const Machine &machine : {Machine{}, Machine{.shadows = 0.1}, Machine{.pixels = 1.0}}) {
    BudgetController::FirstPlan smaller{.level = BudgetController::level_max};
    for (double seconds = 0.004; seconds < 4.0; seconds *= 1.3) {
      BudgetController controller;
      const BudgetController::FirstPlan plan = edited(controller, machine, 80, seconds).back();
      EXPECT_TRUE(plan.is_whole || !smaller.is_whole) << seconds;
      EXPECT_TRUE(plan.is_whole || plan.level <= smaller.level || plan.shadow_divisor < smaller.shadow_divisor)
          << seconds;
      smaller = plan;
    }
    EXPECT_TRUE(smaller.is_whole);
  }
}

TEST(BudgetControllerTest, StiffCostsAndBudgetsGivePlansWithinTheLimits)
{
  for (const double seconds : {0.0, 1e-12, -1.0, nan, infinite, 1e-3, 1e30}) {
    for (const double setup : {0.0, -1.0, nan, infinite, 1e-30, 1e30}) {
      for (const double pixel : {0.0, nan, infinite, 1e-30, 1e30}) {
        BudgetController controller;
        for (int i = 0; i < 40; i++) {
          const BudgetController::FirstPlan plan = controller.plan_first(seconds, pixel_count);
          ASSERT_GE(plan.level, 0);
          ASSERT_LE(plan.level, BudgetController::level_max);
          ASSERT_GE(plan.shadow_divisor, 1);
          ASSERT_LE(plan.shadow_divisor, BudgetController::shadow_divisor_max);
          controller.add_preview(setup, pixel, i % 3 == 0 ? 0 : pixel_count);
          controller.add_setup(setup, i % 2 == 0);
          controller.add_rows(pixel, i % 3 == 0 ? 0 : pixel_count);
          controller.add_write(i % 2 == 0 ? pixel : setup);
          for (const int row_count : {1, 7, 362}) {
            for (const bool must_advance : {false, true}) {
              const int rows = controller.plan_rows(seconds, setup, 642, row_count, row_count, must_advance);
              ASSERT_GE(rows, must_advance ? 1 : 0);
              ASSERT_LE(rows, row_count);
            }
          }
        }
      }
    }
  }
}

TEST(BudgetControllerTest, APictureThatTakesNoTimeIsDrawnWhole)
{
  BudgetController controller;
  EXPECT_TRUE(edited(controller, {0.0, 0.0, 0.0, 0.0, 0.0}, 40).back().is_whole);
}

TEST(BudgetControllerTest, TheRowsOfACallFitIntoItsRest)
{
  BudgetController controller;
  EXPECT_EQ(controller.plan_rows(budget, 0.0, 640, 360, 360, false), 45) << "an eighth, as long as no time is known";
  controller.add_write(0.001);
  controller.add_rows(0.072, 640 * 360);
  for (const double spent : {0.0, 0.01, 0.02, 0.025, 0.028, 0.0287, 0.05}) {
    const int rows = controller.plan_rows(budget, spent, 640, 360, 360, false);
    const double left = 0.85 * budget - spent - 0.001;
    EXPECT_LE(rows * 0.0002, std::max(left, 0.0) + 1e-12) << spent;
    EXPECT_TRUE(left < 0.0 || (rows + 1) * 0.0002 > left - 1e-12) << spent;
    // A sample ends after at most 16 calls.
    EXPECT_GE(controller.plan_rows(budget, spent, 640, 360, 360, true), 23) << spent;
  }
  EXPECT_EQ(controller.plan_rows(10.0, 0.0, 640, 360, 360, false), 360);
}

TEST(BudgetControllerTest, ThePartsOfShadowsOfACallFitIntoItsRest)
{
  BudgetController controller;
  EXPECT_FALSE(controller.fits_beginning(0.01, 0.0)) << "its time is not known";
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 0.0, 5, false), 1) << "the time of a part is not known";
  controller.add_beginning(0.004);
  controller.add_shadow_parts(0.006, 3);
  controller.add_write(0.001);
  // 0.85 of the budget, without the writing: 7.5 ms.
  EXPECT_TRUE(controller.fits_beginning(0.01, 0.0034));
  EXPECT_FALSE(controller.fits_beginning(0.01, 0.0036));
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 0.0001, 5, false), 3);
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 0.0034, 5, false), 2);
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 0.0074, 5, false), 0);
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 0.0074, 5, true), 1);
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 1.0, 5, true), 1);
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 1.0, 5, false), 0);
  // With many parts, plan a sixteenth.
  EXPECT_EQ(controller.plan_shadow_parts(0.01, 1.0, 348, true), 22);
  EXPECT_EQ(controller.plan_rows(0.01, 1.0, 640, 7, 360, true), 7);
}

TEST(BudgetControllerTest, SizesAreThoseOfTheLevelsAndNeverEmpty)
{
  EXPECT_EQ(BudgetController::size_at(0, {641, 359}), glm::ivec2(641, 359));
  EXPECT_EQ(BudgetController::size_at(2, {640, 360}), glm::ivec2(320, 180));
  EXPECT_EQ(BudgetController::size_at(BudgetController::level_max, {640, 360}), glm::ivec2(40, 23));
  EXPECT_EQ(BudgetController::size_at(BudgetController::level_max, {1, 3}), glm::ivec2(1, 1));
}

}  // namespace
}  // namespace gnomon::eevee
