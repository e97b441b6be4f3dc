// SPDX-License-Identifier: MIT
// A randomly edited scene gives the same picture as a scene that was built in the final state.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <random>

namespace gnomon::eevee {
namespace {

using scene::Handle;

constexpr glm::ivec2 random_edits_size_px{96, 54};

/** Edits a scene with things of all kinds, and keeps it finite and small. */
class RandomEditor {
 public:
  RandomEditor(scene::Scene &scene, std::uint32_t seed) : scene_(scene), random_(seed)
  {
    for (int i = 0; i < 3; i++) {
      std::vector<std::uint8_t> texels(16 * 4);
      for (std::uint8_t &texel : texels) {
        texel = std::uint8_t(below(256));
      }
      textures_.push_back(test::add_texture(scene_, 4, texels));
    }
    for (int i = 0; i < 5; i++) {
      materials_.push_back(test::add_material(scene_, glm::vec3(0.3F + 0.1F * float(i))));
    }
    for (int i = 0; i < 4; i++) {
      const Handle<scene::Material> material = materials_[below(materials_.size())];
      meshes_.push_back(i == 0 ? test::add_square_mesh(scene_, material) : test::add_box_mesh(scene_, material));
    }
    test::add_object(scene_, meshes_[0], glm::scale(glm::dmat4(1.0), glm::dvec3(6.0)));
    for (int i = 0; i < 6; i++) {
      add_object();
    }
    for (int i = 0; i < 3; i++) {
      add_lamp();
    }
  }

  void edit()
  {
    switch (below(16)) {
      case 0: add_object(); break;
      case 1: remove_one(objects_, 3); break;
      case 2: add_lamp(); break;
      case 3: remove_one(lamps_, 1); break;
      case 4: scene_.set_transform(pick(objects_), object_matrix()); break;
      case 5: scene_.set_transform(pick(lamps_), lamp_matrix()); break;
      case 6:
        scene_.edit(scene_.nodes()[pick(lamps_)].lamp,
                    [&](scene::Lamp &lamp) { lamp.intensity = float(uniform(0.0, 20.0)); });
        break;
      case 7:
        scene_.edit(scene_.nodes()[pick(lamps_)].lamp, [&](scene::Lamp &lamp) {
          lamp.name = std::to_string(below(1000));
          lamp.shadow.kind = scene::ShadowKind(below(4));
        });
        break;
      case 8: scene_.edit(pick(objects_), [&](scene::Node &node) { node.is_visible = !node.is_visible; }); break;
      case 9: scene_.edit(pick(objects_), [&](scene::Node &node) { node.meshes = {pick(meshes_)}; }); break;
      case 10: edit_material(); break;
      case 11: edit_mesh(); break;
      case 12: edit_image(); break;
      case 13: scene_.edit(pick(objects_), [&](scene::Node &node) { node.casts_shadow = !node.casts_shadow; }); break;
      case 14:
        scene_.edit(pick(objects_), [&](scene::Node &node) { node.receives_shadow = !node.receives_shadow; });
        break;
      case 15: edit_vertices(); break;
      default: break;
    }
  }

 private:
  std::size_t below(std::size_t count)
  {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  double uniform(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  template <typename T>
  T pick(const std::vector<T> &things)
  {
    return things[below(things.size())];
  }
  glm::dmat4 object_matrix()
  {
    const glm::dvec3 position(uniform(-3, 3), uniform(-3, 3), uniform(0.5, 2));
    const glm::dvec3 scale(uniform(0.2, 0.5), uniform(0.2, 0.5), uniform(0.2, 0.5) * (below(4) == 0 ? -1.0 : 1.0));
    return glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), position), uniform(0, 3), glm::dvec3(0.6, 0, 0.8)),
                      scale);
  }
  glm::dmat4 lamp_matrix()
  {
    return glm::inverse(glm::lookAt(glm::dvec3(uniform(-3, 3), uniform(-3, 3), uniform(4, 6)),
                                    glm::dvec3(uniform(-1, 1), uniform(-1, 1), 0), glm::dvec3(0, 1, 0)));
  }
  void add_object()
  {
    if (objects_.size() < 14) {
      objects_.push_back(test::add_object(scene_, pick(meshes_), object_matrix()));
    }
  }
  void add_lamp()
  {
    if (lamps_.size() >= 5) {
      return;
    }
    scene::Lamp lamp;
    lamp.kind = scene::LampKind(below(4));
    lamp.intensity = lamp.kind == scene::LampKind::Sun || lamp.kind == scene::LampKind::Hemi ? 1.0F : 10.0F;
    scene::Node node;
    node.parent_from_node = lamp_matrix();
    node.lamp = scene_.add(lamp);
    lamps_.push_back(scene_.add(node));
  }
  void remove_one(std::vector<Handle<scene::Node>> &nodes, std::size_t least)
  {
    if (nodes.size() > least) {
      const std::size_t index = below(nodes.size());
      scene_.remove(nodes[index]);
      nodes.erase(nodes.begin() + std::ptrdiff_t(index));
    }
  }
  void edit_material()
  {
    scene_.edit(pick(materials_), [&](scene::Material &material) {
      switch (below(5)) {
        case 0: material.base_color = glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)); break;
        case 1: material.specular_color = glm::vec3(float(below(2))); break;
        case 2: material.is_double_sided = !material.is_double_sided; break;
        case 3: material.base_color_texture = below(2) == 0 ? Handle<scene::Texture>() : pick(textures_); break;
        default: material.alpha_mode = below(2) == 0 ? scene::AlphaMode::Opaque : scene::AlphaMode::Mask; break;
      }
    });
  }
  void edit_mesh()
  {
    scene_.edit(pick(meshes_), [&](scene::Mesh &mesh) {
      if (below(2) == 0) {
        mesh.material = pick(materials_);
        return;
      }
      for (glm::vec3 &position : mesh.positions) {
        position *= float(uniform(0.97, 1.03));
      }
    });
  }
  void edit_vertices()
  {
    const Handle<scene::Mesh> mesh = pick(meshes_);
    const std::vector<glm::vec3> &positions = scene_.meshes()[mesh].positions;
    const auto vertex = std::uint32_t(below(positions.size()));
    const glm::vec3 moved = positions[vertex] * float(uniform(0.9, 1.1));
    scene_.set_vertices(mesh, {.vertices = std::span(&vertex, 1), .positions = std::span(&moved, 1)});
  }
  void edit_image()
  {
    scene_.edit(scene_.textures()[pick(textures_)].image,
                [&](scene::Image &image) { image.texels[below(image.texels.size())] = std::uint8_t(below(256)); });
  }

  scene::Scene &scene_;
  std::mt19937 random_;
  std::vector<Handle<scene::Texture>> textures_;
  std::vector<Handle<scene::Material>> materials_;
  std::vector<Handle<scene::Mesh>> meshes_;
  std::vector<Handle<scene::Node>> objects_;
  std::vector<Handle<scene::Node>> lamps_;
};

class RandomEdits : public test::SharedDeviceTest {
 protected:
  static Settings settings()
  {
    Settings settings;
    settings.shadow.cube_size_px = 128;
    settings.shadow.map_size_px = 128;
    settings.shadow.esm.size_px = 64;
    return settings;
  }
  std::vector<glm::vec4> picture_of(SceneRenderer &renderer)
  {
    renderer.sync();
    renderer.draw(camera);
    return renderer.read_picture();
  }
  scene::PlacedCamera camera = test::camera_at({0, -7, 7}, {0, 0, 0.5F});
};

double rms_difference(const std::vector<glm::vec4> &a, const std::vector<glm::vec4> &b)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); i++) {
    const glm::dvec3 difference = glm::dvec3(a[i]) - glm::dvec3(b[i]);
    sum += glm::dot(difference, difference);
  }
  return std::sqrt(sum / (3.0 * double(a.size())));
}

/**
 * With many edits between pictures, one that others make known to the renderer hides one that it overlooks: nearly all
 * intervals have edits after which all passes are built again. So most pictures are drawn after a single edit.
 */
TEST_F(RandomEdits, GiveThePictureOfASceneBuiltInTheFinalState)
{
  for (const auto &[picture_count, edits_between_pictures] : {std::pair(200, 1), {20, 20}, {8, 1000}}) {
    scene::Scene scene;
    RandomEditor editor(scene, 7);
    SceneRenderer edited(*device, scene, random_edits_size_px, settings());
    for (int i = 1; i <= picture_count * edits_between_pictures; i++) {
      editor.edit();
      // The renderer is synced for some of the intermediate states only.
      if (i % 50 == 0) {
        edited.sync();
        edited.draw(camera);
      }
      if (i % edits_between_pictures != 0) {
        continue;
      }
      const scene::Scene copy = scene;
      SceneRenderer fresh(*device, copy, random_edits_size_px, settings());
      ASSERT_LE(rms_difference(picture_of(edited), picture_of(fresh)), 1e-4)
          << "after " << i << " edits, " << edits_between_pictures << " between pictures";
    }
  }
}

/** Shared by the viewports of one scene: meshes, images, programs. */
TEST_F(RandomEdits, TwoViewportsOfOneSceneDrawItFromOneCopy)
{
  scene::Scene scene;
  RandomEditor editor(scene, 11);
  render_scene::RenderScene shared(*device, scene);
  shared.update();
  Engine engine(shared, settings());
  draw::Viewport first(*device, random_edits_size_px);
  draw::Viewport second(*device, {54, 54});
  const std::array<draw::Engine *, 1> engines = {&engine};
  const auto draw_in = [&](draw::Viewport &viewport, const scene::PlacedCamera &from) {
    viewport.sync(engines, shared.objects());
    viewport.draw(engines, view_of(from, viewport.size_px()));
    return gpu::read_as<glm::vec4>(*device, engine.radiance(viewport));
  };
  const scene::PlacedCamera other = test::camera_at({5, -4, 4}, {0, 0, 0.5F});
  draw_in(first, camera);
  const auto scene_bytes = [&] {
    std::size_t bytes = 0;
    std::size_t shaders = 0;
    for (const gpu::LiveResource &live : device->live()) {
      const bool is_target = live.name == "film" || live.name == "depth" || live.name == "radiance" ||
                             live.name.starts_with("shadow") || live.name == "view_block" ||
                             live.name == "light_block" || live.name == "esm_block";
      bytes += is_target ? 0 : live.size_bytes;
      shaders += live.kind == gpu::ResourceKind::Shader ? 1 : 0;
    }
    return std::pair(bytes, shaders);
  };
  const auto with_one = scene_bytes();
  const std::vector<glm::vec4> from_second = draw_in(second, other);
  EXPECT_EQ(scene_bytes(), with_one);
  SceneRenderer alone(*device, scene, {54, 54}, settings());
  alone.sync();
  alone.draw(other);
  EXPECT_EQ(alone.read_picture(), from_second);
}

}  // namespace
}  // namespace gnomon::eevee
