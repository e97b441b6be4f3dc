// SPDX-License-Identifier: MIT
#include "eevee_shadow_shared.h"

#include <gtest/gtest.h>

namespace gnomon::shared {
namespace {

TEST(ShadowNormalOffset, GrowsWithTexelKernelAndRounding)
{
  EXPECT_GT(shadow_normal_offset(0.1F, 1.0F, 0.0F, 0.0F), 0.0F);
  EXPECT_GT(shadow_normal_offset(0.1F, 1.0F, 0.1F, 0.0F), shadow_normal_offset(0.1F, 1.0F, 0.0F, 0.0F));
  EXPECT_GT(shadow_normal_offset(0.1F, 3.0F, 0.0F, 0.0F), shadow_normal_offset(0.1F, 1.0F, 0.0F, 0.0F));
  EXPECT_LT(shadow_normal_offset(0.1F, 3.0F, 0.0F, 0.0F), 0.1F) << "less than a texel: no gap at contact";
}

TEST(TexelsLit, AreTheTexelsThatAreNotNearer)
{
  const vec4 receiver(0.5F);
  EXPECT_EQ(texels_lit(vec4(0.4F), receiver), vec4(1.0F));
  EXPECT_EQ(texels_lit(vec4(0.6F), receiver), vec4(0.0F));
  // A receiver at the stored depth is lit (reversed depth: greater or equal).
  EXPECT_EQ(texels_lit(receiver, receiver), vec4(1.0F));
}

TEST(WeightedTexels, FollowTheOrderOfTextureGather)
{
  // Only the upper right texel (second of the gather) is lit: weight 0.3 of the columns and 0.6 of the rows.
  EXPECT_FLOAT_EQ(weighted_texels({0, 1, 0, 0}, {0.7F, 0.3F}, {0.4F, 0.6F}), 0.18F);
}

TEST(CubeFace, LooksAlongItsLargestComponent)
{
  // Ties go to the earlier axis. A face has z above 0 for directions in front of it.
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
