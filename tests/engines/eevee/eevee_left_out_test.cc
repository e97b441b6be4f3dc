// SPDX-License-Identifier: MIT
// Scenes without one feature each: the backend's counts and names show that nothing was created or run for it.
#include "eevee_test_scene.hh"
#include "gpu/gpu_testing.hh"

#include "measure_left_out.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>

namespace gnomon::eevee {
namespace {

using Names = std::set<std::string>;

/** The backend's counts and names for one picture of a scene. */
struct Taken {
  /** Created resources, for example "texture 'film'", except framebuffers and timers, which follow from them. */
  Names resources;
  /** Features of all programs, for example "USE_LIGHT". */
  Names features;
  /** Steps of the frame with passes; "shadow of POINT" for all layers. */
  Names passes;
  std::size_t map_bytes = 0;
  std::size_t memory_bytes = 0;
  gpu::Counters counters;
  FrameNode tree;
};

Taken taken_by(const measure::LeftOutCase &of)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  Settings settings = of.settings;
  settings.sample_count = 2;
  const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, {64, 36});
  test::Renderer renderer(*device, of.scene, {64, 36}, settings);
  renderer.draw(of.scene.placed_cameras().front(), display.target());
  Taken taken;
  taken.memory_bytes = device->memory_bytes();
  for (const gpu::LiveResource &live : device->live()) {
    if (live.kind == gpu::ResourceKind::Framebuffer || live.kind == gpu::ResourceKind::TimerQuery) {
      continue;
    }
    if (live.name == "display") {
      // Created by the host, not by the frame.
      taken.memory_bytes -= live.size_bytes;
      continue;
    }
    taken.resources.insert(std::string(gpu::to_string(live.kind)) + " '" + live.name + "'");
    taken.map_bytes += live.name == "shadow_maps" ? live.size_bytes : 0;
    std::istringstream words(live.kind == gpu::ResourceKind::Shader ? live.detail : "");
    for (std::string word; words >> word;) {
      if (word.starts_with("USE_")) {
        taken.features.insert(word);
      }
    }
  }
  for (const auto &[name, count] : device->pass_counts()) {
    taken.passes.insert(name.substr(0, name.find(',')));
  }
  taken.counters = device->counters();
  taken.tree = renderer.inspect().report().tree;
  return taken;
}

/** Elements of \a all that are not in \a some. */
Names missing(const Names &all, const Names &some)
{
  Names names;
  std::ranges::set_difference(all, some, std::inserter(names, names.end()));
  return names;
}

class LeftOut : public testing::Test {
 protected:
  static void SetUpTestSuite()
  {
    for (const measure::LeftOutCase &of : measure::left_out_cases()) {
      taken.emplace(of.name, taken_by(of));
    }
  }
  static void TearDownTestSuite()
  {
    taken.clear();
  }
  /** Expects that \a name lacks exactly these parts of the full scene, and has \a passes_instead, but no others. */
  static void expect_lacks(const std::string &name, const Names &resources, const Names &features, const Names &passes,
                           const Names &passes_instead = {})
  {
    const Taken &full = taken.at("full");
    const Taken &less = taken.at(name);
    EXPECT_EQ(missing(full.resources, less.resources), resources) << name;
    EXPECT_EQ(missing(full.features, less.features), features) << name;
    EXPECT_EQ(missing(full.passes, less.passes), passes) << name;
    EXPECT_EQ(missing(less.resources, full.resources), Names()) << name;
    EXPECT_EQ(missing(less.features, full.features), Names()) << name;
    EXPECT_EQ(missing(less.passes, full.passes), passes_instead) << name;
  }

  static inline std::map<std::string, Taken> taken;
};

const Names shadow_resources = {"texture 'shadow_cubes'",       "texture 'shadow_maps'",
                                "sampler 'shadow_sampler'",     "buffer 'shadow_block'",
                                "buffer 'shadow_render_block'", "shader 'eevee_shadow_layered'"};
const Names shadow_features = {"USE_SHADOW_CUBE", "USE_SHADOW_MAP", "USE_SHADOW_PCF"};
const Names shadow_passes = {"shadow of POINT", "shadow of SUN", "shadow of SPOT"};

Names both(Names a, const Names &b)
{
  a.insert(b.begin(), b.end());
  return a;
}

TEST_F(LeftOut, TheFullSceneHasAll)
{
  const Taken &full = taken.at("full");
  EXPECT_EQ(full.passes, both(shadow_passes, {"gbuffer", "deferred_lit", "forward_depth", "lit", "film", "tonemap"}));
  EXPECT_EQ(full.features, both(shadow_features, {"USE_LIGHT", "USE_PUNCTUAL", "USE_SPECULAR", "USE_BASE_COLOR_TEXTURE",
                                                  "USE_ALPHA_MASK"}));
  const Names resources = both(shadow_resources, {"texture 'film'",
                                                  "texture 'depth'",
                                                  "texture 'radiance'",
                                                  "texture 'checks'",
                                                  "texture 'holes'",
                                                  "sampler 'nearest'",
                                                  "sampler 'texture_sampler'",
                                                  "buffer 'view_block'",
                                                  "buffer 'object_block'",
                                                  "buffer 'material_block'",
                                                  "buffer 'light_block'",
                                                  "batch 'box of plain'",
                                                  "batch 'box of specular'",
                                                  "batch 'box of textured'",
                                                  "batch 'box of masked'",
                                                  "batch 'box of one-sided'",
                                                  "shader 'eevee_gbuffer'",
                                                  "shader 'eevee_deferred_lit'",
                                                  "shader 'eevee_depth'",
                                                  "shader 'eevee_lit'",
                                                  "shader 'eevee_film'",
                                                  "shader 'eevee_tonemap'"});
  EXPECT_EQ(full.resources, resources);
}

TEST_F(LeftOut, MultipleScatteringIsMadeIfItIsAskedForAndSomethingReflects)
{
  for (measure::LeftOutCase of : measure::left_out_cases()) {
    if (of.name != "full" && of.name != "no specular") {
      continue;
    }
    of.settings.has_multiscatter = true;
    const Taken more = taken_by(of);
    const bool is_full = of.name == "full";
    // Its programs have all shapes of lamps.
    EXPECT_EQ(missing(more.resources, taken.at(of.name).resources),
              is_full ? Names({"texture 'multiscatter_table'", "texture 'ltc_table'", "sampler 'table_sampler'",
                               "buffer 'light_shape_block'"})
                      : Names());
    EXPECT_EQ(missing(more.features, taken.at(of.name).features),
              is_full ? Names({"USE_MULTISCATTER", "USE_LAMP_SHAPE"}) : Names());
    EXPECT_EQ(missing(taken.at(of.name).resources, more.resources), Names());
  }
}

TEST_F(LeftOut, NoLamp)
{
  // The mask also applies without light; then no pass reads the opaque texture.
  expect_lacks("no lamp",
               both(shadow_resources, {"buffer 'light_block'", "texture 'checks'", "shader 'eevee_gbuffer'",
                                       "shader 'eevee_deferred_lit'"}),
               both(shadow_features, {"USE_LIGHT", "USE_PUNCTUAL", "USE_SPECULAR"}),
               both(shadow_passes, {"gbuffer", "deferred_lit", "forward_depth"}), {"depth_prepass"});
}

TEST_F(LeftOut, NoSun)
{
  expect_lacks("no sun", {}, {}, {"shadow of SUN"});
  EXPECT_EQ(taken.at("no sun").map_bytes, 2048U * 2048U * 4U) << "the spot's layer alone";
}

TEST_F(LeftOut, NoPoint)
{
  expect_lacks("no point", {"texture 'shadow_cubes'"}, {"USE_SHADOW_CUBE"}, {"shadow of POINT"});
}

TEST_F(LeftOut, NoSpot)
{
  expect_lacks("no spot", {}, {}, {"shadow of SPOT"});
  EXPECT_EQ(taken.at("no spot").map_bytes + 2048U * 2048U * 4U, taken.at("full").map_bytes) << "one layer less";
}

TEST_F(LeftOut, NoShadow)
{
  expect_lacks("no shadow", shadow_resources, shadow_features, shadow_passes);
}

TEST_F(LeftOut, NoTexture)
{
  // All is in the G-buffer.
  expect_lacks("no texture",
               {"texture 'checks'", "texture 'holes'", "sampler 'texture_sampler'", "shader 'eevee_depth'",
                "shader 'eevee_lit'"},
               {"USE_BASE_COLOR_TEXTURE", "USE_ALPHA_MASK"}, {"forward_depth", "lit"});
}

TEST_F(LeftOut, NoAlpha)
{
  expect_lacks("no alpha", {}, {"USE_ALPHA_MASK"}, {});
  // The mask's programs in prepass and shadow pass; the lit pass has the same for masks and other textures.
  EXPECT_EQ(taken.at("no alpha").counters.shaders_made + 2, taken.at("full").counters.shaders_made);
}

TEST_F(LeftOut, NoSpecular)
{
  expect_lacks("no specular", {}, {"USE_SPECULAR"}, {});
}

TEST_F(LeftOut, NoVisibleReceiverAndNothingAtAllAreAClear)
{
  for (const char *name : {"no visible receiver", "nothing at all"}) {
    const Taken &full = taken.at("full");
    const Taken &less = taken.at(name);
    EXPECT_EQ(less.resources, Names{"texture 'film'"}) << name;
    EXPECT_EQ(less.passes, (Names{"film", "tonemap"})) << name << ": the two pictures are cleared";
    EXPECT_EQ(less.counters.passes, 2U) << name << ": once each, whatever the samples";
    EXPECT_EQ(less.counters.draws, 0U) << name;
    EXPECT_EQ(less.counters.shaders_made, 0U) << name;
    EXPECT_EQ(less.counters.upload_bytes, 0U) << name;
    EXPECT_EQ(less.counters.textures_made, 2U) << name;
    EXPECT_GT(full.counters.draws, 0U);
  }
}

TEST_F(LeftOut, NothingCostsMoreThanInTheFullScene)
{
  const Taken &full = taken.at("full");
  for (const auto &[name, less] : taken) {
    EXPECT_LE(less.memory_bytes, full.memory_bytes) << name;
    EXPECT_LE(less.counters.passes, full.counters.passes) << name;
    EXPECT_LE(less.counters.draws, full.counters.draws) << name;
    EXPECT_LE(less.counters.instances, full.counters.instances) << name;
    EXPECT_LE(less.counters.shader_binds, full.counters.shader_binds) << name;
    EXPECT_LE(less.counters.shaders_made, full.counters.shaders_made) << name;
    EXPECT_LE(less.counters.textures_made, full.counters.textures_made) << name;
    EXPECT_LE(less.counters.upload_bytes, full.counters.upload_bytes) << name;
  }
}

/** Calls \a visit for each node with its path. */
template <typename Visit>
void for_each_node(const FrameNode &node, const std::string &path, Visit &&visit)
{
  visit(node, path);
  for (const FrameNode &child : node.children) {
    for_each_node(child, path + "/" + child.what, visit);
  }
}

TEST_F(LeftOut, TheTreeHoldsAllThatTheBackendHas)
{
  for (const auto &[name, less] : taken) {
    EXPECT_EQ(less.tree.bytes, less.memory_bytes) << name;
    EXPECT_EQ(find(less.tree, "programs")->count, less.counters.shaders_made) << name;
    Names made;
    for_each_node(less.tree, name, [&](const FrameNode &node, const std::string &path) {
      EXPECT_FALSE(node.what.empty()) << path;
      EXPECT_FALSE(node.why.empty()) << path;
      if (node.is_made) {
        made.insert(node.what);
      }
    });
    for (const std::string &resource : less.resources) {
      const std::string what = resource.substr(resource.find('\'') + 1, resource.rfind('\'') - resource.find('\'') - 1);
      EXPECT_TRUE(resource.starts_with("sampler") || made.contains(what)) << name << ": " << resource;
    }
    for (const FrameNode &feature : find(*find(less.tree, "programs"), "features")->children) {
      EXPECT_EQ(feature.is_made, less.features.contains(feature.what)) << name << ": " << feature.what;
    }
  }
}

/** Finds a node by its path below the root. */
const FrameNode &node_at(const FrameNode &root, const std::vector<std::string> &path)
{
  const FrameNode *node = &root;
  for (const std::string &what : path) {
    node = find(*node, what);
    if (!node) {
      throw std::runtime_error("the tree has no '" + what + "' there");
    }
  }
  return *node;
}

TEST(LeftOutOfTheHost, TheTreeNamesAMeshWhoseBuffersTheHostHasNotNamed)
{
  scene::Scene scene;
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  test::add_object(scene, test::add_square_mesh(scene, material), glm::dmat4(1));
  const auto terrain = scene.add(scene::Mesh{
      .name = "terrain", .material = material, .host_shape = scene::HostShape{.bounds = {{-1, -1, -1}, {1, 1, 1}}}});
  test::add_object(scene, terrain, glm::dmat4(1));
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  SceneRenderer renderer(*device, scene, {16, 16}, {.sample_count = 1});
  const auto node = [&] {
    renderer.sync();
    renderer.draw(test::camera_at({0, -5, 4}, {0, 0, 0}, 0.6F));
    return node_at(renderer.inspect().report().tree, {"meshes", "terrain"});
  };
  const FrameNode without = node();
  EXPECT_FALSE(without.is_made);
  EXPECT_EQ(without.why, "the host has named no buffers of it");
  const auto warnings = [&] { return renderer.inspect().report().warnings; };
  EXPECT_EQ(warnings(),
            std::vector<std::string>{"mesh 'terrain': the host has named no buffers of it, so that it is not drawn"});
  renderer.render_scene().set_host_batch(
      terrain,
      gpu::HostBatch{
          .positions = {1, 0, 12}, .normals = {2, 0, 12}, .vertex_count = 3, .index_buffer = 3, .index_count = 3});
  const FrameNode with = node();
  EXPECT_TRUE(with.is_made);
  EXPECT_TRUE(warnings().empty());
  EXPECT_EQ(with.bytes, 0U);
  EXPECT_EQ(with.upload_bytes, 0U);
}

TEST_F(LeftOut, TheTreeNamesTheStepThatWroteWhatAStepReads)
{
  const auto reads = [](const std::string &name, const std::string &step) {
    return node_at(taken.at(name).tree, {"passes", step, "reads"}).why;
  };
  EXPECT_EQ(reads("full", "deferred_lit").substr(0, 17), "depth of gbuffer,");
  // If several steps write it, the report names the last.
  test::expect_contains(reads("full", "lit"),
                        "depth of forward_depth, shadow_cubes of shadows, shadow_maps of shadows");
  EXPECT_EQ(reads("no shadow", "lit"), "depth of forward_depth");
  EXPECT_EQ(reads("full", "film"), "radiance of lit");
  EXPECT_EQ(reads("full", "tonemap"), "film of film, depth of forward_depth");
}

TEST_F(LeftOut, TheTreeGivesTheReason)
{
  const auto expect_reason = [](const std::string &name, const std::vector<std::string> &path,
                                const std::string &reason) {
    const FrameNode &node = node_at(taken.at(name).tree, path);
    EXPECT_FALSE(node.is_made) << name << ": " << path.back();
    EXPECT_EQ(node.why, reason) << name << ": " << path.back();
    EXPECT_TRUE(node_at(taken.at("full").tree, path).is_made) << path.back();
  };
  for (const char *program : {"eevee_adaptive_test", "eevee_adaptive_scale", "eevee_probe", "eevee_surfaces"}) {
    EXPECT_EQ(node_at(taken.at("full").tree, {"programs", program}).why, "not asked for") << program;
  }
  expect_reason("no lamp", {"programs", "features", "USE_LIGHT"}, "no lamp gives light");
  expect_reason("no lamp", {"targets", "shadow_maps"}, "no lamp gives light");
  expect_reason("no lamp", {"textures", "checks"}, "no lamp lights it, and it cuts nothing out");
  expect_reason("no point", {"targets", "shadow_cubes"}, "no point lamp or wide spot casts a shadow of depths");
  expect_reason("no shadow", {"passes", "shadows"}, "shadows are off");
  expect_reason("no shadow", {"shadows", "SUN"}, "shadows are off");
  expect_reason("no texture", {"textures", "holes"}, "no object has a material that looks it up");
  const std::string in_gbuffer = "all objects are in the G-buffer";
  expect_reason("no texture", {"passes", "forward_depth"}, in_gbuffer);
  expect_reason("no texture", {"passes", "lit"}, in_gbuffer);
  expect_reason("no texture", {"passes", "lit", "lit_pass"}, in_gbuffer);
  expect_reason("no texture", {"programs", "eevee_lit"}, in_gbuffer);
  expect_reason("no alpha", {"programs", "features", "USE_ALPHA_MASK"}, "no texture's alpha cuts a material out");
  expect_reason("no specular", {"programs", "features", "USE_SPECULAR"}, "every material is Lambertian");
  for (const char *name : {"no visible receiver", "nothing at all"}) {
    expect_reason(name, {"programs"}, "nothing is seen");
    expect_reason(name, {"passes", "lit"}, "nothing is seen");
    expect_reason(name, {"targets", "radiance"}, "nothing is seen");
  }
  expect_reason("no visible receiver", {"shadows", "POINT"}, "nothing is seen");
}

class LeftOutChange : public testing::Test {
 protected:
  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
};

TEST_F(LeftOutChange, NewlyVisibleObjectsCreateTheirResourcesAndShadows)
{
  const measure::LeftOutCase full = measure::left_out_cases().front();
  test::Renderer renderer(*device, full.scene, {64, 36}, full.settings);
  renderer.draw(test::camera_at({0, 4, 20}, {0, 4, 40}));
  EXPECT_EQ(device->counters().shaders_made, 0U);
  renderer.draw(full.scene.placed_cameras().front());
  EXPECT_EQ(device->counters().passes - device->pass_counts().at("film"), device->counters().passes - 2U);
  EXPECT_EQ(device->pass_counts().at("lit"), 1U);
  EXPECT_EQ(renderer.inspect().report().shadow_counters.lamps_updated, 3U);
  const std::uint64_t made = device->counters().shaders_made;
  // After switching back, resources remain and are not used.
  renderer.draw(test::camera_at({0, 4, 20}, {0, 4, 40}));
  EXPECT_EQ(device->counters().shaders_made, made);
  EXPECT_EQ(device->pass_counts().at("lit"), 1U);
  EXPECT_EQ(device->pass_counts().at("film"), 3U);
}

TEST_F(LeftOutChange, ALampThatGoesTakesItsTargetsAndBlocksWithIt)
{
  measure::LeftOutCase full = measure::left_out_cases().front();
  test::Renderer renderer(*device, full.scene, {64, 36}, full.settings);
  renderer.draw(full.scene.placed_cameras().front());
  test::remove_lamps(full.scene);
  renderer.sync();
  renderer.draw(full.scene.placed_cameras().front());
  for (const std::string &resource : device->live_resources()) {
    EXPECT_EQ(resource.find("shadow_cubes"), std::string::npos) << resource;
    EXPECT_EQ(resource.find("shadow_maps"), std::string::npos) << resource;
    EXPECT_EQ(resource.find("_block") == std::string::npos || resource == "buffer 'view_block'" ||
                  resource == "buffer 'object_block'" || resource == "buffer 'material_block'",
              true)
        << resource;
  }
}

TEST_F(LeftOutChange, DrawsOutsideOfTheViewAreCountedAsCulled)
{
  scene::Scene scene;
  const auto square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
  for (const float x : {0.0F, 30.0F, 60.0F}) {
    test::add_object(scene, square, glm::translate(glm::mat4(1.0F), glm::vec3(x, 0, 0)));
  }
  test::Renderer renderer(*device, scene, {16, 16}, {.sample_count = 2});
  renderer.draw(test::camera_at({0, 0, 4}, {0, 0, 0}));
  const FrameNode tree = renderer.inspect().report().tree;
  for (const char *pass : {"depth_pass", "lit_pass"}) {
    EXPECT_EQ(node_at(tree, {"draws", pass}).count, 2U) << "one, in two samples";
    EXPECT_EQ(node_at(tree, {"draws", pass, "culled"}).count, 4U);
  }
}

TEST_F(LeftOutChange, UpToDateShadowsAreKeptAndReported)
{
  const measure::LeftOutCase full = measure::left_out_cases().front();
  test::Renderer renderer(*device, full.scene, {64, 36}, full.settings);
  const auto layers = [&](const char *state) {
    renderer.draw(full.scene.placed_cameras().front());
    const FrameNode tree = renderer.inspect().report().tree;
    EXPECT_EQ(node_at(tree, {"passes", "shadows"}).is_made, std::string(state) == "drawn");
    return node_at(tree, {"shadows", "POINT", state}).count.value_or(0);
  };
  const std::uint64_t drawn = layers("drawn");
  EXPECT_GT(drawn, 0U);
  EXPECT_EQ(layers("kept"), drawn);
}

TEST_F(LeftOutChange, UnusedMaterialsCreateNothing)
{
  scene::Scene scene;
  const auto plain = test::add_material(scene, glm::vec3(0.5F));
  test::add_object(scene, test::add_square_mesh(scene, plain), glm::mat4(1.0F));
  test::add_lamp(scene, scene::LampKind::Hemi, {0, 0, 2}, {0, 0, -1}, 1.0F);
  scene.edit(test::add_material(scene, glm::vec3(1.0F)),
             [](scene::Material &material) { material.specular_color = glm::vec3(1.0F); });
  test::Renderer renderer(*device, scene, {16, 16});
  renderer.draw(test::camera_at({0, 0, 4}, {0, 0, 0}));
  for (const gpu::LiveResource &live : device->live()) {
    EXPECT_EQ(live.detail.find("USE_SPECULAR"), std::string::npos) << live.name;
  }
}

TEST_F(LeftOutChange, UvsAreUploadedWithTheLightThatNeedsThem)
{
  scene::Scene scene;
  const auto textured = test::add_material(scene, glm::vec3(0.5F));
  const auto texture = test::add_texture(scene, 1, {255, 0, 0, 255});
  scene.edit(textured, [&](scene::Material &material) { material.base_color_texture = texture; });
  test::add_object(scene, test::add_square_mesh(scene, textured), glm::mat4(1.0F));
  const auto mesh_bytes = [&](test::Renderer &renderer) {
    renderer.draw(test::camera_at({0, 0, 4}, {0, 0, 0}));
    return find(renderer.inspect().report().tree, "meshes")->bytes;
  };
  test::Renderer renderer(*device, scene, {16, 16});
  const std::size_t bare = 4U * 2U * sizeof(glm::vec3) + 6U * sizeof(std::uint32_t);
  EXPECT_EQ(mesh_bytes(renderer), bare);
  test::add_lamp(scene, scene::LampKind::Hemi, {0, 0, 2}, {0, 0, -1}, 1.0F);
  renderer.sync();
  EXPECT_EQ(mesh_bytes(renderer), bare + 4U * sizeof(glm::vec2));
}

TEST_F(LeftOutChange, ASpotThatNothingVisibleLooksUpIsDrawnWhenSomethingDoes)
{
  scene::Scene scene;
  const auto plain = test::add_material(scene, glm::vec3(0.5F));
  const auto square = test::add_square_mesh(scene, plain);
  test::add_object(scene, square, glm::mat4(1.0F));
  test::add_object(scene, square, glm::translate(glm::mat4(1.0F), glm::vec3(20, 0, 0)));
  scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {20, 0, 3}, {0, 0, -1}, 1.0F),
             [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.5F; });
  test::Renderer renderer(*device, scene, {16, 16});
  const auto layers = [&](const scene::PlacedCamera &camera) {
    renderer.draw(camera);
    return find(*find(renderer.inspect().report().tree, "shadows"), "lamp0")->count;
  };
  // The box of the casters spans both squares. Its visible part does not reach the cone.
  EXPECT_EQ(layers(test::camera_at({0, 0, 4}, {0, 0, 0})), 0U);
  EXPECT_EQ(layers(test::camera_at({20, 0, 4}, {20, 0, 0})), 1U);
}

TEST_F(LeftOutChange, ExponentialShadowsAloneTakeNoBlockOfDepths)
{
  measure::LeftOutCase full = measure::left_out_cases().front();
  full.settings.shadow.kind = scene::ShadowKind::Esm;
  test::remove_lamps(full.scene, [](const scene::Lamp &lamp) { return lamp.kind == scene::LampKind::Sun; });
  test::Renderer renderer(*device, full.scene, {64, 36}, full.settings);
  renderer.draw(full.scene.placed_cameras().front());
  EXPECT_TRUE(std::ranges::count(device->live_resources(), "buffer 'esm_block'") == 1);
  EXPECT_TRUE(std::ranges::count(device->live_resources(), "buffer 'shadow_block'") == 0);
  EXPECT_EQ(renderer.inspect().report().tree.bytes, device->memory_bytes());
}

}  // namespace
}  // namespace gnomon::eevee
