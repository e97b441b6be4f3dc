// SPDX-License-Identifier: MIT
#include "draw_view_transform_shared.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::shared {
namespace {

TEST(SrgbEncoded, RisesFromZeroToOne)
{
  EXPECT_EQ(srgb_encoded(0.0F), 0.0F);
  EXPECT_FLOAT_EQ(srgb_encoded(1.0F), 1.0F);
  float before = 0.0F;
  for (int i = 1; i <= 100000; i++) {
    const float encoded = srgb_encoded(float(i) / 100000.0F);
    // The two parts of the standard's curve differ by 3e-8 where they meet.
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

TEST(ViewTransformed, AgxKeepsMiddleGreyAndGreysGrey)
{
  // The pivot of AgX: 0.18 is encoded as 0.18^(1/2.4). The polynomial is 0.007 off there.
  EXPECT_NEAR(agx_channel(0.18F), std::pow(0.18F, 1.0F / 2.4F), 0.01F);
  for (float light = 1e-4F; light < 1e3F; light *= 1.7F) {
    const vec3 shown = agx(vec3(light));
    EXPECT_NEAR(shown.x, shown.y, 1e-3F) << light;
    EXPECT_NEAR(shown.y, shown.z, 1e-3F) << light;
  }
  // Bright red fades towards white, where a clip would keep it red.
  EXPECT_GT(view_transformed(vec3(100, 0, 0), VIEW_TRANSFORM_AGX).y, 0.5F);
}

TEST(ViewTransformed, PbrNeutralKeepsBaseColors)
{
  // The specification's property: a colour whose smallest channel is F90's 0.04 above the base colour is shown as it
  // is.
  for (const vec3 color : {vec3(0.2F, 0.4F, 0.6F), vec3(0.1F, 0.1F, 0.1F), vec3(0.7F, 0.3F, 0.1F)}) {
    const vec3 shown = pbr_neutral(color + vec3(0.04F));
    EXPECT_NEAR(shown.x, color.x, 1e-6F);
    EXPECT_NEAR(shown.y, color.y, 1e-6F);
    EXPECT_NEAR(shown.z, color.z, 1e-6F);
  }
  EXPECT_LT(pbr_neutral(vec3(1e30F)).x, 1.0001F);
  EXPECT_EQ(pbr_neutral(vec3(0.0F)), vec3(0.0F));
}

}  // namespace
}  // namespace gnomon::shared
