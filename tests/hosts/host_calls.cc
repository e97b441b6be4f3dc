// SPDX-License-Identifier: MIT
#include "hosts/host_calls.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>

namespace gnomon::test {

namespace {

constexpr glm::ivec2 size_px(48, 36);

/** Pictures by eevee, and the edits of a scene and of settings between them. */
void draw_pictures(scene::Scene &scene, eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera,
                   const draw::Target &target, const CheckCall &check)
{
  check("sync", [&] { renderer.sync(); });
  check("first draw_sample", [&] { renderer.draw_sample(camera, target); });
  check("second draw_sample", [&] { renderer.draw_sample(camera, target); });
  const scene::Handle<scene::Node> node = scene.placed_lamps().front().node;
  const auto move_lamp = [&] {
    const glm::dmat4 moved = glm::translate(glm::dmat4(1), {0.01, 0, 0});
    scene.set_transform(node, moved * scene.nodes()[node].parent_from_node);
  };
  check("draw_within after an edit", [&] {
    move_lamp();
    renderer.draw_within(eevee::BudgetController::budget_min, camera, target);
  });
  if (renderer.budget_report().kind != eevee::BudgetReport::Kind::Preview) {
    throw std::runtime_error("draw_within draws no preview");
  }
  check("parts of draw_within", [&] {
    while (!renderer.draw_within(0.002, camera, target)) {
    }
  });
  check("read_picture", [&] { static_cast<void>(renderer.read_picture()); });
  check("report", [&] { static_cast<void>(renderer.inspect().report()); });
  check("picture of a shadow", [&] { static_cast<void>(renderer.inspect().shadow_picture(0)); });

  check("draw after an edit", [&] {
    scene.edit(scene.nodes()[node].lamp, [](scene::Lamp &lamp) { lamp.radius = 0.1F; });
    renderer.sync();
    renderer.draw_sample(camera, target);
  });
  check("draw with glass and a blended surface", [&] {
    const std::vector<scene::Object> objects = scene.objects();
    const auto glass = scene.add(scene::Material{.transmission = 0.5F});
    const auto blended = scene.add(scene::Material{.alpha = 0.5F, .alpha_mode = scene::AlphaMode::Blend});
    scene.edit(objects.at(0).mesh, [&](scene::Mesh &mesh) { mesh.material = glass; });
    scene.edit(objects.at(1).mesh, [&](scene::Mesh &mesh) { mesh.material = blended; });
    renderer.sync();
    renderer.draw_sample(camera, target);
  });
  for (const scene::ShadowKind kind : {scene::ShadowKind::Pcf, scene::ShadowKind::Esm, scene::ShadowKind::Evsm}) {
    check("set_settings, draw", [&] {
      eevee::Settings settings = renderer.settings();
      settings.shadow.kind = kind;
      settings.shadow.is_fitted_to_depth = true;
      settings.is_timed = settings.has_probe = settings.has_surfaces = true;
      renderer.set_settings(settings);
      renderer.sync();
      renderer.draw(camera, {}, target);
    });
  }
  check("probe and surfaces", [&] {
    static_cast<void>(renderer.inspect().probe(renderer.view_of(camera), 0));
    static_cast<void>(renderer.inspect().surfaces(renderer.view_of(camera)));
    static_cast<void>(renderer.inspect().take_step_times());
  });
  check("resize, draw", [&] {
    renderer.resize(size_px / 2);
    renderer.sync();
    renderer.draw(camera, {.seconds_max = 10.0}, target);
  });
  gpu::Packet packet;
  // Recorded by a thread without a context.
  std::exception_ptr failure;
  std::thread([&] {
    try {
      move_lamp();
      renderer.prepare(packet, camera, target);
    }
    catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) {
    std::rethrow_exception(failure);
  }
  check("submit", [&] { renderer.viewport().device().submit(packet); });
}

void draw_overlays(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, const draw::Target &target,
                   const CheckCall &check)
{
  std::optional<overlay::Overlay> overlay;
  check("Overlay", [&] { overlay.emplace(renderer.render_scene()); });
  const draw::View view = renderer.view_of(camera);
  const glm::ivec2 drawn_px = renderer.viewport().size_px();
  std::optional<overlay::Hit> hit;
  check("pick", [&] { hit = overlay->pick(view, drawn_px, drawn_px / 2); });
  if (!hit) {
    throw std::runtime_error("the scene has no surface in the middle of the picture");
  }
  check("draw_outline", [&] {
    overlay->draw_outline(view, drawn_px, {&hit->node, 1}, {1.0F, 0.5F, 0.0F, 1.0F}, target);
  });
  const std::array<overlay::Line, 2> lines = {
      overlay::Line{.to_ws = {1, 0, 0}},
      overlay::Line{.to_ws = {0, 1, 0}, .is_on_top = true},
  };
  check("draw_lines", [&] { overlay->draw_lines(view, drawn_px, lines, target); });
  check("~Overlay", [&] { overlay.reset(); });
}

/** In a viewport of its own. */
void draw_unlit(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, const draw::Target &target,
                const CheckCall &check)
{
  std::unique_ptr<draw::Engine> engine;
  std::optional<draw::Viewport> viewport;
  check("unlit::Engine", [&] {
    draw::EngineRegistry engines;
    engines.add(unlit::engine_type(renderer.render_scene()));
    engine = engines.create("unlit");
    viewport.emplace(renderer.viewport().device(), size_px);
  });
  const std::array<draw::Engine *, 1> engines = {engine.get()};
  check("sync of unlit", [&] { viewport->sync(engines, renderer.render_scene().objects()); });
  check("draw of unlit", [&] { viewport->draw(engines, renderer.view_of(camera), target); });
  check("write of unlit", [&] { viewport->write(engines, target); });
  check("end of unlit", [&] {
    viewport.reset();
    engine.reset();
  });
}

}  // namespace

void make_host_calls(const scene::Scene &scene, const gpu::HostFramebuffer &framebuffer, const CheckCall &check)
{
  scene::Scene edited = scene;
  const scene::PlacedCamera camera = edited.placed_cameras().front();
  draw::Target target;
  target.framebuffer = framebuffer;
  std::unique_ptr<gpu::Device> device;
  check("create_gl_device", [&] { device = gpu::create_gl_device({.context = gpu::ContextKind::Host}); });
  std::optional<eevee::SceneRenderer> renderer;
  check("SceneRenderer", [&] {
    renderer.emplace(
        *device, edited, size_px,
        eevee::Settings{.shadow = {.cube_size_px = 64, .map_size_px = 64, .esm = {.size_px = 64}}, .sample_count = 3});
  });
  draw_pictures(edited, *renderer, camera, target, check);
  draw_overlays(*renderer, camera, target, check);
  draw_unlit(*renderer, camera, target, check);
  check("~SceneRenderer", [&] { renderer.reset(); });
  check("~Device", [&] { device.reset(); });
}

}  // namespace gnomon::test
