// SPDX-License-Identifier: MIT
#include "eevee_tonemap_shared.h"

#include <gtest/gtest.h>

namespace gnomon::shared {
namespace {

TEST(SrgbEncoded, RisesFromZeroToOne)
{
  EXPECT_EQ(srgb_encoded(0.0F), 0.0F);
  EXPECT_FLOAT_EQ(srgb_encoded(1.0F), 1.0F);
  float before = 0.0F;
  for (int i = 1; i <= 100000; i++) {
    const float encoded = srgb_encoded(float(i) / 100000.0F);
    // The two pieces of the standard differ by 3e-8 where they meet.
    ASSERT_GE(encoded, before - 1e-7F) << i;
    before = encoded;
  }
}

TEST(ViewTransformed, ClipsToTheDisplay)
{
  EXPECT_EQ(view_transformed(vec3(-1, 0.25F, 1e30F), VIEW_TRANSFORM_RAW), vec3(0, 0.25F, 1));
  const vec3 encoded = view_transformed(vec3(-1, 0.25F, 1e30F), VIEW_TRANSFORM_STANDARD);
  EXPECT_EQ(encoded.x, 0.0F);
  EXPECT_EQ(encoded.y, srgb_encoded(0.25F));
  EXPECT_FLOAT_EQ(encoded.z, 1.0F);
}

}  // namespace
}  // namespace gnomon::shared
