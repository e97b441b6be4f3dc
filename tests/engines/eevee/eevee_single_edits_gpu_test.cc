// SPDX-License-Identifier: MIT
// Each edit of a scene and each setting, alone and in random order, under live renderers: the pictures are those of
// renderers that are made after the edit.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"
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

/**
 * Maps that are fitted to the picture without slack, so that they do not depend on pictures before. Several samples
 * have one emissive point each instead of four, whose shadows of 256 x 256 texels would take most of the time.
 */
Settings small_settings(int sample_count)
{
  Settings settings{.sample_count = sample_count};
  settings.emissive_point_count = sample_count > 1 ? 1 : 0;
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

class SingleEditsGpu : public test::SharedDeviceTest {};

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

/**
 * Adds edits of all settings of a part of \a settings but those of a type of their own. \a part: returns the part.
 * \a prepare: makes the setting with the name have an effect.
 */
template <typename Part, typename Access, typename Prepare>
void add_setting_edits(std::vector<SettingEdit> &edits, const Settings &settings, Access part, Prepare prepare)
{
  Part::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    if constexpr (!std::is_same_v<Value, Background> && !std::is_same_v<Value, PcfKernel>) {
      Settings prepared = settings;
      prepare(prepared, row.name);
      // Hundreds of samples take long.
      const test::EditLimits limits = row.name == "sample_count" ? test::EditLimits{1.0, 3.0} : test::edit_limits(row);
      for (const Value &other : test::other_values(row.access(part(prepared)), limits.min, limits.max)) {
        Settings changed = prepared;
        row.access(part(changed)) = other;
        edits.push_back({std::string(row.name), [=](Settings &one) { one = changed; }});
        // The maps of suns may keep an extent (still_fits), and maps may keep 32 bits: 6e-4 and 1.5e-4 here.
        edits.back().rms_max = row.name == "is_fitted_to_depth" ? 1e-3 : row.name == "can_have_short_maps" ? 3e-4 : 0.0;
      }
    }
  });
}

std::vector<SettingEdit> setting_edits(const Settings &settings)
{
  std::vector<SettingEdit> edits;
  add_setting_edits<Settings>(
      edits, settings, [](auto &all) -> auto & { return all; }, [](Settings &, std::string_view) {});
  const auto add = [&](const char *name, std::function<void(Settings &)> change) {
    edits.push_back({name, std::move(change)});
  };
  add("background", [](Settings &one) { one.background = {Background::Kind::Color, {0.1F, 0.2F, 0.3F}}; });
  add("background", [](Settings &one) { one.background.kind = Background::Kind::World; });
  for (const LightComponent component :
       {LightComponent{LightComponent::Kind::Lamp, 0}, LightComponent{LightComponent::Kind::Lamp, 1},
        LightComponent{LightComponent::Kind::World}, LightComponent{LightComponent::Kind::Emission}}) {
    add("light", [=](Settings &one) { one.light = component; });
  }
  add("sample_first", [](Settings &one) { one.sample_first = one.sample_count - 1; });
  add("sample_end", [](Settings &one) { one.sample_end = 1; });
  add("has_probe", [](Settings &one) { one.has_probe = true; });
  add("has_surfaces", [](Settings &one) { one.has_surfaces = true; });
  return edits;
}

std::vector<SettingEdit> shadow_setting_edits(const Settings &settings)
{
  using enum scene::ShadowKind;
  std::vector<SettingEdit> edits;
  add_setting_edits<ShadowSettings>(
      edits, settings, [](auto &all) -> auto & { return all.shadow; },
      [](Settings &one, std::string_view name) {
        const bool is_exponential = scene::description_of<EsmSettings>(name).name == name;
        one.shadow.kind = is_exponential ? Esm : one.shadow.kind;
        if (name == "cascade_lambda") {
          one.shadow.is_fitted_to_depth = false;
          one.shadow.cascades.count = 3;
        }
        one.shadow.cascades.can_resize |= name == "cascade_texel_max";
      });
  for (const PcfKernel pcf : {PcfKernel{1}, PcfKernel{5}, PcfKernel{0, 7}}) {
    edits.push_back({"pcf", [=](Settings &one) {
                       one.shadow.kind = Pcf;
                       one.shadow.pcf = pcf;
                     }});
  }
  edits.push_back({"method", [](Settings &one) {
                     one.shadow.kind = Esm;
                     one.shadow.esm.method = EsmMethod::Evsm;
                   }});
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
  const auto expect_same = [&](const scene::Scene &scene, const Settings &settings,
                               const std::vector<SettingEdit> &edits) {
    SCOPED_TRACE(settings.sample_count);
    // One viewport each: the memory of shadows is divided among viewports.
    SceneRenderer live(*device, scene, single_edits_size_px, settings);
    const auto picture_of = [](SceneRenderer &renderer) {
      renderer.sync();
      renderer.draw(first_camera());
      return renderer.read_picture();
    };
    const EditPixels before = picture_of(live);
    for (const SettingEdit &edit : edits) {
      Settings changed = settings;
      edit.change(changed);
      if (!test::has_layer_pass(device->limits(), changed.shadow.layer_pass)) {
        continue;
      }
      live.set_settings(changed);
      const EditPixels edited = picture_of(live);
      SceneRenderer made(*device, scene, single_edits_size_px, changed);
      EXPECT_LE(difference_of(edited, picture_of(made)).rms, edit.rms_max) << edit.name;
      live.set_settings(settings);
      EXPECT_EQ(difference_of(picture_of(live), before).rms, 0.0) << "not " << edit.name;
    }
  };
  const scene::Scene lights = scene_of_all_lights();
  for (const int sample_count : {1, 4}) {
    const Settings settings = small_settings(sample_count);
    expect_same(lights, settings, setting_edits(settings));
    expect_same(lights, settings, shadow_setting_edits(settings));
  }
  expect_same(test::material_scene(test::SlotTextures::None, "hard").scene, small_settings(4),
              setting_edits(small_settings(4)));
}

}  // namespace
}  // namespace gnomon::eevee
