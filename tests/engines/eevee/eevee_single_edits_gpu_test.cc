// SPDX-License-Identifier: MIT
// Each edit of a scene and each setting, alone and in random order, under live renderers: the pictures are those of
// renderers that are made after the edit.
#include "eevee_scene_renderer.hh"
#include "engines/scene_edits.hh"

#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace gnomon::eevee {
namespace {

using test::difference_of;
using test::EditedScene;
using test::PictureDifference;
using test::SceneEdit;
using EditPixels = std::vector<glm::vec4>;

constexpr glm::ivec2 single_edits_size_px{40, 28};

/** Maps that are fitted to the picture without slack, so that they do not depend on pictures before. */
Settings small_settings(int sample_count)
{
  Settings settings{.sample_count = sample_count};
  settings.shadow.cube_size_px = settings.shadow.map_size_px = 64;
  settings.shadow.esm.size_px = 32;
  settings.shadow.is_fitted_to_depth = true;
  return settings;
}

scene::PlacedCamera first_camera()
{
  return test::camera_at({0, -5, 5}, {0, 0, 0.3F});
}

scene::PlacedCamera second_camera()
{
  return test::camera_at({4, -3, 4}, {0, 0, 0.3F});
}

/** One engine that draws a scene in two viewports. */
class TwoViewports {
 public:
  TwoViewports(gpu::Device &device, const scene::Scene &scene, const Settings &settings)
      : render_scene_(device, scene),
        engine_(render_scene_, settings),
        first_(device, single_edits_size_px),
        second_(device, single_edits_size_px)
  {
  }
  void set_settings(const Settings &settings)
  {
    engine_.set_settings(settings);
  }
  /** The picture of the first camera, and then that of the second. */
  EditPixels first_picture()
  {
    return picture(first_, first_camera());
  }
  EditPixels second_picture()
  {
    return picture(second_, second_camera());
  }

 private:
  EditPixels picture(draw::Viewport &viewport, const scene::PlacedCamera &camera)
  {
    const std::array<draw::Engine *, 1> engines = {&engine_};
    render_scene_.update();
    // Restarts the picture if an edit changes it, and only then.
    viewport.sync(engines, render_scene_.objects());
    while (viewport.samples_drawn() < engine_.settings().drawn_sample_count()) {
      viewport.draw(engines, view_of(camera, single_edits_size_px));
    }
    EditPixels pixels = gpu::read_as<glm::vec4>(viewport.device(), engine_.radiance(viewport));
    for (glm::vec4 &pixel : pixels) {
      pixel *= engine_.radiance_scale(viewport);
    }
    return pixels;
  }

  render_scene::RenderScene render_scene_;
  Engine engine_;
  draw::Viewport first_;
  draw::Viewport second_;
};

/** Pictures of both cameras with one sample, and of the first with several. */
struct EditPictures {
  EditPixels first;
  EditPixels second;
  EditPixels several_samples;
};

/** Pictures of renderers that are made now. */
EditPictures new_pictures(gpu::Device &device, const scene::Scene &scene)
{
  TwoViewports made(device, scene, small_settings(1));
  EditPictures pictures{made.first_picture(), made.second_picture(), {}};
  made.set_settings(small_settings(4));
  pictures.several_samples = made.first_picture();
  return pictures;
}

/** Renderers of a scene that live while it is edited. */
class LiveRenderers {
 public:
  LiveRenderers(gpu::Device &device, const scene::Scene &scene)
      : one_sample_(device, scene, single_edits_size_px, small_settings(1)),
        several_samples_(device, scene, single_edits_size_px, small_settings(4)),
        two_(device, scene, small_settings(1))
  {
  }
  void expect(const EditPictures &pictures, const std::string &after)
  {
    expect_same(picture_of(one_sample_), pictures.first, after, "one sample");
    expect_same(picture_of(several_samples_), pictures.several_samples, after, "several samples");
    expect_same(two_.first_picture(), pictures.first, after, "the first viewport");
    expect_same(two_.second_picture(), pictures.second, after, "the second viewport");
  }

 private:
  static EditPixels picture_of(SceneRenderer &renderer)
  {
    renderer.sync();
    renderer.draw(first_camera());
    return renderer.read_picture();
  }
  static void expect_same(const EditPixels &live, const EditPixels &made, const std::string &after, const char *where)
  {
    const PictureDifference difference = difference_of(live, made);
    EXPECT_EQ(difference.pixel_count, 0U) << after << ", " << where << ": " << difference.rms;
  }

  SceneRenderer one_sample_;
  SceneRenderer several_samples_;
  TwoViewports two_;
};

class SingleEditsGpu : public test::GpuDeviceTest {};

TEST_F(SingleEditsGpu, OfEachPropertyAndThingGiveThePictureOfANewRenderer)
{
  for (EditedScene &edited : test::edited_scenes()) {
    LiveRenderers live(*device, edited.scene);
    const EditPictures before = new_pictures(*device, edited.scene);
    live.expect(before, edited.name);
    for (const SceneEdit &edit : edited.edits) {
      edit.apply(edited.scene);
      live.expect(new_pictures(*device, edited.scene), edit.name);
      edit.undo(edited.scene);
      live.expect(edit.is_restored ? before : new_pictures(*device, edited.scene), "not " + edit.name);
    }
    EXPECT_LE(edited.refused_count, 2) << edited.name;
  }
}

/** Applies a random edit, or takes it back. \return its name; empty: what it edits was removed by another. */
std::string edit_at_random(EditedScene &edited, std::vector<bool> &are_applied, std::mt19937 &random)
{
  const std::size_t index = random() % edited.edits.size();
  const SceneEdit &edit = edited.edits[index];
  try {
    (are_applied[index] ? edit.undo : edit.apply)(edited.scene);
  }
  catch (const scene::StaleHandle &) {
    return {};
  }
  catch (const scene::InvalidEdit &) {
    return {};
  }
  are_applied[index] = !are_applied[index];
  return (are_applied[index] ? "" : "not ") + edit.name;
}

TEST_F(SingleEditsGpu, InRandomOrderGiveThePictureOfANewRenderer)
{
  std::mt19937 random(3);
  for (EditedScene &edited : test::edited_scenes()) {
    LiveRenderers live(*device, edited.scene);
    std::vector<bool> are_applied(edited.edits.size());
    std::string edits;
    for (int i = 0; i < 12; i++) {
      for (std::uint32_t count = 1 + std::uint32_t(random() % 3); count > 0; count--) {
        edits += edit_at_random(edited, are_applied, random) + "; ";
      }
      live.expect(new_pictures(*device, edited.scene), edited.name + ": " + edits);
    }
  }
}

struct SettingEdit {
  std::string name;
  std::function<void(Settings &)> change;
  /** Maximum RMS difference due to maps and formats that are kept from earlier pictures. 0: none. */
  double rms_max = 0.0;
};

/** All settings. A new member does not compile here: it needs edits below. */
[[maybe_unused]] void name_all(const Settings &settings)
{
  [[maybe_unused]] const auto &[shadow, background, light, sample_count, sample_first, sample_end, seed,
                                noise_threshold, has_multiscatter, emissive_point_count, is_timed, light_threshold,
                                clustered_lamps_min, has_cascade_tint, has_probe, has_surfaces] = settings;
  [[maybe_unused]] const auto &[kind, cube_size_px, map_size_px, pcf, esm, cascades, is_fitted_to_depth,
                                can_have_short_maps, layer_pass, caster_faces, memory_bytes_max] = shadow;
  [[maybe_unused]] const auto &[width, taps] = pcf;
  [[maybe_unused]] const auto &[method, exponent, bias, filter_angle, size, format, kernel] = esm;
  [[maybe_unused]] const auto &[count, lambda, can_resize, texel_in_pixels_enlarged] = cascades;
}

std::vector<SettingEdit> setting_edits()
{
  std::vector<SettingEdit> edits;
  const auto add = [&](const char *name, std::function<void(Settings &)> change, double rms_max = 0.0) {
    edits.push_back({name, std::move(change), rms_max});
  };
  using enum scene::ShadowKind;
  for (const scene::ShadowKind kind : {None, Hard, Pcf, Esm, Evsm}) {
    add("shadow.kind", [=](Settings &one) { one.shadow.kind = kind; });
  }
  add("shadow.cube_size_px", [](Settings &one) { one.shadow.cube_size_px = 48; });
  add("shadow.map_size_px", [](Settings &one) { one.shadow.map_size_px = 48; });
  for (const PcfKernel pcf : {PcfKernel{1}, PcfKernel{5}, PcfKernel{0, 7}}) {
    add("shadow.pcf", [=](Settings &one) {
      one.shadow.kind = Pcf;
      one.shadow.pcf = pcf;
    });
  }
  const auto add_esm = [&](const char *name, void (*change)(EsmSettings &)) {
    add(name, [=](Settings &one) {
      one.shadow.kind = Esm;
      change(one.shadow.esm);
    });
  };
  add_esm("shadow.esm.method", [](EsmSettings &esm) { esm.method = EsmMethod::Evsm; });
  add_esm("shadow.esm.exponent", [](EsmSettings &esm) { esm.exponent = 5.0F; });
  add_esm("shadow.esm.bias", [](EsmSettings &esm) { esm.bias = 3.0F; });
  add_esm("shadow.esm.filter_angle", [](EsmSettings &esm) { esm.filter_angle = 0.2F; });
  add_esm("shadow.esm.size_px", [](EsmSettings &esm) { esm.size_px = 24; });
  add_esm("shadow.esm.format", [](EsmSettings &esm) { esm.format = EsmFormat::Half; });
  add_esm("shadow.esm.kernel", [](EsmSettings &esm) { esm.kernel = EsmKernel::Disk32; });
  add_esm("shadow.esm.kernel", [](EsmSettings &esm) { esm.kernel = EsmKernel::Separable; });
  add("shadow.cascades.count", [](Settings &one) { one.shadow.cascades.count = 2; });
  add("shadow.cascades.lambda", [](Settings &one) {
    one.shadow.is_fitted_to_depth = false;
    one.shadow.cascades = {.count = 3, .lambda = 0.2F};
  });
  add("shadow.cascades.can_resize", [](Settings &one) { one.shadow.cascades.can_resize = true; });
  add("shadow.cascades.texel_in_pixels_enlarged",
      [](Settings &one) { one.shadow.cascades = {.can_resize = true, .texel_in_pixels_enlarged = 0.5}; });
  // The maps of suns may keep an extent (still_fits), and maps may keep 32 bits: 6e-4 and 1.5e-4 here.
  add(
      "shadow.is_fitted_to_depth", [](Settings &one) { one.shadow.is_fitted_to_depth = false; }, 1e-3);
  add(
      "shadow.can_have_short_maps", [](Settings &one) { one.shadow.can_have_short_maps = true; }, 3e-4);
  add("shadow.layer_pass", [](Settings &one) { one.shadow.layer_pass = LayerPass::Single; });
  add("shadow.caster_faces", [](Settings &one) { one.shadow.caster_faces = CasterFaces::Front; });
  add("shadow.caster_faces", [](Settings &one) { one.shadow.caster_faces = CasterFaces::Back; });
  add("shadow.memory_bytes_max", [](Settings &one) { one.shadow.memory_bytes_max = 50000; });
  add("background", [](Settings &one) { one.background = {Background::Kind::Color, {0.1F, 0.2F, 0.3F}}; });
  add("background", [](Settings &one) { one.background.kind = Background::Kind::World; });
  for (const LightPart part : {LightPart{LightPart::Kind::Lamp, 0}, LightPart{LightPart::Kind::Lamp, 1},
                               LightPart{LightPart::Kind::World}, LightPart{LightPart::Kind::Emission}}) {
    add("light", [=](Settings &one) { one.light = part; });
  }
  add("sample_count", [](Settings &one) { one.sample_count = one.sample_count == 1 ? 3 : 1; });
  add("sample_first", [](Settings &one) { one.sample_first = one.sample_count - 1; });
  add("sample_end", [](Settings &one) { one.sample_end = 1; });
  add("seed", [](Settings &one) { one.seed = 5; });
  // Other samples for pixels that differ little: only in scenes without lamps with a size.
  add("noise_threshold", [](Settings &one) { one.noise_threshold = 0.05F; });
  add("has_multiscatter", [](Settings &one) { one.has_multiscatter = true; });
  add("emissive_point_count", [](Settings &one) { one.emissive_point_count = 0; });
  add("emissive_point_count", [](Settings &one) { one.emissive_point_count = 2; });
  add("is_timed", [](Settings &one) { one.is_timed = true; });
  add("light_threshold", [](Settings &one) { one.light_threshold = 2.0F; });
  add("clustered_lamps_min", [](Settings &one) { one.clustered_lamps_min = 1; });
  add("has_cascade_tint", [](Settings &one) { one.has_cascade_tint = true; });
  add("has_probe", [](Settings &one) { one.has_probe = true; });
  add("has_surfaces", [](Settings &one) { one.has_surfaces = true; });
  return edits;
}

/** All kinds of lamps, a world, emission, and an object that lets a part of the light through. */
scene::Scene scene_of_all_lights()
{
  EditedScene edited = test::world_scene(true, "world");
  scene::Scene &scene = edited.scene;
  for (const auto &[kind, x] : {std::pair(scene::LampKind::Point, -2.0F),
                                {scene::LampKind::Sun, -1.0F},
                                {scene::LampKind::Spot, 1.0F},
                                {scene::LampKind::Area, 2.0F}}) {
    test::add_lamp_of(scene, kind, {x, -1, 3});
  }
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  scene.edit(material, [](scene::Material &one) {
    one.emissive = glm::vec3(1, 2, 1);
    one.roughness = 0.3F;
    one.specular_color = glm::vec3(1.0F);
    one.is_double_sided = false;
  });
  test::add_object(scene, test::add_box_mesh(scene, material),
                   glm::scale(glm::translate(glm::dmat4(1.0), {-1, 0.5, 1}), glm::dvec3(0.3)));
  const auto open = test::add_material(scene, glm::vec3(0.5F));
  scene.edit(open, [](scene::Material &one) {
    one.alpha_mode = scene::AlphaMode::Blend;
    one.alpha = 0.5F;
  });
  test::add_object(scene, test::add_box_mesh(scene, open),
                   glm::scale(glm::translate(glm::dmat4(1.0), {1, 0.8, 1}), glm::dvec3(0.3)));
  return scene;
}

TEST_F(SingleEditsGpu, OfEachSettingGiveThePictureOfANewRenderer)
{
  const std::array<scene::Scene, 2> scenes = {scene_of_all_lights(),
                                              test::material_scene(test::SlotTextures::None, "hard").scene};
  for (std::size_t i = 0; i < scenes.size(); i++) {
    for (const int sample_count : {1, 4}) {
      const Settings settings = small_settings(sample_count);
      // One viewport each: the memory of shadows is divided among viewports.
      SceneRenderer live(*device, scenes[i], single_edits_size_px, settings);
      const auto picture_of = [](SceneRenderer &renderer) {
        renderer.sync();
        renderer.draw(first_camera());
        return renderer.read_picture();
      };
      const EditPixels before = picture_of(live);
      for (const SettingEdit &edit : setting_edits()) {
        if (i == 1 && (edit.name.starts_with("shadow.") || sample_count == 1)) {
          continue;
        }
        Settings changed = settings;
        edit.change(changed);
        live.set_settings(changed);
        const EditPixels edited = picture_of(live);
        SceneRenderer made(*device, scenes[i], single_edits_size_px, changed);
        const PictureDifference difference = difference_of(edited, picture_of(made));
        EXPECT_LE(difference.rms, edit.rms_max) << edit.name << ", scene " << i << ", " << sample_count << " samples";
        live.set_settings(settings);
        EXPECT_EQ(difference_of(picture_of(live), before).rms, 0.0) << "not " << edit.name << ", scene " << i;
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
