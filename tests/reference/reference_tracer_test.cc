// SPDX-License-Identifier: MIT
#include "reference_tracer.hh"
#include "reference_test_scene.hh"

#include <gtest/gtest.h>

#include <random>

namespace gnomon::reference {
namespace {

using test::add_rectangle;
using test::add_triangles;
using test::placed;

/** Uniform in [-1, 1]³. */
glm::dvec3 random_point(std::mt19937 &random)
{
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

using Wide = glm::vec<3, long double>;

/**
 * t of the intersection of a ray with a triangle, in long double (Möller and Trumbore 1997). Infinity: no intersection.
 * NaN: too near an edge to decide.
 */
double hit_in_long_double(const Ray &ray, const std::array<glm::dvec3, 3> &corners)
{
  const Wide a(corners[0]);
  const Wide edge_b = Wide(corners[1]) - a;
  const Wide edge_c = Wide(corners[2]) - a;
  const Wide direction(ray.direction_ws);
  const Wide p = glm::cross(direction, edge_c);
  const long double determinant = glm::dot(edge_b, p);
  const Wide s = Wide(ray.origin_ws) - a;
  const Wide q = glm::cross(s, edge_b);
  const long double u = glm::dot(s, p) / determinant;
  const long double v = glm::dot(direction, q) / determinant;
  const long double inside = std::min({u, v, 1.0L - u - v});
  if (std::abs(inside) < 1e-9L) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const long double t = glm::dot(edge_c, q) / determinant;
  return inside > 0.0L && t >= 0.0L ? double(t) : std::numeric_limits<double>::infinity();
}

struct TracerPlace {
  double offset;
  double scale;
};

class TracerPlaceTest : public testing::TestWithParam<TracerPlace> {};

TEST_P(TracerPlaceTest, NearestHitEqualsThatInLongDouble)
{
  const TracerPlace place = GetParam();
  std::mt19937 random(7);
  // Large and tiny triangles together. Float boxes must not lose any.
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 300; i++) {
    const glm::dvec3 center = random_point(random);
    const double size = std::pow(10.0, -4.0 * double(i % 10) / 9.0);
    for (int k = 0; k < 3; k++) {
      corners.emplace_back((center + size * random_point(random)) * place.scale);
    }
  }
  scene::Scene scene;
  add_triangles(scene, corners, placed(glm::vec3(float(place.offset))));
  const Tracer tracer(scene);
  std::vector<std::array<glm::dvec3, 3>> world;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    world.push_back({glm::dvec3(corners[i]) + place.offset, glm::dvec3(corners[i + 1]) + place.offset,
                     glm::dvec3(corners[i + 2]) + place.offset});
  }
  int compared = 0;
  int hits = 0;
  for (int i = 0; i < 3000; i++) {
    // Aimed at a triangle, so that tiny triangles are hit.
    const auto &aim = world[std::size_t(i) % world.size()];
    Ray ray{random_point(random) * 3.0 * place.scale + place.offset, {}};
    ray.direction_ws = (0.2 * aim[0] + 0.3 * aim[1] + 0.5 * aim[2] - ray.origin_ws) * std::pow(10.0, double(i % 7 - 3));
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto &triangle : world) {
      const double t = hit_in_long_double(ray, triangle);
      nearest = std::isnan(t) || std::isnan(nearest) ? std::numeric_limits<double>::quiet_NaN() : std::min(nearest, t);
    }
    if (std::isnan(nearest)) {
      continue;
    }
    compared++;
    const std::optional<Hit> hit = tracer.closest(ray, Faces::All);
    ASSERT_EQ(hit.has_value(), std::isfinite(nearest)) << "ray " << i;
    if (hit) {
      hits++;
      // The rounding of coordinates grows with the distance from the origin.
      const double tolerance = 1e-10 + 1e-14 * place.offset / place.scale * 1e4;
      ASSERT_NEAR(hit->t / nearest, 1.0, tolerance) << "ray " << i;
    }
  }
  EXPECT_GT(compared, 2900);
  EXPECT_GT(hits, 2800);
}

INSTANTIATE_TEST_SUITE_P(Places, TracerPlaceTest,
                         testing::Values(TracerPlace{0.0, 1.0}, TracerPlace{0.0, 1e-4}, TracerPlace{0.0, 1e5},
                                         TracerPlace{1048576.0, 1.0}, TracerPlace{1048576.0, 1e-2}));

TEST(Tracer, SurfaceFunctionsLinesAndPointsThatItDoesNotTraceAreNamed)
{
  scene::Scene scene;
  const auto function = scene.add(scene::SurfaceFunction{.name = "f"});
  const auto add = [&](const char *name, scene::Handle<scene::SurfaceFunction> named,
                       scene::Topology topology = scene::Topology::Triangles) {
    const auto material = scene.add(scene::Material{.name = name, .surface_function = named});
    scene::Mesh mesh;
    mesh.name = std::string("mesh of ") + name;
    mesh.topology = topology;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.indices.assign({0, 1, 2});
    mesh.indices.resize(topology == scene::Topology::Lines ? 2 : 3);
    mesh.material = material;
    return scene.add(scene::Node{.meshes = {scene.add(mesh)}});
  };
  add("plain", {});
  add("edited", function);
  EXPECT_EQ(
      untraced_parts(scene),
      (std::vector<std::string>{"material 'edited': the reference does not trace its surface function; the errors "
                                "include this difference"}));
  scene.remove(function);
  EXPECT_TRUE(untraced_parts(scene).empty());
  add("points", {}, scene::Topology::Points);
  const auto hidden = add("lines", {}, scene::Topology::Lines);
  EXPECT_EQ(untraced_parts(scene),
            (std::vector<std::string>{
                "mesh 'mesh of points': the reference does not trace points; the errors include this difference",
                "mesh 'mesh of lines': the reference does not trace lines; the errors include this difference"}));
  scene.edit(hidden, [](scene::Node &node) { node.is_visible = false; });
  EXPECT_EQ(untraced_parts(scene).size(), 1U);
  const auto of_host =
      scene.add(scene::Mesh{.name = "terrain", .host_shape = scene::HostShape{.bounds = {{-1, -1, -1}, {1, 1, 1}}}});
  scene.add(scene::Node{.meshes = {of_host}});
  EXPECT_EQ(untraced_parts(scene).back(),
            "mesh 'terrain': the reference does not trace buffers of a host; the errors include this difference");
  EXPECT_FALSE(Tracer(scene).closest({{-0.5, -0.5, 5}, {0, 0, -1}}, Faces::All));
}

TEST(Tracer, RaysDoNotSlipBetweenTrianglesThatShareAnEdge)
{
  // A sphere of triangles around the origin, with corners that are not exact in float.
  constexpr int rows = 13;
  constexpr int columns = 17;
  const auto corner = [](int row, int column) {
    const double polar = M_PI * row / rows;
    const double turn = 2.0 * M_PI * (column % columns) / columns;
    const double across = row == 0 || row == rows ? 0.0 : std::sin(polar);
    return glm::vec3(across * std::cos(turn), across * std::sin(turn), std::cos(polar));
  };
  std::vector<glm::vec3> corners;
  for (int row = 0; row < rows; row++) {
    for (int column = 0; column < columns; column++) {
      const std::array<glm::vec3, 4> quad = {corner(row, column), corner(row + 1, column), corner(row + 1, column + 1),
                                             corner(row, column + 1)};
      corners.insert(corners.end(), {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
    }
  }
  scene::Scene scene;
  const glm::mat4 turned = glm::rotate(glm::mat4(1.0F), 0.7F, glm::normalize(glm::vec3(1, 2, 3)));
  add_triangles(scene, corners, turned);
  const Tracer tracer(scene);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 20000; i++) {
    const std::size_t first = std::size_t(i) % (corners.size() / 3) * 3;
    const glm::dmat4 m(turned);
    const glm::dvec3 a(m * glm::dvec4(corners[first + std::size_t(i) / 7 % 3], 1.0));
    const glm::dvec3 b(m * glm::dvec4(corners[first + (std::size_t(i) / 7 + 1) % 3], 1.0));
    const double s = i % 5 == 0 ? 0.0 : share(random);
    const glm::dvec3 origin = 0.3 * random_point(random);
    const glm::dvec3 aim = a * (1.0 - s) + b * s;
    ASSERT_TRUE(tracer.closest({origin, aim - origin}, Faces::All)) << i;
    // The lamp is twice as far away as `aim`, outside the sphere.
    ASSERT_TRUE(tracer.is_blocked(origin, 0.0, {2.0 * aim - origin, false})) << i;
    ASSERT_TRUE(tracer.is_blocked(origin, 0.0, {aim - origin, true})) << i;
  }
}

TEST(Tracer, NothingIsHitInAnEmptyScene)
{
  const scene::Scene scene;
  const Tracer tracer(scene);
  EXPECT_FALSE(tracer.closest({{0, 0, 0}, {0, 0, 1}}, Faces::All));
  EXPECT_FALSE(tracer.is_blocked({0, 0, 0}, 0.0, {{0, 0, 1}, true}));
}

TEST(Tracer, TrianglesWithoutAreaAndFlattenedObjectsAreHarmless)
{
  scene::Scene scene;
  add_triangles(scene, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {2, 0, 1}});
  add_rectangle(scene, {-1, -1}, {1, 1}, glm::scale(glm::mat4(1.0F), glm::vec3(0.0F)));
  // Flattened along z. A ray along z still hits the square, at the height of its object.
  add_rectangle(scene, {-1, -1}, {1, 1}, placed({0, 0, 3}) * glm::scale(glm::mat4(1.0F), glm::vec3(1, 1, 0)));
  const Tracer tracer(scene);
  const std::optional<Hit> hit = tracer.closest({{0.5, 0.25, 0}, {0, 0, 1}}, Faces::All);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->t, 3.0);
  const Surface surface = tracer.surface_at(*hit);
  EXPECT_EQ(surface.geometric_normal_ws, glm::dvec3(0, 0, 1));
  EXPECT_EQ(surface.shading_normal_ws, glm::dvec3(0, 0, 1));
}

TEST(Tracer, RaysWithoutDirectionOrWithNanHitNothing)
{
  scene::Scene scene;
  add_rectangle(scene, {-1, -1}, {1, 1});
  const Tracer tracer(scene);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity}) {
    EXPECT_FALSE(tracer.closest({{0, 0, bad}, {0, 0, 1}}, Faces::All));
    EXPECT_FALSE(tracer.closest({{0, 0, 1}, {0, bad, -1}}, Faces::All));
    EXPECT_FALSE(tracer.is_blocked({0, 0, 1}, 0.0, {{0, bad, -1}, false}));
  }
  EXPECT_FALSE(tracer.closest({{0, 0, 0}, {0, 0, 0}}, Faces::All));
}

TEST(Tracer, NormalsStayOnTheFrontOfMirroredAndShearedObjects)
{
  glm::mat4 sheared(1.0F);
  sheared[1][0] = 0.5F;
  sheared[2][1] = -0.75F;
  for (const glm::mat4 &matrix : {glm::scale(glm::mat4(1.0F), glm::vec3(-1, 1, 1)), sheared,
                                  sheared * glm::scale(glm::mat4(1.0F), glm::vec3(2, -3, 0.5F))}) {
    scene::Scene scene;
    // Tilted, so that shear rotates the normal.
    const glm::mat4 tilted = glm::rotate(matrix, 0.6F, glm::vec3(1, 0, 0));
    add_rectangle(scene, {-1, -1}, {1, 1}, tilted);
    const Tracer tracer(scene);
    // A point in front of the object stays in front after the transformation.
    const glm::dvec3 above = glm::dvec3(glm::dmat4(tilted) * glm::dvec4(0.1, 0.2, 1.0, 1.0));
    const glm::dvec3 at = glm::dvec3(glm::dmat4(tilted) * glm::dvec4(0.1, 0.2, 0.0, 1.0));
    const std::optional<Hit> hit = tracer.closest({above, at - above}, Faces::All);
    ASSERT_TRUE(hit);
    const Surface surface = tracer.surface_at(*hit);
    EXPECT_GT(glm::dot(surface.geometric_normal_ws, above - at), 0.0);
    EXPECT_NEAR(glm::dot(surface.geometric_normal_ws, surface.shading_normal_ws), 1.0, 1e-12);
    EXPECT_LT(glm::distance(surface.position_ws, at), 1e-14);
  }
}

TEST(Tracer, BacksOfOneSidedMaterialsAreInvisibleAndCastShadows)
{
  scene::Scene scene;
  test::add_material(scene, glm::vec3(1.0F));
  test::edit_material(scene, [&](scene::Material &material) { material.is_double_sided = false; });
  add_rectangle(scene, {-1, -1}, {1, 1});
  const Tracer tracer(scene);
  EXPECT_TRUE(tracer.closest({{0, 0.5, 1}, {0, 0, -1}}, Faces::Drawn));
  EXPECT_FALSE(tracer.closest({{0, 0.5, -1}, {0, 0, 1}}, Faces::Drawn));
  EXPECT_TRUE(tracer.closest({{0, 0.5, -1}, {0, 0, 1}}, Faces::All));
  EXPECT_TRUE(tracer.is_blocked({0, 0.5, -1}, 0.0, {{0, 0.5, 1}, false}));
}

TEST(Tracer, MaskedMaterialBelowItsCutoffIsNotHit)
{
  for (const float alpha : {0.25F, 0.5F, 0.75F}) {
    scene::Scene scene;
    test::add_material(scene, glm::vec3(1.0F));
    test::edit_material(scene, [&](scene::Material &material) {
      material.alpha_mode = scene::AlphaMode::Mask;
      material.alpha_cutoff = 0.5F;
      material.alpha = alpha;
    });
    add_rectangle(scene, {-1, -1}, {1, 1});
    const Tracer tracer(scene);
    EXPECT_EQ(tracer.closest({{0, 0.5, 1}, {0, 0, -1}}, Faces::All).has_value(), alpha >= 0.5F);
    EXPECT_EQ(tracer.is_blocked({0, 0.5, -1}, 0.0, {{0, 0, 1}, true}), alpha >= 0.5F);
  }
}

TEST(Tracer, MaskIsCutWhereTheInterpolatedAlphaIsTheCutoff)
{
  // Two texels, alpha 0 and 1, over a square of u from 0 to 1: alpha is 2u - 1/2 between the centres.
  for (const float cutoff : {0.25F, 0.5F, 0.875F}) {
    for (const auto &[wrap, shift] :
         {std::pair(scene::TextureWrap::ClampToEdge, 0.0F), std::pair(scene::TextureWrap::Repeat, -3.0F),
          std::pair(scene::TextureWrap::MirroredRepeat, 4.0F)}) {
      scene::Scene scene;
      const auto image = scene.add(scene::Image{"alpha", 2, 1, {255, 255, 255, 0, 0, 0, 0, 255}});
      const auto texture = scene.add(scene::Texture{.image = image, .wrap_u = wrap});
      test::add_material(scene, glm::vec3(1.0F));
      test::edit_material(scene, [&](scene::Material &material) {
        material.alpha_mode = scene::AlphaMode::Mask;
        material.alpha_cutoff = cutoff;
        material.base_color_texture = texture;
      });
      add_rectangle(scene, {0, 0}, {1, 1});
      test::edit_mesh(scene, [&offset = shift](scene::Mesh &mesh) {
        for (const glm::vec3 &position : mesh.positions) {
          mesh.uvs.emplace_back(position.x + offset, position.y);
        }
      });
      const Tracer tracer(scene);
      const double edge = 0.25 + 0.5 * double(cutoff);
      for (const double x : {edge - 1e-9, edge + 1e-9}) {
        EXPECT_EQ(tracer.closest({{x, 0.5, 1}, {0, 0, -1}}, Faces::All).has_value(), x > edge)
            << cutoff << ' ' << shift;
        EXPECT_EQ(tracer.is_blocked({x, 0.5, -1}, 0.0, {{x, 0.5, 1}, false}), x > edge) << cutoff << ' ' << shift;
      }
    }
  }
}

TEST(Tracer, BaseColorIsDecodedBeforeItIsInterpolated)
{
  scene::Scene scene;
  const auto image = scene.add(scene::Image{"grey", 2, 1, {255, 0, 188, 255, 0, 0, 188, 255}});
  const auto texture = scene.add(scene::Texture{.image = image});
  test::add_material(scene, {0.5F, 1.0F, 1.0F});
  test::edit_material(scene, [&](scene::Material &material) { material.base_color_texture = texture; });
  add_rectangle(scene, {0, 0}, {1, 1});
  test::edit_mesh(scene, [](scene::Mesh &mesh) {
    for (const glm::vec3 &position : mesh.positions) {
      mesh.uvs.emplace_back(position.x, position.y);
    }
  });
  const Tracer tracer(scene);
  const std::optional<Hit> hit = tracer.closest({{0.5, 0.5, 1}, {0, 0, -1}}, Faces::All);
  ASSERT_TRUE(hit);
  const glm::dvec3 color = tracer.surface_at(*hit).base_color;
  EXPECT_NEAR(color.r, 0.25, 1e-12);
  EXPECT_NEAR(color.g, 0.0, 1e-12);
  // 188 in sRGB is 0.5029 in linear light.
  EXPECT_NEAR(color.b, 0.5029, 1e-4);
}

}  // namespace
}  // namespace gnomon::reference
