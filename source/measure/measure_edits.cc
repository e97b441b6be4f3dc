// SPDX-License-Identifier: MIT
#include "measure_edits.hh"

#include "measure_scene.hh"

#include <functional>
#include <memory>

namespace gnomon::measure {

namespace {

constexpr glm::ivec2 size_px(64, 64);

glm::dmat4 box_at(double x, double y)
{
  return glm::scale(glm::translate(glm::dmat4(1.0), {x, y, 0}), glm::dvec3(0.4));
}

/** Position of a lamp. Lamps are 20 m apart in x and 40 m in y, and each lights objects within 4 m. */
glm::vec3 lamp_place(int lamp)
{
  return {20.0F * float(lamp % 10) + 9.0F, 40.0F * float(lamp / 10) + 9.0F, 2.0F};
}

class EditedScene {
 public:
  explicit EditedScene(gpu::Device &device) : device_(device)
  {
    for (int i = 0; i < 4; i++) {
      materials.push_back(add_material(scene, glm::vec3(0.2F * float(i + 1))));
    }
    image = add_textured(materials[2], scene::AlphaMode::Opaque);
    mask = add_textured(materials[3], scene::AlphaMode::Mask);
    for (const scene::Handle<scene::Material> material : materials) {
      meshes.push_back(add_box_mesh(scene, material));
    }
    for (int i = 0; i < edited_object_count; i++) {
      objects.push_back(add_object(scene, meshes[std::size_t(i % 4)], box_at(2.0 * (i % 100), 2.0 * (i / 100))));
    }
    grid = add_grid(materials[0]);
    for (int i = 0; i < edited_lamp_count; i++) {
      lamps.push_back(add_short_lamp(lamp_place(i)));
    }
    for (const scene::PlacedLamp &lamp : scene.placed_lamps()) {
      lamp_nodes.push_back(lamp.node);
    }
    const eevee::Settings settings{.shadow = {.kind = scene::ShadowKind::Hard, .cube_size_px = 16}};
    renderer.emplace(device, scene, size_px, settings);
  }

  scene::Handle<scene::Lamp> add_short_lamp(const glm::vec3 &position)
  {
    const auto lamp = add_lamp(scene, scene::LampKind::Point, position, {0, 0, -1}, 1.0F);
    scene.edit(lamp, [](scene::Lamp &value) { value.range = 4.0F; });
    return lamp;
  }

  /** The object in a column and row of the grid of 100 by 100 objects, which are 2 m apart. */
  [[nodiscard]] scene::Handle<scene::Node> object(int column, int row) const
  {
    return objects[std::size_t(100 * row + column)];
  }

  /** The cost of \a change, and of the following sync and picture of \a viewport by \a engine. */
  template <typename Change>
  EditCost cost_of(std::string edit, draw::Viewport &viewport, eevee::Engine &engine, Change &&change)
  {
    const std::array<draw::Engine *, 1> engines = {&engine};
    const draw::View view = eevee::view_of(renderer->render_scene().relative(camera), size_px);
    const auto draw = [&] {
      if (&viewport == &renderer->viewport()) {
        renderer->draw(camera);
      }
      else {
        viewport.restart();
        viewport.draw(engines, view);
      }
    };
    const gpu::Counters before = device_.counters();
    const std::uint64_t recordings_before = eevee::Inspection(engine, viewport).report().pass_recordings;
    const std::uint64_t lamps_before = lamps_updated(viewport, engine);
    change();
    if (&viewport == &renderer->viewport()) {
      renderer->sync();
    }
    else {
      viewport.sync(engines, renderer->render_scene().objects());
    }
    draw();
    const gpu::Counters edited = device_.counters();
    const std::uint64_t shadows_drawn = lamps_updated(viewport, engine) - lamps_before;
    draw();
    const std::uint64_t still_bytes = device_.counters().upload_bytes - edited.upload_bytes;
    return {std::move(edit),
            edited.upload_bytes - before.upload_bytes - still_bytes,
            shadows_drawn,
            eevee::Inspection(engine, viewport).report().pass_recordings - recordings_before,
            edited.textures_made - before.textures_made,
            edited.shaders_made - before.shaders_made};
  }
  template <typename Change>
  EditCost cost_of(std::string edit, Change &&change)
  {
    return cost_of(std::move(edit), renderer->viewport(), renderer->engine(), change);
  }

  scene::Scene scene;
  std::vector<scene::Handle<scene::Material>> materials;
  std::vector<scene::Handle<scene::Mesh>> meshes;
  scene::Handle<scene::Mesh> grid;
  std::vector<scene::Handle<scene::Node>> objects;
  std::vector<scene::Handle<scene::Lamp>> lamps;
  std::vector<scene::Handle<scene::Node>> lamp_nodes;
  scene::Handle<scene::Image> image;
  scene::Handle<scene::Image> mask;
  scene::PlacedCamera camera = camera_at({100, 100, 300}, {100, 100, 0});
  std::optional<eevee::SceneRenderer> renderer;

 private:
  /** Adds a square of 64 by 64 vertices, far from lamps. */
  scene::Handle<scene::Mesh> add_grid(scene::Handle<scene::Material> material)
  {
    constexpr std::uint32_t edge = 64;
    scene::Mesh mesh{.name = "grid", .material = material};
    for (std::uint32_t y = 0; y < edge; y++) {
      for (std::uint32_t x = 0; x < edge; x++) {
        mesh.positions.emplace_back(18.0F + 0.02F * float(x), 18.0F + 0.02F * float(y), 2.0F);
        if (x > 0 && y > 0) {
          const std::uint32_t i = y * edge + x;
          mesh.indices.insert(mesh.indices.end(), {i - edge - 1, i - edge, i, i - edge - 1, i, i - 1});
        }
      }
    }
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    const auto added = scene.add(std::move(mesh));
    add_object(scene, added, glm::dmat4(1.0));
    return added;
  }
  /** Gives \a material a texture of one texel. \return its image */
  scene::Handle<scene::Image> add_textured(scene::Handle<scene::Material> material, scene::AlphaMode alpha_mode)
  {
    const auto texture = add_texture(scene, 1, {255, 0, 0, 255});
    scene.edit(material, [&](scene::Material &value) {
      value.base_color_texture = texture;
      value.alpha_mode = alpha_mode;
    });
    return scene.textures()[texture].image;
  }
  /** 0 before the first sync. */
  static std::uint64_t lamps_updated(draw::Viewport &viewport, eevee::Engine &engine)
  {
    return eevee::Inspection(engine, viewport).report().shadow_counters.lamps_updated;
  }

  gpu::Device &device_;
};

}  // namespace

std::vector<EditCost> edit_costs(gpu::Device &device)
{
  EditedScene s(device);
  scene::Scene &scene = s.scene;
  std::vector<EditCost> costs;
  const auto add = [&](std::string edit, auto &&change) { costs.push_back(s.cost_of(std::move(edit), change)); };
  add("first picture", [] {});
  add("nothing", [] {});
  add("move the camera", [&] { s.camera = camera_at({101, 99, 300}, {100, 100, 0}); });

  // Lamp 0 is at (9, 9); the object in column and row 4 is at (8, 8), that in column and row 9 at (18, 18).
  add("move an object near a lamp", [&] { scene.set_transform(s.object(4, 4), box_at(8.5, 8.0)); });
  add("move an object far from lamps", [&] { scene.set_transform(s.object(9, 9), box_at(18.5, 18.5)); });
  const auto set_visible = [&](bool is_visible) {
    scene.edit(s.object(9, 9), [&](scene::Node &node) { node.is_visible = is_visible; });
  };
  add("hide an object", [&] { set_visible(false); });
  add("show an object", [&] { set_visible(true); });
  scene::Handle<scene::Node> added;
  add("add an object", [&] { added = add_object(scene, s.meshes[1], box_at(19, 21)); });
  add("remove an object", [&] { scene.remove(added); });
  add("give an object another mesh",
      [&] { scene.edit(s.object(9, 9), [&](scene::Node &node) { node.meshes = {s.meshes[2]}; }); });
  add("rename an object, a mesh and a material", [&] {
    scene.edit(s.objects[5], [](scene::Node &node) { node.name = "renamed"; });
    scene.edit(s.meshes[0], [](scene::Mesh &mesh) { mesh.name = "renamed"; });
    scene.edit(s.materials[0], [](scene::Material &material) { material.name = "renamed"; });
  });
  add("set a matrix that is set already",
      [&] { scene.set_transform(s.objects[7], scene.world_from_node(s.objects[7])); });

  add("move one of 4096 vertices of a mesh", [&] {
    constexpr std::uint32_t vertex = 2000;
    const glm::vec3 moved = scene.meshes()[s.grid].positions[vertex] + glm::vec3(0, 0, 0.01F);
    scene.set_vertices(s.grid, {.vertices = std::span(&vertex, 1), .positions = std::span(&moved, 1)});
  });

  const auto edit_material = [&](int index, auto &&change) { scene.edit(s.materials[std::size_t(index)], change); };
  add("change a material's colour", [&] {
    edit_material(1, [](scene::Material &material) { material.base_color = {0.1F, 0.9F, 0.3F}; });
  });
  add("make a material one-sided",
      [&] { edit_material(0, [](scene::Material &material) { material.is_double_sided = false; }); });
  add("change an image", [&] { scene.edit(s.image, [](scene::Image &value) { value.texels[0] = 100; }); });
  add("change a mask's cutoff",
      [&] { edit_material(3, [](scene::Material &material) { material.alpha_cutoff = 0.25F; }); });
  add("change a mask's image", [&] { scene.edit(s.mask, [](scene::Image &value) { value.texels[3] = 100; }); });

  add("move a lamp", [&] {
    scene.set_transform(s.lamp_nodes[10], glm::translate(glm::dmat4(1.0), glm::dvec3(lamp_place(10)) + 0.25));
  });
  add("dim a lamp", [&] { scene.edit(s.lamps[10], [](scene::Lamp &lamp) { lamp.intensity = 0.5F; }); });
  add("rename a lamp", [&] { scene.edit(s.lamps[10], [](scene::Lamp &lamp) { lamp.name = "renamed"; }); });
  add("remove a lamp", [&] { scene.remove(s.lamps[10]); });
  add("add a lamp", [&] { s.add_short_lamp({29, 31, 2}); });

  draw::Viewport second(device, size_px);
  costs.push_back(s.cost_of("a second viewport", second, s.renderer->engine(), [] {}));
  eevee::Engine engine(s.renderer->render_scene(), s.renderer->settings());
  draw::Viewport third(device, size_px);
  costs.push_back(s.cost_of("a second engine, with a viewport", third, engine, [] {}));
  add("resize the viewport", [&] { s.renderer->resize({32, 48}); });
  return costs;
}

}  // namespace gnomon::measure
