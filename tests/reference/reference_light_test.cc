// SPDX-License-Identifier: MIT
#include "reference_light.hh"
#include "reference_test_scene.hh"
#include "reference_visibility.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace gnomon::reference {
namespace {

using scene::LampKind;
using test::add_lamp;
using test::add_rectangle;
using test::lamp_at;
using test::placed;

/** The middle pixel of a picture with so small an angle that it shows one point. */
glm::vec3 seen(const scene::Scene &scene, const scene::PlacedCamera &camera, int sample_count = 4)
{
  const Tracer tracer(scene);
  return direct_light(tracer, camera, {1, 1}, {.sample_count = sample_count}).pixels.front();
}

constexpr float narrow = 1e-6F;

void expect_color(const glm::vec3 &color, const glm::dvec3 &expected, double tolerance)
{
  for (int i = 0; i < 3; i++) {
    EXPECT_NEAR(color[i], expected[i], tolerance * (1e-3 + expected[i]));
  }
}

TEST(DirectLight, LambertianPlaneIsAlbedoOverPiTimesIrradiance)
{
  scene::Scene scene;
  test::add_material(scene, {0.25F, 0.5F, 1.0F});
  add_rectangle(scene, {-10, -10}, {10, 10});
  test::edit_material(scene, [&](scene::Material &material) { material.emissive = {0.0F, 0.0F, 2.0F}; });
  scene::PlacedLamp point = lamp_at(LampKind::Point, {3, 0, 4});
  point.intensity = 5.0F;
  point.color = {1.0F, 0.5F, 0.25F};
  add_lamp(scene, point);
  add_lamp(scene, lamp_at(LampKind::Sun, {0, 0, 0}, {0, 3, -4}));
  add_lamp(scene, lamp_at(LampKind::Hemi, {0, 0, 0}, {0, 3, -4}));
  // A lamp below gives no light, because the plane is opaque.
  add_lamp(scene, lamp_at(LampKind::Point, {0, 0, -1}));
  const glm::dvec3 albedo(0.25, 0.5, 1.0);
  const glm::dvec3 irradiance = 5.0 * 0.8 / 25.0 * glm::dvec3(1.0, 0.5, 0.25) + 0.8 + 0.9;
  // The tolerance covers the float rounding of camera matrices.
  expect_color(seen(scene, test::camera_at({2, 1, 5}, {0, 0, 0}, narrow)),
               albedo * irradiance / std::numbers::pi + glm::dvec3(0, 0, 2), 2e-5);
}

TEST(DirectLight, EmissiveSurfacesLightOthersOnBothSides)
{
  // A square of 1 m², one metre above the ground and one below a ceiling.
  scene::Scene scene;
  test::add_material(scene, glm::vec3(0.5F));
  add_rectangle(scene, {-10, -10}, {10, 10});
  add_rectangle(scene, {-10, -10}, {10, 10}, glm::translate(glm::mat4(1.0F), {0, 0, 2}));
  add_rectangle(scene, {-0.5, -0.5}, {0.5, 0.5}, glm::translate(glm::mat4(1.0F), {0, 0, 1}));
  const auto emitter = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(emitter, [](scene::Material &material) { material.emissive = {4.0F, 2.0F, 1.0F}; });
  const std::vector<scene::Object> objects = scene.objects();
  scene.edit(objects.back().mesh, [&](scene::Mesh &mesh) { mesh.material = emitter; });
  // The form factor of four rectangles that have a corner above the point: A = B = 1/2 in
  // (A / √(1 + A²) atan(B / √(1 + A²)) + B / √(1 + B²) atan(A / √(1 + B²))) / 2π.
  const double a = 0.5 / std::sqrt(1.25);
  const double form_factor = 4.0 / std::numbers::pi * a * std::atan(a);
  const glm::dvec3 expected = 0.5 * form_factor * glm::dvec3(4, 2, 1);
  for (const bool is_ceiling : {false, true}) {
    const glm::vec3 eye(3.0F, 0.0F, is_ceiling ? 0.5F : 1.5F);
    const glm::vec3 target(0.0F, 0.0F, is_ceiling ? 2.0F : 0.0F);
    // 4096 points; the disk that bounds the light near a point takes 3e-4 here.
    expect_color(seen(scene, test::camera_at(eye, target, narrow), 4096), expected, 1e-3);
  }
}

TEST(DirectLight, EmissiveSurfacesNearTheReceiverAreBoundedByDisks)
{
  // Disks of 1/1024 of 1 m², of the radius r. At the height h = r above an endless surface, the irradiance of disks
  // that are turned to the receiver is π radiance (h / r)² log(1 + (r / h)²); 1 - log 2 of the light is left out.
  const double height = std::sqrt(1.0 / (1024.0 * std::numbers::pi));
  scene::Scene scene;
  test::add_material(scene, glm::vec3(0.5F));
  add_rectangle(scene, {-10, -10}, {10, 10});
  // One-sided, it is not seen from above.
  const glm::mat4 turned = glm::rotate(glm::mat4(1.0F), float(std::numbers::pi), {1, 0, 0});
  add_rectangle(scene, {-0.5, -0.5}, {0.5, 0.5}, glm::translate(glm::mat4(1.0F), {0, 0, float(height)}) * turned);
  const auto emitter = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(emitter, [](scene::Material &material) {
    material.emissive = {4.0F, 2.0F, 1.0F};
    material.is_double_sided = false;
  });
  scene.edit(scene.objects().back().mesh, [&](scene::Mesh &mesh) { mesh.material = emitter; });
  // 16384 points, of which about 50 are within 2 r of the pixel.
  expect_color(seen(scene, test::camera_at({0.1F, 0.05F, 3}, {0.1F, 0.05F, 0}, narrow), 16384),
               0.5 * std::numbers::ln2 * glm::dvec3(4, 2, 1), 0.05);
}

TEST(DirectLight, BlendedSurfacesCoverByTheirAlphaAndShadeByIt)
{
  // Three panes over a plane, none of them first in the scene by distance, and one between the plane and the lamp
  // alone.
  scene::Scene scene;
  const auto floor = test::add_material(scene, glm::vec3(0.5F));
  add_rectangle(scene, {-10, -10}, {10, 10});
  const auto add_pane = [&](const glm::vec3 &center, const glm::vec3 &radiance, float alpha) {
    // Unlit, so that it gives the plane no light.
    const auto material = test::add_material(scene, radiance);
    scene.edit(material, [&](scene::Material &value) {
      value.is_unlit = true;
      value.alpha_mode = scene::AlphaMode::Blend;
      value.alpha = alpha;
    });
    scene.edit(add_rectangle(scene, {-0.2F, -0.2F}, {0.2F, 0.2F}, placed(center)),
               [&](scene::Mesh &mesh) { mesh.material = material; });
  };
  add_pane({0, 0, 2}, {1, 0, 0}, 0.25F);
  add_pane({0, 0, 3}, {0, 1, 0}, 0.5F);
  add_pane({0, 0, 1}, {0, 0, 1}, 0.75F);
  add_pane({0, 0, 2.5F}, {1, 1, 1}, 0.0F);
  // The ray to the lamp does not meet the edge between its triangles.
  add_pane({0.05F, 1, 1}, {1, 1, 1}, 0.6F);
  ASSERT_TRUE(scene.materials().is_live(floor));
  // The ray to the lamp meets the last pane alone.
  scene::PlacedLamp lamp = lamp_at(LampKind::Point, {0, 4, 4});
  lamp.intensity = 32.0F * std::numbers::sqrt2_v<float>;
  add_lamp(scene, lamp);
  const double under = 0.5 / std::numbers::pi * 0.4;
  const glm::dvec3 expected =
      0.5 * glm::dvec3(0, 1, 0) +
      0.5 * (0.25 * glm::dvec3(1, 0, 0) + 0.75 * (0.75 * glm::dvec3(0, 0, 1) + 0.25 * glm::dvec3(under)));
  expect_color(seen(scene, test::camera_at({0, 0, 9}, {0, 0, 0}, narrow)), expected, 1e-4);
  const Tracer tracer(scene);
  EXPECT_NEAR(visibility(tracer, receiver_at({0, 0, 0}, {0, 0, 1}), tracer.lamps().front(), 1, 0).mean, 0.4, 1e-7);
  EXPECT_TRUE(is_visible(tracer, receiver_at({0, 0, 0}, {0, 0, 1}), tracer.lamps().front()));
}

TEST(DirectLight, AWorldOfOneRadianceGivesAPlaneItsAlbedoTimesThat)
{
  scene::Scene scene;
  test::add_material(scene, {0.25F, 0.5F, 1.0F});
  add_rectangle(scene, {-10, -10}, {10, 10});
  scene.set_world(scene::World{.color = {1.0F, 2.0F, 0.0F}});
  expect_color(seen(scene, test::camera_at({2, 1, 5}, {0, 0, 0}, narrow), 4096), {0.25, 1.0, 0.0}, 2e-3);
}

/** A plane of one material, of which the cameras of the tests of multiple scattering see one point. */
scene::Scene plane_of(const glm::vec3 &color, float metallic, float roughness)
{
  scene::Scene scene;
  test::add_material(scene, color);
  test::edit_material(scene, [&](scene::Material &material) {
    material.specular_color = glm::vec3(1.0F);
    material.metallic = metallic;
    material.roughness = roughness;
  });
  add_rectangle(scene, {-10, -10}, {10, 10});
  return scene;
}

TEST(DirectLight, WhiteFurnaceWithMultipleScattering)
{
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.03F, 0.2F, 0.6F, 1.0F}) {
      scene::Scene scene = plane_of(glm::vec3(1.0F), metallic, roughness);
      scene.set_world(scene::World{});
      const Tracer tracer(scene);
      for (const float angle : {0.0F, 1.0F, 1.4F}) {
        const auto camera = test::camera_at({5.0F * std::sin(angle), 0.0F, 5.0F * std::cos(angle)}, {0, 0, 0}, narrow);
        const auto picture = direct_light(tracer, camera, {1, 1}, {.sample_count = 4096, .has_multiscatter = true});
        EXPECT_NEAR(picture.pixels.front().r, 1.0F, 5e-3F) << metallic << ' ' << roughness << ' ' << angle;
      }
    }
  }
}

TEST(DirectLight, WithMultipleScatteringIsReciprocal)
{
  const std::array<glm::vec3, 2> directions = {glm::normalize(glm::vec3(0.3F, 0.1F, 1.0F)),
                                               glm::normalize(glm::vec3(-0.2F, 1.0F, 0.3F))};
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.2F, 1.0F}) {
      std::array<glm::vec3, 2> brdfs;
      for (std::size_t i = 0; i < 2; i++) {
        scene::Scene scene = plane_of({1.0F, 0.7F, 0.2F}, metallic, roughness);
        add_lamp(scene, lamp_at(LampKind::Sun, {0, 0, 0}, -directions[i]));
        const auto camera = test::camera_at(5.0F * directions[1 - i], {0, 0, 0}, narrow);
        const auto picture = direct_light(Tracer(scene), camera, {1, 1}, {.sample_count = 1, .has_multiscatter = true});
        brdfs[i] = glm::vec3(picture.pixels.front()) / directions[i].z;
      }
      // The tolerance covers the float rounding of camera matrices.
      expect_color(brdfs[0], glm::dvec3(brdfs[1]), 1e-4);
    }
  }
}

TEST(DirectLight, AWorldsBrightTexelIsASun)
{
  // One texel at azimuth 0 and an elevation of 45°, of solid angle 2.45e-3 sr, blended to those beside it.
  scene::WorldPicture picture{128, 64, std::vector<glm::vec3>(128 * 64, glm::vec3(0.0F))};
  picture.texels[16 * 128 + 64] = glm::vec3(1000.0F);
  scene::Scene scene;
  test::add_material(scene, glm::vec3(1.0F));
  add_rectangle(scene, {-10, -10}, {10, 10});
  scene.set_world(scene::World{.rotation = float(0.5 * std::numbers::pi),
                               .picture = std::make_shared<const scene::WorldPicture>(std::move(picture))});
  // Turned, it is at -Z; the plane faces +Z, and its back is lit.
  const double step = std::numbers::pi / 64.0;
  const double elevation = std::numbers::pi / 2.0 - 16.5 * step;
  const double irradiance = 1000.0 * step * step * std::cos(elevation) * std::cos(elevation);
  const double radiance = irradiance / std::numbers::pi;
  expect_color(seen(scene, test::camera_at({0, 0, -5}, {0, 0, 0}, narrow), 4096), glm::dvec3(radiance), 0.01);
  expect_color(seen(scene, test::camera_at({0, 0, 5}, {0, 0, 0}, narrow), 256), glm::dvec3(0.0), 0.01);
}

TEST(DirectLight, MicrofacetLobeHasItsPeakAtNormalIncidence)
{
  for (const float metallic : {0.0F, 1.0F}) {
    scene::Scene scene;
    test::add_material(scene, {0.9F, 0.5F, 0.1F});
    test::edit_material(scene, [&](scene::Material &material) {
      material.metallic = metallic;
      material.roughness = 0.5F;
      material.specular_color = glm::vec3(1.0F);
    });
    add_rectangle(scene, {-10, -10}, {10, 10});
    add_lamp(scene, lamp_at(LampKind::Sun, {0, 0, 0}));
    // The lobe is D · G / 4 with D = 1 / (π α²) and G = 1. Diffuse light is scaled by 1 - the strongest channel's
    // Fresnel term.
    const double lobe = 1.0 / (4.0 * std::numbers::pi * 0.0625);
    const glm::dvec3 color(0.9, 0.5, 0.1);
    const glm::dvec3 expected = metallic > 0.5F ? color * lobe : color * 0.96 / std::numbers::pi + 0.04 * lobe;
    expect_color(seen(scene, test::camera_at({0, 0, 5}, {0, 0, 0}, narrow)), expected, 2e-5);
  }
}

TEST(DirectLight, MirroredDirectionHasFresnelsAndSmithsFactors)
{
  scene::Scene scene;
  test::add_material(scene, glm::vec3(0.5F));
  test::edit_material(scene, [&](scene::Material &material) {
    material.roughness = 0.5F;
    material.specular_color = glm::vec3(1.0F);
  });
  add_rectangle(scene, {-10, -10}, {10, 10});
  // Light and view are at 60 degrees on both sides of the normal, so the half vector is the normal.
  const float sine = std::sqrt(0.75F);
  add_lamp(scene, lamp_at(LampKind::Sun, {0, 0, 0}, {-sine, 0, -0.5F}));
  const double a2 = 0.0625;
  const double distribution = 1.0 / (std::numbers::pi * a2);
  const double masking = 1.0 / (0.5 + std::sqrt(a2 + (1.0 - a2) * 0.25));
  const double fresnel = 0.04 + 0.96 * std::pow(0.5, 5.0);
  const double expected = 0.5 * (0.5 / std::numbers::pi * (1.0 - fresnel) + fresnel * distribution * masking * masking);
  expect_color(seen(scene, test::camera_at({-5.0F * sine, 0, 2.5F}, {0, 0, 0}, narrow)), glm::dvec3(expected), 2e-5);
}

TEST(DirectLight, NormalsAreInterpolatedAndTurnedToTheViewer)
{
  scene::Scene scene;
  test::add_material(scene, glm::vec3(1.0F));
  add_rectangle(scene, {-1, -1}, {1, 1});
  // Normals are tilted to +x on the right and to -x on the left, and upright in the middle.
  test::edit_mesh(scene, [](scene::Mesh &mesh) {
    for (std::size_t i = 0; i < 6; i++) {
      mesh.normals[i] = glm::normalize(glm::vec3(mesh.positions[i].x, 0, 1));
    }
  });
  add_lamp(scene, lamp_at(LampKind::Sun, {0, 0, 0}));
  add_lamp(scene, lamp_at(LampKind::Sun, {0, 0, 0}, {0, 0, 1}));
  for (const float side : {1.0F, -1.0F}) {
    const glm::vec3 color = seen(scene, test::camera_at({0.5F, 0.25F, side * 3}, {0.5F, 0.25F, 0}, narrow));
    // Interpolated linearly between (0, 1) and (1, 1)/√2, then normalised.
    const double x = 0.5 * std::sqrt(0.5);
    const double z = std::sqrt(0.5);
    expect_color(color, glm::dvec3(z / std::hypot(x, z) / std::numbers::pi), 2e-5);
  }
}

TEST(DirectLight, BacksOfOneSidedMaterialsAreInvisible)
{
  scene::Scene scene;
  test::add_material(scene, glm::vec3(0.0F));
  test::edit_material(scene, [&](scene::Material &material) {
    material.is_double_sided = false;
    material.emissive = glm::vec3(1.0F);
  });
  add_rectangle(scene, {-1, -1}, {1, 1});
  scene::Material brighter = scene.materials()[scene.materials().first()];
  brighter.emissive = glm::vec3(2.0F);
  const auto upper =
      add_rectangle(scene, {-1, -1}, {1, 1}, placed({0, 0, 1}) * glm::scale(glm::mat4(1.0F), glm::vec3(1, 1, -1)));
  const auto material = scene.add(std::move(brighter));
  scene.edit(upper, [&](scene::Mesh &mesh) { mesh.material = material; });
  EXPECT_FLOAT_EQ(seen(scene, test::camera_at({0, 0.5F, 5}, {0, 0.5F, 0}, narrow)).r, 1.0F);
  EXPECT_FLOAT_EQ(seen(scene, test::camera_at({0, 0.5F, -5}, {0, 0.5F, 0}, narrow)).r, 2.0F);
}

TEST(DirectLight, ClipDistancesAreDepths)
{
  scene::Scene scene;
  test::add_material(scene, glm::vec3(1.0F));
  test::edit_material(scene, [&](scene::Material &material) { material.emissive = glm::vec3(1.0F); });
  add_rectangle(scene, {-50, -50}, {50, 50});
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0}, 2.0F);
  for (const auto &[near, far, expected] :
       {std::tuple(3.99F, 4.01F, 1.0F), std::tuple(4.01F, 9.0F, 0.0F), std::tuple(1.0F, 3.99F, 0.0F)}) {
    camera.near = near;
    camera.far = far;
    const Tracer tracer(scene);
    for (const glm::vec4 &pixel : direct_light(tracer, camera, {5, 5}, {}).pixels) {
      EXPECT_EQ(pixel.r, expected);
    }
  }
}

TEST(DirectLight, CamerasFrameIsCentredAndCompletelyVisible)
{
  // A rectangle that exactly fills an orthographic camera of 4 by 2. Images of other aspects show it in the middle.
  scene::Scene scene;
  test::add_material(scene, glm::vec3(1.0F));
  test::edit_material(scene, [&](scene::Material &material) { material.emissive = glm::vec3(1.0F); });
  add_rectangle(scene, {-2, -1}, {2, 1});
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 2.0F;
  camera.half_height = 1.0F;
  const Tracer tracer(scene);
  for (const glm::ivec2 size_px : {glm::ivec2(40, 20), glm::ivec2(40, 40), glm::ivec2(80, 20)}) {
    const Picture picture = direct_light(tracer, camera, size_px, {});
    double area = 0.0;
    for (const glm::vec4 &pixel : picture.pixels) {
      area += pixel.r;
    }
    // The frame is 40 x 20 pixels in each image. At the edge of the picture, the filter spreads some light beyond it.
    EXPECT_NEAR(area, 800.0, 0.03 * 800.0);
    EXPECT_EQ(picture.pixels[std::size_t(size_px.y / 2 * size_px.x + size_px.x / 2)].r, 1.0F);
  }
}

/** Integral of the pixel filter from \a from_edge_px to infinity. */
double filter_integral(double from_edge_px)
{
  const double at = std::clamp(from_edge_px, -1.5, 1.5);
  constexpr std::array<double, 4> terms = {0.35875, 0.48829, 0.14128, 0.01168};
  double integral = 0.5 + at / 3.0;
  for (int i = 1; i < 4; i++) {
    integral += terms[std::size_t(i)] / terms[0] * std::sin(2.0 * std::numbers::pi * i * at / 3.0) /
                (2.0 * std::numbers::pi * i);
  }
  return integral;
}

/** A bright quadrant of a plane with its corner at \a low, one metre a pixel, with the origin in the middle of the
 * picture. */
scene::Scene bright_scene(const glm::vec2 &low, glm::ivec2 size_px)
{
  scene::Scene scene;
  test::add_material(scene, glm::vec3(1.0F));
  test::edit_material(scene, [&](scene::Material &material) { material.emissive = glm::vec3(1.0F); });
  add_rectangle(scene, low, {500, 500});
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 0.5F * float(size_px.x);
  camera.half_height = 0.5F * float(size_px.y);
  test::add_camera(scene, camera);
  return scene;
}

Picture bright_from(const glm::vec2 &low, glm::ivec2 size_px, int sample_count)
{
  const scene::Scene scene = bright_scene(low, size_px);
  const Tracer tracer(scene);
  return direct_light(tracer, scene.placed_cameras()[0], size_px, {.sample_count = sample_count});
}

TEST(DirectLight, PixelFilterIsBlackmanHarrisOfThreePixels)
{
  // An edge between two columns. Each pixel is the integral of the filter beyond the edge.
  const Picture picture = bright_from({0, -500}, {8, 8}, 4096);
  for (int x = 0; x < 8; x++) {
    // The error of evenly placed samples is about one sample.
    EXPECT_NEAR(picture.pixels[std::size_t(4 * 8 + x)].r, filter_integral(x + 0.5 - 4.0), 1e-3) << x;
  }
}

TEST(DirectLight, PixelFilterCrossesTilesAndThePicturesRim)
{
  // Tiles have 64 pixels. The pictures have an edge between two tiles, in both directions, and one just outside the
  // picture.
  const Picture rows = bright_from({-500, 0}, {4, 128}, 256);
  const Picture columns = bright_from({0, -500}, {128, 4}, 256);
  const Picture rim = bright_from({2, -500}, {4, 4}, 256);
  for (int i = 62; i < 66; i++) {
    EXPECT_NEAR(rows.pixels[std::size_t(4 * i + 1)].r, filter_integral(i + 0.5 - 64.0), 1e-2) << i;
    EXPECT_NEAR(columns.pixels[std::size_t(128 + i)].r, filter_integral(i + 0.5 - 64.0), 1e-2) << i;
  }
  EXPECT_NEAR(rim.pixels[7].r, filter_integral(-0.5), 1e-2);
}

TEST(DirectLight, SelectedPixelsHaveTheSameFilter)
{
  // A corner of the plane: the product of the integrals of the filter beyond its two edges.
  const glm::ivec2 size_px{8, 8};
  const scene::Scene scene = bright_scene({0.3F, -1.2F}, size_px);
  const Tracer tracer(scene);
  std::vector<glm::ivec2> pixels;
  for (int y = 0; y < 8; y++) {
    for (int x = 0; x < 8; x++) {
      pixels.emplace_back(x, y);
    }
  }
  const std::vector<glm::vec4> light =
      direct_light(tracer, scene.placed_cameras()[0], size_px, pixels, {.sample_count = 4096, .seed = 1});
  ASSERT_EQ(light.size(), pixels.size());
  for (std::size_t i = 0; i < pixels.size(); i++) {
    const double expected = filter_integral(pixels[i].x + 0.5 - 4.3) * filter_integral(pixels[i].y + 0.5 - 2.8);
    // The error at a corner is two to three times the error at an edge for the same samples.
    EXPECT_NEAR(light[i].r, expected, 3e-3) << pixels[i].x << ", " << pixels[i].y;
  }
}

scene::Scene cluttered_scene()
{
  scene::Scene scene;
  test::add_material(scene, {0.8F, 0.5F, 0.3F});
  test::edit_material(scene, [&](scene::Material &material) { material.specular_color = glm::vec3(1.0F); });
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate(-2.0F, 2.0F);
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 300; i++) {
    const float x = coordinate(random);
    const float y = coordinate(random);
    corners.emplace_back(x, y, coordinate(random));
  }
  test::add_triangles(scene, corners);
  for (const LampKind kind : {LampKind::Point, LampKind::Sun, LampKind::Spot, LampKind::Hemi, LampKind::Area}) {
    scene::PlacedLamp lamp = lamp_at(kind, {0, 0, 3});
    lamp.radius = 0.2F;
    lamp.angle = 0.1F;
    add_lamp(scene, lamp);
  }
  return scene;
}

TEST(DirectLight, ProgressRisesToOneAndAnExceptionFromItEndsTheWork)
{
  scene::Scene scene;
  const Tracer tracer(scene);
  const scene::PlacedCamera camera;
  const glm::ivec2 size_px(200, 10);
  const std::vector<glm::ivec2> pixels(7, glm::ivec2(1));
  for (const bool is_whole : {true, false}) {
    const auto render = [&](const DirectLightSettings &settings) {
      is_whole ? void(direct_light(tracer, camera, size_px, settings))
               : void(direct_light(tracer, camera, size_px, pixels, settings));
    };
    std::vector<double> shares;
    render({.sample_count = 1, .progress = [&](double share_done) { shares.push_back(share_done); }});
    ASSERT_EQ(shares.size(), is_whole ? 4U : 7U);
    EXPECT_TRUE(std::ranges::is_sorted(shares));
    EXPECT_EQ(shares.back(), 1.0);
    EXPECT_THROW(render({.sample_count = 1, .progress = [](double) { throw std::domain_error("enough"); }}),
                 std::domain_error);
  }
}

TEST(DirectLight, PictureDependsOnTheSeedAndNotOnThreads)
{
  const scene::Scene scene = cluttered_scene();
  const Tracer tracer(scene);
  const scene::PlacedCamera camera = test::camera_at({5, 4, 3}, {0, 0, 0});
  double share = 0.0;
  const auto render = [&](unsigned threads, std::uint64_t seed) {
    return direct_light(tracer, camera, {150, 90},
                        {.sample_count = 2, .seed = seed, .thread_count = threads, .progress = [&](double done) {
                           EXPECT_GT(done, share);
                           share = done;
                         }});
  };
  const Picture one = render(1, 1);
  EXPECT_EQ(share, 1.0);
  share = 0.0;
  EXPECT_EQ(one.pixels, render(7, 1).pixels);
  share = 0.0;
  EXPECT_NE(one.pixels, render(1, 2).pixels);
}

TEST(DirectLight, IsFiniteInsideOfGeometryAndAtLamps)
{
  scene::Scene scene = cluttered_scene();
  test::edit_material(scene, [&](scene::Material &material) {
    material.roughness = 0.0F;
    material.metallic = 1.0F;
  });
  // Normals unrelated to the surface, and some of length zero.
  test::edit_mesh(scene, [](scene::Mesh &mesh) {
    for (std::size_t i = 0; i < mesh.normals.size(); i++) {
      mesh.normals[i] = i % 5 == 0 ? glm::vec3(0.0F) : glm::vec3(0, 0, 1);
    }
  });
  const Tracer tracer(scene);
  for (const glm::vec3 &eye : {glm::vec3(0, 0, 0.1F), glm::vec3(0, 0, 3), glm::vec3(1e5F, 0, 0)}) {
    scene::PlacedCamera camera = test::camera_at(eye, {0.1F, 0, 0}, 3.14159F);
    camera.near = 1e-6F;
    for (const glm::vec4 &pixel : direct_light(tracer, camera, {40, 30}, {.sample_count = 4}).pixels) {
      for (int i = 0; i < 3; i++) {
        ASSERT_TRUE(std::isfinite(pixel[i]) && pixel[i] >= 0.0F);
      }
    }
  }
}

TEST(DirectLight, PicturesWithoutPixelsOrSamplesAreErrors)
{
  const scene::Scene scene;
  const Tracer tracer(scene);
  const scene::PlacedCamera camera;
  EXPECT_THROW(static_cast<void>(direct_light(tracer, camera, {0, 4}, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(direct_light(tracer, camera, {4, -1}, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(direct_light(tracer, camera, {4, 4}, {.sample_count = 0})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(direct_light(tracer, camera, {0, 4}, {}, {})), std::invalid_argument);
  EXPECT_TRUE(direct_light(tracer, camera, {4, 4}, {}, {}).empty());
}

}  // namespace
}  // namespace gnomon::reference
