// SPDX-License-Identifier: MIT
#include "eevee_disk_shared.h"

#include <gtest/gtest.h>

namespace gnomon::shared {
namespace {

TEST(VogelDisk, CoversTheDiskEvenly)
{
  // Over the unit disk, the mean of the squared radius is 1/2 and the mean position is the centre.
  vec2 mean(0.0F);
  float mean_square = 0.0F;
  constexpr int count = 32;
  for (int i = 0; i < count; i++) {
    const vec2 tap = vogel_disk(i, count);
    EXPECT_LT(dot(tap, tap), 1.0F);
    mean += tap / float(count);
    mean_square += dot(tap, tap) / float(count);
  }
  EXPECT_NEAR(mean_square, 0.5F, 1e-5F);
  EXPECT_LT(dot(mean, mean), 1e-3F);
}

}  // namespace
}  // namespace gnomon::shared
