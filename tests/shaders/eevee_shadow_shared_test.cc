// SPDX-License-Identifier: MIT
#include "eevee_shadow_shared.h"

#include <gtest/gtest.h>

namespace gnomon::shared {
namespace {

TEST(ShadowLift, GrowsWithTexelAndRounding)
{
  EXPECT_GT(shadow_lift(0.1F, 0.0F, 0.0F), 0.0F);
  EXPECT_GT(shadow_lift(0.1F, 0.1F, 0.0F), shadow_lift(0.1F, 0.0F, 0.0F));
  EXPECT_LT(shadow_lift(0.1F, 0.0F, 0.0F), 0.1F) << "less than a texel: no gap at contact";
}

TEST(GatheredVisibility, IsTheBilinearShareOfLitTexels)
{
  const vec4 receiver(0.5F);
  EXPECT_EQ(gathered_visibility(vec4(0.4F), receiver, {0.3F, 0.6F}), 1.0F);
  EXPECT_EQ(gathered_visibility(vec4(0.6F), receiver, {0.3F, 0.6F}), 0.0F);
  // Equally near is lit: reversed depth, greater or equal.
  EXPECT_EQ(gathered_visibility(receiver, receiver, {0.3F, 0.6F}), 1.0F);
  // Only the right upper texel (second of the gather) lets light through: 0.3 · 0.6.
  EXPECT_FLOAT_EQ(gathered_visibility({0.6F, 0.4F, 0.6F, 0.6F}, receiver, {0.3F, 0.6F}), 0.18F);
}

TEST(CubeFace, LooksAlongItsLargestComponent)
{
  // Ties go to the earlier axis; a face looks at what is in front of it.
  EXPECT_EQ(cube_face({1, 1, 1}), 0);
  EXPECT_EQ(cube_face({-1, 1, 1}), 1);
  EXPECT_EQ(cube_face({0, -2, 2}), 3);
  EXPECT_EQ(cube_face({-0.0F, 0, -1}), 5);
  for (const vec3 &v : {vec3(1, 2, 3), vec3(-4, 2, 3), vec3(1, -5, 3), vec3(1, 1, -1)}) {
    const vec3 p = cube_face_project(cube_face(v), v);
    EXPECT_EQ(p.z, max(max(abs(v.x), abs(v.y)), abs(v.z)));
  }
}

}  // namespace
}  // namespace gnomon::shared
