// SPDX-License-Identifier: MIT
#include "view_viewport.hh"

#include "view_icons.hh"

#include "draw_target.hh"
#include "gpu_read.hh"
#include "render_camera.hh"
#include "unlit_engine.hh"

#include <algorithm>
#include <utility>

namespace gnomon::view {

namespace {

constexpr glm::vec4 outline_color(1.0F, 0.55F, 0.1F, 1.0F);

}  // namespace

void WindowViewport::close()
{
  budgeted_.reset();
  has_budget_ = false;
  viewport_.reset();
  overlay_.reset();
  canvas_.free();
  synced_ = {};
  density_key_ = {};
  error_.restart();
  dark_picture_.reset();
  is_complete_ = false;
  is_transforming_ = false;
  area_.reset();
  fly.reset();
}

void WindowViewport::look_at(const Document &document)
{
  const std::vector<scene::PlacedCamera> cameras = document.scene().placed_cameras();
  if (cameras.empty()) {
    looked_through_.reset();
    navigation.frame(document.scene().bounds());
    return;
  }
  look_through(document, cameras.front());
}

void WindowViewport::look_through(const Document &document, const scene::PlacedCamera &camera)
{
  navigation.look_through(camera, document.scene().bounds());
  looked_through_ = {camera.node, navigation};
}

std::optional<scene::PlacedCamera> WindowViewport::looked_through(const Document &document) const
{
  if (!looked_through_ || !(looked_through_->navigation == navigation)) {
    return std::nullopt;
  }
  const scene::Scene &scene = document.scene();
  const scene::Handle<scene::Node> handle = looked_through_->node;
  const scene::Node *node = scene.nodes().find(handle);
  const scene::Camera *camera = node ? scene.cameras().find(node->camera) : nullptr;
  if (!camera) {
    return std::nullopt;
  }
  return scene::PlacedCamera{*camera, handle, scene::frame_of(scene.world_from_node(handle))};
}

void WindowViewport::follow(const Document &document)
{
  if (const std::optional<scene::PlacedCamera> camera = looked_through(document)) {
    look_through(document, *camera);
  }
}

scene::PlacedCamera WindowViewport::camera(const Document &document) const
{
  const std::optional<scene::PlacedCamera> camera = looked_through(document);
  return camera ? *camera : navigation.camera(double(document.scene().bounds().radius()));
}

WindowViewport::OverlayKey WindowViewport::overlay_key(Document &document) const
{
  if (!has_overlays) {
    OverlayKey hidden;
    hidden.selected = document.settings().has_texel_density ? document.selected : hidden.selected;
    return hidden;
  }
  OverlayKey key{true,      document.selected, document.selection(), hidden_,
                 isolated_, document.gizmo,    document.orientation, pointed_,
                 {}};
  if (document.operation()) {
    key.operation = document.operation()->transform();
  }
  return key;
}

draw::View WindowViewport::drawn_view(Document &document) const
{
  render_scene::RenderScene &render_scene = document.render_scene();
  draw::View view = render_scene::view_of(camera(document), size_px_, render_scene.origin_ws());
  if (is_hiding(document.scene())) {
    // Without a live node nothing is isolated; render_scene would leave out all objects.
    std::span<const scene::Handle<scene::Node>> isolated;
    if (is_isolated(document.scene())) {
      isolated = isolated_;
    }
    view = view.with_hidden(render_scene.hidden_objects(hidden_, isolated));
  }
  if (is_clipped()) {
    view = view.with_clip_planes(render_scene.relative(clip_planes_ws_));
  }
  return view;
}

void WindowViewport::prepare(render_scene::RenderScene &render_scene)
{
  canvas_.resize(render_scene.device(), size_px_);
  canvas_.clear(backdrop);
  if (!viewport_) {
    viewport_ = std::make_unique<draw::Viewport>(render_scene.device(), size_px_);
    overlay_.emplace(render_scene);
  }
  if (viewport_->size_px() != size_px_) {
    viewport_->resize(size_px_);
  }
}

void WindowViewport::draw_picture(Document &document, draw::Engine &used, double budget_seconds,
                                  const draw::Target &target)
{
  auto *eevee = dynamic_cast<eevee::Engine *>(&used);
  has_budget_ = eevee && budget_seconds > 0.0;
  if (!has_budget_) {
    draw::Engine *one = &used;
    viewport_->draw(std::span(&one, 1), drawn_view_, target);
    return;
  }
  if (!budgeted_) {
    budgeted_.emplace(document.render_scene(), *eevee, *viewport_);
  }
  budgeted_->begin(
      std::clamp(budget_seconds, eevee::BudgetController::budget_min, eevee::BudgetController::budget_max));
  budgeted_->draw(drawn_view_, target);
}

bool WindowViewport::draw(Document &document, double budget_seconds)
{
  render_scene::RenderScene &render_scene = document.render_scene();
  const Key key{document.scene().revision(),
                document.settings_revision(),
                engine,
                size_px_,
                render_scene.origin_ws(),
                has_wireframe,
                reach};
  const bool is_same = viewport_ && key == synced_;
  const bool is_synced = is_same && !has_failed_;
  follow(document);
  const draw::View view = drawn_view(document);
  const OverlayKey overlays = overlay_key(document);
  if (is_same && is_complete_ && view == drawn_view_ && overlaid_ == overlays) {
    // Not before, as each picture of a moving view would cost the time of the look.
    if (auto *eevee = has_failed_ ? nullptr : dynamic_cast<eevee::Engine *>(&document.engine(engine))) {
      look_around(*eevee);
    }
    return true;
  }
  // Store the key before drawing: after a failure, drawing is tried again only when the key changes.
  synced_ = key;
  drawn_view_ = view;
  map_ = PictureMap(view, render_scene.origin_ws(), size_px_);
  overlaid_ = overlays;
  return redraw(document, budget_seconds, is_synced);
}

bool WindowViewport::redraw(Document &document, double budget_seconds, bool is_synced)
{
  is_complete_ = true;
  has_failed_ = true;
  render_scene::RenderScene &render_scene = document.render_scene();
  prepare(render_scene);
  draw::Engine *one = &document.engine(engine);
  if (auto *unlit = dynamic_cast<unlit::Engine *>(one)) {
    unlit->set_display(*viewport_, {has_wireframe, reach == overlay::Reach::Through});
  }
  if (!is_synced) {
    viewport_->sync(std::span(&one, 1), render_scene.objects());
  }
  draw::Target target = canvas_.target();
  target.composition = draw::Composition::Over;
  set_display(target, document.settings().display);
  const auto now = std::chrono::steady_clock::now();
  draw_picture(document, *one, budget_seconds, target);
  if (std::exchange(picture_, viewport_->restart_count()) != viewport_->restart_count()) {
    started_ = now;
    error_.restart();
  }
  auto *eevee = dynamic_cast<eevee::Engine *>(one);
  // While a preview is shown, the viewport may still have the picture of another view.
  const bool is_preview = has_budget_ && budgeted_->report().kind == eevee::BudgetReport::Kind::Preview;
  if (eevee) {
    limit_time(document, *eevee);
    if (!is_preview) {
      limit_error(document, *eevee);
    }
  }
  // After the limits, so that a picture which they end has its own density.
  if (eevee && !is_preview && document.settings().has_texel_density) {
    draw_density(document, *eevee, target);
  }
  draw_overlays(document, target);
  has_failed_ = false;
  is_complete_ = !eevee || (!is_preview && eevee->is_complete(*viewport_));
  // The next draw looks around, if the view rests.
  return is_complete_ && (!eevee || dark_picture_ == viewport_->restart_count());
}

void WindowViewport::look_around(draw::Engine &engine)
{
  if (std::exchange(dark_picture_, viewport_->restart_count()) == viewport_->restart_count()) {
    return;
  }
  dark_inside_.reset();
  std::optional<scene::Handle<scene::Node>> inside;
  for (const glm::dvec2 &place :
       {glm::dvec2(0.5, 0.5), glm::dvec2(0.1, 0.1), glm::dvec2(0.9, 0.1), glm::dvec2(0.1, 0.9), glm::dvec2(0.9, 0.9)}) {
    const glm::ivec2 pixel(place * glm::dvec2(size_px_));
    const std::optional<overlay::Hit> hit = overlay_->pick(drawn_view_, size_px_, {pixel.x, size_px_.y - 1 - pixel.y});
    const glm::dvec3 away_ws = map_.ray_through(glm::dvec2(pixel) + 0.5).direction_ws;
    const bool is_back = hit && hit->triangle && glm::dot(glm::dvec3(hit->triangle->normal_ws), away_ws) > 0.0;
    if (!is_back || (inside && *inside != hit->node)) {
      return;
    }
    inside = hit->node;
  }
  draw::Engine *one = &engine;
  const std::vector<float> radiance = read_written(
      viewport_->device(), [&](const draw::Target &target) { viewport_->write(std::span(&one, 1), target); });
  // The least step of a display of eight bits. Alpha counts as no light.
  constexpr float black = 1.0F / (255.0F * 12.92F);
  bool is_black = true;
  for (std::size_t i = 0; i < radiance.size(); i++) {
    is_black &= i % 4 == 3 || radiance[i] < black;
  }
  dark_inside_ = is_black ? inside : std::nullopt;
}

void WindowViewport::limit_time(const Document &document, eevee::Engine &eevee)
{
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - started_;
  const float seconds_max = document.settings().seconds_max;
  if (seconds_max > 0.0F && passed.count() > double(seconds_max)) {
    eevee.finish(*viewport_);
  }
}

void WindowViewport::limit_error(const Document &document, eevee::Engine &eevee)
{
  const float error_max = document.settings().error_max;
  const int samples = viewport_->samples_drawn();
  if (!(error_max > 0.0F)) {
    return;
  }
  if (samples >= document.settings().eevee.sample_count) {
    eevee.finish(*viewport_);
  }
  if (!error_.is_due(samples)) {
    return;
  }
  draw::Engine *one = &eevee;
  error_.add(samples, read_written(viewport_->device(),
                                   [&](const draw::Target &target) { viewport_->write(std::span(&one, 1), target); }));
  if (error_.value() && *error_.value() <= double(error_max)) {
    eevee.finish(*viewport_);
  }
}

void WindowViewport::draw_overlays(Document &document, const draw::Target &target)
{
  if (!has_overlays) {
    return;
  }
  overlay_->draw_outline(drawn_view_, size_px_, document.selected_nodes(), outline_color, target);
  std::vector<overlay::Line> lines = icon_lines(document.scene(), map_, document.selection(),
                                                [&](auto node) { return !is_hidden(document.scene(), node); });
  const std::optional<Gizmo> gizmo = gizmo_of(document);
  if (document.operation() || gizmo) {
    const auto more = document.operation() ? axis_lines(*document.operation(), map_) : gizmo->lines(map_, pointed_);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  overlay_->draw_lines(drawn_view_, size_px_, lines, target);
}

std::vector<float> WindowViewport::read_written(gpu::Device &device,
                                                const std::function<void(const draw::Target &)> &write) const
{
  const draw::TargetTexture picture(device, "read_picture", gpu::Format::RGBA32F, size_px_);
  draw::Target target = picture.target();
  target.encoding = draw::Encoding::SceneLinear;
  write(target);
  return gpu::read_as<float>(device, picture.texture());
}

std::vector<float> WindowViewport::radiance(Document &document)
{
  draw::Engine *one = &document.engine(engine);
  return read_written(document.render_scene().device(),
                      [&](const draw::Target &target) { viewport_->draw(std::span(&one, 1), drawn_view_, target); });
}

}  // namespace gnomon::view
