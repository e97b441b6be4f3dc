// SPDX-License-Identifier: MIT
// Points and lines on the driver, compared with closed forms.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "reference_tracer.hh"

#include <numbers>

namespace gnomon::eevee {
namespace {

using scene::Topology;
using test::Picture;
using test::Renderer;

constexpr glm::vec3 line_color(0.25F, 0.5F, 0.75F);

class LinesGpuTest : public test::SharedDeviceTest {
 protected:
  scene::Handle<scene::Material> add_material(bool is_unlit)
  {
    const auto material = test::add_material(scene, line_color);
    scene.edit(material, [&](scene::Material &value) {
      value.is_unlit = is_unlit;
      value.specular = 0.0F;
    });
    return material;
  }
  void add_mesh(Topology topology, std::vector<glm::vec3> positions, scene::Handle<scene::Material> material,
                const glm::vec3 &normal = {0, 0, 1})
  {
    scene::Mesh mesh;
    mesh.name = "lines";
    mesh.normals.assign(positions.size(), normal);
    for (std::uint32_t i = 0; i < positions.size(); i++) {
      mesh.indices.push_back(i);
    }
    mesh.positions = std::move(positions);
    mesh.topology = topology;
    mesh.material = material;
    test::add_object(scene, scene.add(std::move(mesh)), glm::dmat4(1));
  }
  Picture render(const Settings &settings = {.sample_count = 1})
  {
    Renderer renderer(*device, scene, size_px, settings);
    const Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }
  static glm::dvec4 sum_of(const Picture &picture)
  {
    glm::dvec4 sum(0.0);
    for (const glm::vec4 &pixel : picture.pixels) {
      sum += glm::dvec4(pixel);
    }
    return sum;
  }
  static scene::PlacedCamera orthographic()
  {
    scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0});
    camera.kind = scene::CameraKind::Orthographic;
    camera.half_width = camera.half_height = 1.0F;
    return camera;
  }

  // An odd width, so that the axes meet the middle of a pixel.
  static constexpr glm::ivec2 size_px{33, 33};
  scene::Scene scene;
  scene::PlacedCamera camera = orthographic();
};

/** The sums do not depend on the pixel filter, which keeps the light of a picture apart from its edge. */
TEST_F(LinesGpuTest, APointIsOnePixelAndALineOnePixelForEachColumn)
{
  add_mesh(Topology::Points, {{0, 0, 0}, {0.5F, 0.25F, 0}}, add_material(true));
  const glm::dvec4 points = sum_of(render());
  // Rounding of the filter's weights.
  constexpr double rounding = 1e-5;
  for (int c = 0; c < 4; c++) {
    EXPECT_NEAR(points[c], 2.0 * glm::dvec4(line_color, 1)[c], 2.0 * rounding);
  }
  scene = {};
  // From the middle of one pixel to that of another: the pixel at the end is not drawn.
  const float pixel = 2.0F / float(size_px.x);
  add_mesh(Topology::Lines, {{-10 * pixel, 0, 0}, {10 * pixel, 0, 0}}, add_material(true));
  const glm::dvec4 line = sum_of(render());
  for (int c = 0; c < 4; c++) {
    EXPECT_NEAR(line[c], 20.0 * glm::dvec4(line_color, 1)[c], 20.0 * rounding);
  }
}

TEST_F(LinesGpuTest, AreHiddenByWhatIsInFrontOfThemAndHideWhatIsBehind)
{
  const auto white = test::add_material(scene, glm::vec3(1));
  scene.edit(white, [](scene::Material &value) { value.is_unlit = true; });
  test::add_object(scene, test::add_square_mesh(scene, white), glm::scale(glm::dmat4(1), glm::dvec3(2)));
  const Picture plain = render();
  add_mesh(Topology::Lines, {{-2, 0, -0.5F}, {2, 0, -0.5F}}, add_material(true));
  add_mesh(Topology::Points, {{0.5F, 0.5F, -0.5F}}, add_material(true));
  EXPECT_EQ(render().pixels, plain.pixels);
  add_mesh(Topology::Lines, {{-2, 0, 0.5F}, {2, 0, 0.5F}}, add_material(true));
  add_mesh(Topology::Points, {{0.5F, 0.5F, 0.5F}}, add_material(true));
  const Picture over = render();
  EXPECT_LT(over.at(16, 16).r, 0.9F);
  // A row and a pixel less of white, and as much of the line's colour.
  const double covered = size_px.x + 1;
  EXPECT_NEAR(sum_of(over).r, double(size_px.x) * size_px.y - covered * (1.0 - line_color.r), 1e-3 * covered);
}

TEST_F(LinesGpuTest, WithNormalsAreLitAndWithoutShadowsOfTheirOwn)
{
  const float irradiance = 2.0F;
  // 60° from the normal.
  const glm::vec3 from_lamp(std::sqrt(0.75F), 0, -0.5F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 0}, from_lamp, irradiance);
  add_mesh(Topology::Lines, {{-2, 0, 0.5F}, {2, 0, 0.5F}}, add_material(false));
  add_mesh(Topology::Points, {{0, 0.5F, 0.5F}}, add_material(false));
  const glm::vec3 expected = line_color * irradiance * 0.5F / std::numbers::pi_v<float>;
  const glm::dvec4 sum = sum_of(render());
  const double covered = size_px.x + 1;
  for (int c = 0; c < 3; c++) {
    // The guard band of one pixel lets the filter see the line beyond the picture.
    EXPECT_NEAR(sum[c], covered * expected[c], 1e-3);
  }
  // A ground below shows no shadow of them: only the pixels that they cover differ.
  scene::Scene ground;
  std::swap(scene, ground);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 0}, from_lamp, irradiance);
  test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(1))),
                   glm::scale(glm::dmat4(1), glm::dvec3(2)));
  const Picture plain = render();
  // In this order, the indices would also make triangles.
  const glm::vec3 a(-0.75F, -0.75F, 0.5F);
  const glm::vec3 b(0.75F, -0.75F, 0.5F);
  const glm::vec3 c(0, 0.75F, 0.5F);
  add_mesh(Topology::Lines, {a, b, c, a, b, c}, add_material(false));
  const Picture with_lines = render();
  int changed = 0;
  for (int y = 0; y < size_px.y; y++) {
    changed += with_lines.at(16, y) != plain.at(16, y) ? 1 : 0;
    for (int x = 0; x < size_px.x; x++) {
      const glm::vec2 middle = (2.0F * glm::vec2(x, y) + 1.0F) / glm::vec2(size_px) - 1.0F;
      const auto distance = [&middle](const glm::vec2 &from, const glm::vec2 &to) {
        const float part = glm::dot(middle - from, to - from) / glm::dot(to - from, to - from);
        return glm::distance(middle, glm::mix(from, to, glm::clamp(part, 0.0F, 1.0F)));
      };
      // Three pixels away, where a shadow would fall.
      if (std::min({distance(a, b), distance(b, c), distance(c, a)}) > 3.0F * 2.0F / float(size_px.x)) {
        EXPECT_EQ(with_lines.at(x, y), plain.at(x, y)) << x << ' ' << y;
      }
    }
  }
  // Two lines, and at most the rows beside them that the filter reaches.
  EXPECT_GE(changed, 2);
  EXPECT_LE(changed, 8);
}

TEST_F(LinesGpuTest, BlendOnceOverWhatIsBehind)
{
  const auto material = add_material(true);
  scene.edit(material, [](scene::Material &value) {
    value.alpha_mode = scene::AlphaMode::Blend;
    value.alpha = 0.25F;
    value.is_double_sided = true;
  });
  add_mesh(Topology::Points, {{0, 0, 0}}, material);
  const glm::dvec4 sum = sum_of(render());
  for (int c = 0; c < 4; c++) {
    EXPECT_NEAR(sum[c], 0.25 * glm::dvec4(line_color, 1)[c], 1e-5);
  }
}

TEST_F(LinesGpuTest, TheReferenceDoesNotSeeThem)
{
  const glm::vec3 a(-1, -1, 0);
  const glm::vec3 b(1, -1, 0);
  const glm::vec3 c(0, 1, 0);
  add_mesh(Topology::Lines, {a, b, c, a, b, c}, add_material(false));
  add_mesh(Topology::Points, {a, b, c}, add_material(false));
  const reference::Tracer tracer(scene);
  EXPECT_FALSE(tracer.closest({{0, 0, 5}, {0, 0, -1}}, reference::Faces::All));
}

}  // namespace
}  // namespace gnomon::eevee
