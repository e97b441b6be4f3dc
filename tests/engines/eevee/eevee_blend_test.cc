// SPDX-License-Identifier: MIT
// Order of blended objects, and that scenes without them, and without what transmits light, take nothing for them.
#include "eevee_test_scene.hh"

#include "eevee_sequence_shared.h"
#include "render_blend_order.hh"
#include "shadows/shadows.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <random>
#include <set>

namespace gnomon::eevee {
namespace {

using render_scene::back_to_front;
using render_scene::blend_order_exact_max;

std::mt19937 random_bits(7);

double uniform(double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(random_bits);
}

/** Splits a box in two, again and again, and takes a random box within each part: so that there is a true order. */
void add_boxes(std::vector<scene::Bounds> &boxes, const glm::dvec3 &low, const glm::dvec3 &high, int depth)
{
  if (depth == 0) {
    glm::dvec3 a;
    glm::dvec3 b;
    for (int axis = 0; axis < 3; axis++) {
      a[axis] = glm::mix(low[axis], high[axis], uniform(0, 0.4));
      // Some are flat.
      b[axis] = uniform(0, 1) < 0.3 ? a[axis] : glm::mix(low[axis], high[axis], uniform(0.6, 1));
    }
    boxes.push_back({glm::vec3(a), glm::vec3(b)});
    return;
  }
  const int axis = int(random_bits() % 3);
  const double split = uniform(low[axis], high[axis]);
  glm::dvec3 middle_high = high;
  glm::dvec3 middle_low = low;
  middle_high[axis] = middle_low[axis] = split;
  add_boxes(boxes, low, middle_high, depth - 1);
  add_boxes(boxes, middle_low, high, depth - 1);
}

/** Where a ray enters a box, if it meets it ahead. */
std::optional<double> entry(const scene::Bounds &box, const glm::dvec3 &origin, const glm::dvec3 &direction)
{
  double enter = 0.0;
  double leave = 1e30;
  for (int axis = 0; axis < 3; axis++) {
    const double a = (double(box.min[axis]) - origin[axis]) / direction[axis];
    const double b = (double(box.max[axis]) - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? std::optional(enter) : std::nullopt;
}

/** Pairs of boxes that a ray meets in another order than that of back_to_front. */
int wrong_pairs(const std::vector<scene::Bounds> &boxes, const glm::vec4 &eye, int &pairs)
{
  const std::vector<std::uint32_t> order = back_to_front(boxes, eye);
  std::vector<std::uint32_t> all(boxes.size());
  std::iota(all.begin(), all.end(), 0U);
  EXPECT_TRUE(std::ranges::is_permutation(order, all));
  int wrong = 0;
  for (int i = 0; i < 60; i++) {
    const scene::Bounds &aimed = boxes[random_bits() % boxes.size()];
    const glm::dvec3 target =
        glm::mix(glm::dvec3(aimed.min), glm::dvec3(aimed.max), glm::dvec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)));
    const glm::dvec3 origin = eye.w == 0.0F ? target + 40.0 * glm::dvec3(eye) : glm::dvec3(eye);
    std::optional<double> last;
    for (const std::uint32_t index : order) {
      const std::optional<double> t = entry(boxes[index], origin, target - origin);
      pairs += t && last ? 1 : 0;
      wrong += t && last && *t > *last ? 1 : 0;
      last = t ? t : last;
    }
  }
  return wrong;
}

TEST(BlendOrder, TheEyeIsAPositionOrADirectionOfAParallelView)
{
  // Looks along -X, so that nothing is rounded.
  const glm::vec3 eye(3, -2, 5);
  const glm::mat4 view_from_world = glm::lookAt(eye, eye - glm::vec3(4, 0, 0), glm::vec3(0, 0, 1));
  const draw::View perspective(view_from_world, draw::perspective(1.0F, 1.0F, 0.1F, 10.0F));
  EXPECT_EQ(render_scene::eye_of(perspective), glm::vec4(eye, 1.0F));
  const draw::View parallel(view_from_world, draw::orthographic(1.0F, 1.0F, 0.1F, 10.0F));
  EXPECT_EQ(render_scene::eye_of(parallel), glm::vec4(1, 0, 0, 0));
}

TEST(BlendOrder, SeparatedBoxesAreInTheirTrueOrderFromEverywhere)
{
  int pairs = 0;
  for (int i = 0; i < 60; i++) {
    std::vector<scene::Bounds> boxes;
    add_boxes(boxes, glm::dvec3(-4), glm::dvec3(4), 4);
    std::ranges::shuffle(boxes, random_bits);
    const glm::vec3 eye(uniform(-9, 9), uniform(-9, 9), uniform(-9, 9));
    EXPECT_EQ(wrong_pairs(boxes, glm::vec4(eye, 1.0F), pairs), 0) << i;
    EXPECT_EQ(wrong_pairs(boxes, glm::vec4(glm::normalize(eye), 0.0F), pairs), 0) << i << ", parallel";
  }
  EXPECT_GT(pairs, 3000);
}

TEST(BlendOrder, OtherBoxesAreInTheOrderOfTheirDistance)
{
  // Each within the next.
  std::vector<scene::Bounds> boxes;
  for (int i = 0; i < 5; i++) {
    boxes.push_back({glm::vec3(-1.0F - float(i), -1, -1), glm::vec3(1.0F, 1, 1)});
  }
  EXPECT_EQ(back_to_front(boxes, {9, 0, 0, 1}), (std::vector<std::uint32_t>{4, 3, 2, 1, 0}));
  EXPECT_EQ(back_to_front(boxes, {-1, 0, 0, 0}), (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(back_to_front({}, {0, 0, 0, 1}).empty());
  // Three beams of which each lies on the next, in a circle.
  const std::vector<scene::Bounds> circle = {
      {{-5, -1, 0}, {1, 0, 1}}, {{0, -5, -2}, {1, 1, -1}}, {{-5, -5, -4}, {5, 5, -3}}};
  EXPECT_EQ(back_to_front(circle, {0, 0, 9, 1}).front(), 2U);
}

TEST(BlendOrder, ManyBoxesAreInTheOrderOfTheirDistance)
{
  std::vector<scene::Bounds> boxes;
  for (std::size_t i = 0; i <= blend_order_exact_max; i++) {
    boxes.push_back({glm::vec3(float(i)), glm::vec3(float(i))});
  }
  const std::vector<std::uint32_t> order = back_to_front(boxes, {0, 0, 0, 1});
  EXPECT_TRUE(std::ranges::is_sorted(order, std::greater()));
}

TEST(OpacityThreshold, CoversATexelAsOftenAsTheOpacitySays)
{
  for (const float opacity : {0.0F, 0.125F, 0.5F, 0.8F, 1.0F}) {
    for (std::uint32_t x = 0; x < 40; x++) {
      int covered = 0;
      for (std::uint32_t sample = 0; sample < 64; sample++) {
        const float threshold = shared::opacity_threshold(x, 3 * x, 5, sample, 1);
        ASSERT_TRUE(threshold >= 0.0F && threshold < 1.0F);
        covered += opacity > threshold ? 1 : 0;
      }
      // One threshold is in each interval of a 64th, and at either end one may be on the other side.
      EXPECT_NEAR(float(covered) / 64.0F, opacity, 2.0F / 64.0F);
    }
  }
}

TEST(OpacityThreshold, IsIndependentForOccludersOneBehindTheOther)
{
  // Measure the light that passes both occluders: for each texel over the samples, and for the first sample over the
  // texels.
  for (std::uint32_t other = 1; other < 4; other++) {
    double squares = 0.0;
    int open_first = 0;
    for (std::uint32_t i = 0; i < 1024; i++) {
      const std::uint32_t x = i % 32;
      const std::uint32_t y = i / 32;
      int open = 0;
      for (std::uint32_t sample = 0; sample < 64; sample++) {
        const bool is_open = shared::opacity_threshold(x, y, 8, sample, 0) >= 0.5F &&
                             shared::opacity_threshold(x, y, 8 + other, sample, 0) >= 0.5F;
        open += is_open ? 1 : 0;
        open_first += is_open && sample == 0 ? 1 : 0;
      }
      squares += (open / 64.0 - 0.25) * (open / 64.0 - 0.25);
    }
    // Independent of each other, of 32 open samples of one each is open by the other with 1 / 2: 0.044.
    EXPECT_LT(std::sqrt(squares / 1024), 0.05) << other;
    EXPECT_NEAR(open_first / 1024.0, 0.25, 0.02) << other;
  }
}

/** Names of passes, and defines of programs, of a picture of the scene on the null backend. */
std::set<std::string> taken_by(const scene::Scene &scene, int sample_count = 2)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  test::Renderer renderer(*device, scene, {32, 32}, {.sample_count = sample_count});
  renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
  std::set<std::string> taken;
  for (const auto &[name, count] : device->pass_counts()) {
    taken.insert(name + " x" + std::to_string(count));
  }
  for (const gpu::LiveResource &live : device->live()) {
    taken.insert(live.name + ": " + live.detail + ", " + std::to_string(live.size_bytes));
  }
  return taken;
}

struct BlendScene : testing::Test {
  void SetUp() override
  {
    test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F))),
                     glm::scale(glm::dmat4(1), glm::dvec3(3)));
    material = test::add_material(scene, glm::vec3(0.5F));
    pane = test::add_object(scene, test::add_square_mesh(scene, material),
                            glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 2)));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0, 0, -1}, 1.0F);
  }
  void set(scene::AlphaMode mode, float alpha)
  {
    scene.edit(material, [&](scene::Material &value) {
      value.alpha_mode = mode;
      value.alpha = alpha;
    });
  }
  scene::Scene scene;
  scene::Handle<scene::Material> material;
  scene::Handle<scene::Node> pane;
};

TEST_F(BlendScene, OpaqueMaterialsTakeNothingForBlending)
{
  const std::set<std::string> opaque = taken_by(scene);
  for (const std::string &what : opaque) {
    EXPECT_EQ(what.find("blend"), std::string::npos) << what;
    EXPECT_EQ(what.find("USE_OPACITY_THRESHOLD"), std::string::npos) << what;
  }
  set(scene::AlphaMode::Blend, 1.0F);
  EXPECT_EQ(taken_by(scene), opaque) << "a factor of 1 alone leaves it opaque";
  set(scene::AlphaMode::Blend, 0.5F);
  const std::set<std::string> blended = taken_by(scene);
  EXPECT_TRUE(blended.contains("blend x2"));
  EXPECT_TRUE(std::ranges::any_of(
      blended, [](const std::string &what) { return what.find("USE_OPACITY_THRESHOLD") != std::string::npos; }));
}

TEST_F(BlendScene, OnlyATextureWithAlphaBlends)
{
  const auto set_texels = [&](std::uint8_t alpha) {
    const auto texture = test::add_texture(scene, 1, {200, 100, 50, 255, 200, 100, 50, alpha});
    scene.edit(material, [&](scene::Material &value) {
      value.alpha_mode = scene::AlphaMode::Blend;
      value.base_color_texture.texture = texture;
    });
  };
  set_texels(255);
  EXPECT_FALSE(taken_by(scene).contains("blend x2"));
  set_texels(254);
  EXPECT_TRUE(taken_by(scene).contains("blend x2"));
}

TEST_F(BlendScene, TheTreeNamesThePassOrTheReason)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  test::Renderer renderer(*device, scene, {32, 32});
  const auto node = [&](const char *folder, const char *what) {
    renderer.sync();
    renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
    const FrameNode tree = renderer.inspect().report().tree;
    const FrameNode *found = find(*find(tree, folder), what);
    return found ? *found : FrameNode();
  };
  EXPECT_EQ(node("passes", "blend").why, "no material that is drawn is blended");
  EXPECT_EQ(node("passes", "blend").is_made, false);
  set(scene::AlphaMode::Blend, 0.5F);
  EXPECT_EQ(node("passes", "blend").is_made, true);
  EXPECT_EQ(node("draws", "blend_pass").count, 2U) << "back and front";
  set(scene::AlphaMode::Blend, 0.0F);
  EXPECT_EQ(node("passes", "blend").is_made, false) << "it is not there at all";
}

TEST_F(BlendScene, OnlyWhatTransmitsLightInTheViewTakesSomethingForIt)
{
  const std::set<std::string> opaque = taken_by(scene);
  scene.edit(material, [](scene::Material &value) {
    value.thickness = 1.0F;
    value.roughness = 0.0F;
  });
  EXPECT_EQ(taken_by(scene), opaque) << "no factor";
  scene.edit(material, [](scene::Material &value) { value.transmission = 0.5F; });
  const auto has = [&](std::string_view part) {
    const std::set<std::string> taken = taken_by(scene);
    return std::ranges::any_of(taken, [&](const std::string &what) { return what.find(part) != std::string::npos; });
  };
  EXPECT_TRUE(has("USE_TRANSMISSION") && has("behind: ") && has("transmission x2"));
  EXPECT_FALSE(has("5 levels")) << "it is smooth";
  scene.edit(pane, [](scene::Node &node) { node.parent_from_node[3].x = 50.0; });
  EXPECT_FALSE(has("USE_TRANSMISSION") || has("behind: ") || has("transmission x")) << "out of the view";
}

TEST_F(BlendScene, TheTreeNamesTheStepsOfTransmission)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  test::Renderer renderer(*device, scene, {32, 32});
  const auto step = [&](const char *name) {
    renderer.sync();
    renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
    return *find(*find(renderer.inspect().report().tree, "passes"), name);
  };
  EXPECT_EQ(step("behind").why, "no material that is drawn transmits light");
  scene.edit(material, [](scene::Material &value) { value.transmission = 0.5F; });
  EXPECT_TRUE(step("behind").is_made && step("transmission").is_made && !step("blend_behind").is_made);
  // The pane that is blended now shows a copy, and nothing else does.
  set(scene::AlphaMode::Blend, 0.5F);
  EXPECT_TRUE(step("behind").is_made && step("blend").is_made && !step("transmission").is_made);
  scene.edit(pane, [](scene::Node &node) { node.parent_from_node[3].x = 50.0; });
  EXPECT_EQ(step("behind").why, "nothing in the view transmits light");
}

TEST_F(BlendScene, AnObjectWithLayersLeavesThePlainProgramsAsTheyAre)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  const auto variants = [&] {
    test::Renderer renderer(*device, scene, {32, 32});
    renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
    const FrameNode tree = renderer.inspect().report().tree;
    std::set<std::string> names;
    for (const char *program : {"eevee_deferred_lit", "eevee_lit"}) {
      for (const FrameNode &variant : find(*find(tree, "programs"), program)->children) {
        names.insert(std::string(program) + variant.what);
      }
    }
    return names;
  };
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 5}, {0, 0, -1}, 1.0F);
  scene.edit(material, [](scene::Material &value) { value.specular_color = glm::vec3(1.0F); });
  const std::set<std::string> plain = variants();
  ASSERT_EQ(plain.size(), 1U);
  scene.edit(material, [](scene::Material &value) { value.coat = 1.0F; });
  const std::set<std::string> coated = variants();
  EXPECT_EQ(coated.size(), 2U);
  EXPECT_TRUE(coated.contains(*plain.begin())) << *plain.begin();
}

TEST_F(BlendScene, SamplesRedrawOnlyTheLayersThatBlendedCastersTouch)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  const auto layers_drawn = [&](int sample_count) {
    test::Renderer renderer(*device, scene, {32, 32}, {.sample_count = sample_count});
    renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
    return renderer.inspect().report().shadow_counters.faces_drawn;
  };
  test::remove_lamps(scene);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 3}, {0, 0, -1}, 1.0F);
  // A third object that is opaque, on another side of the lamp.
  test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F))),
                   glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 4)));
  const std::uint64_t once = layers_drawn(1);
  EXPECT_EQ(layers_drawn(8), once);
  set(scene::AlphaMode::Blend, 0.5F);
  EXPECT_EQ(layers_drawn(1), once);
  EXPECT_GE(layers_drawn(8), once + 7);
  EXPECT_LT(layers_drawn(8), 8 * once);
}

TEST_F(BlendScene, CascadesAreNotFittedToDepthsThatLackBlendedSurfaces)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  Settings settings;
  settings.shadow.is_fitted_to_depth = true;
  test::Renderer renderer(*device, scene, {32, 32}, settings);
  renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
  EXPECT_TRUE(renderer.inspect().shadows().reads_depths());
  EXPECT_TRUE(renderer.inspect().report().warnings.empty());
  set(scene::AlphaMode::Blend, 0.5F);
  renderer.sync();
  renderer.draw(test::camera_at({0, 0, 9}, {0, 0, 0}));
  EXPECT_FALSE(renderer.inspect().shadows().reads_depths());
  EXPECT_EQ(renderer.inspect().report().warnings.size(), 1U);
}

}  // namespace
}  // namespace gnomon::eevee
