// SPDX-License-Identifier: MIT
#include "measure_furnace.hh"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::measure {
namespace {

TEST(WhiteFurnace, WithMultipleScatteringIsWhite)
{
  for (const FurnaceRow &row : white_furnace(128)) {
    // Measured: 2e-3, where the table is interpolated between roughnesses of 0.03 and 0.06.
    EXPECT_NEAR(row.multi.least, 1.0, 5e-3) << row.material << ' ' << row.roughness;
    EXPECT_NEAR(row.multi.largest, 1.0, 5e-3) << row.material << ' ' << row.roughness;
    EXPECT_NEAR(row.multi_sun.least, 1.0, 5e-3) << row.material << ' ' << row.roughness;
    EXPECT_NEAR(row.multi_sun.largest, 1.0, 5e-3) << row.material << ' ' << row.roughness;
  }
}

TEST(WhiteFurnace, WithSingleScatteringOfARoughMetalIsTheClosedForm)
{
  for (const FurnaceRow &row : white_furnace(128)) {
    if (row.material != "metal") {
      continue;
    }
    EXPECT_LE(row.single.largest, 1.0) << row.roughness;
    if (row.roughness == 1.0) {
      // Normals are even over the hemisphere. Towards the normal, 1 - ln 2 is reflected, and at grazing angles more.
      EXPECT_NEAR(row.single.least, 1.0 - std::log(2.0), 1e-3);
      EXPECT_LT(row.single.largest, 0.65);
    }
  }
}

}  // namespace
}  // namespace gnomon::measure
