// SPDX-License-Identifier: MIT
// Several devices in one process, each in a context of its own.
#include "gpu/gpu_host_framebuffer.hh"

#include <gnomon/gnomon.hh>

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cstdlib>
#include <optional>

namespace gnomon::test {
namespace {

constexpr glm::ivec2 size_px(64, 36);
constexpr int sample_count = 3;

/** A host's context with a device, and a picture of a scene in a framebuffer of the context. */
class Window {
 public:
  explicit Window(const char *file) : scene_(gltf::import_gltf(std::string(GNOMON_SOURCE "/examples/scenes/") + file))
  {
    if (context_.is_current()) {
      picture_.emplace(size_px, GL_RGBA8, 0);
      device_ = gpu::create_gl_device({.context = gpu::ContextKind::Host});
      renderer_.emplace(*device_, scene_, size_px,
                        eevee::Settings{.shadow = {.cube_size_px = 128, .map_size_px = 128, .esm = {.size_px = 64}},
                                        .sample_count = sample_count});
    }
  }
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;
  ~Window()
  {
    context_.make_current();
  }
  [[nodiscard]] bool has_context() const
  {
    return device_ != nullptr;
  }
  /** \return whether the picture is complete */
  bool draw()
  {
    context_.make_current();
    renderer_->sync();
    return renderer_->draw_sample(scene_.placed_cameras().front(), {.framebuffer = picture_->framebuffer()});
  }
  void move_lamp()
  {
    const scene::Handle<scene::Node> node = scene_.placed_lamps().front().node;
    scene_.set_transform(node, glm::translate(glm::dmat4(1), {0.3, 0, 0}) * scene_.nodes()[node].parent_from_node);
  }
  /** Draw with the engine unlit, and lines over its picture. */
  void draw_unlit()
  {
    context_.make_current();
    renderer_->sync();
    unlit::Engine engine(renderer_->render_scene());
    draw::Viewport viewport(*device_, size_px);
    const std::array<draw::Engine *, 1> engines = {&engine};
    viewport.sync(engines, renderer_->render_scene().objects());
    const draw::View view = renderer_->view_of(scene_.placed_cameras().front());
    viewport.draw(engines, view, {.framebuffer = picture_->framebuffer()});
    overlay::Overlay overlay(renderer_->render_scene());
    const overlay::Line line{.to_ws = {0, 1, 0}, .is_on_top = true};
    overlay.draw_lines(view, size_px, {&line, 1}, {.framebuffer = picture_->framebuffer()});
  }
  [[nodiscard]] Pixels pixels() const
  {
    context_.make_current();
    return picture_->pixels();
  }

 private:
  EglHostContext context_;
  scene::Scene scene_;
  std::optional<HostPicture> picture_;
  std::unique_ptr<gpu::Device> device_;
  std::optional<eevee::SceneRenderer> renderer_;
};

/** Pictures of a window that is alone: complete, by unlit, and complete after an edit. */
std::array<Pixels, 3> alone(const char *file)
{
  Window window(file);
  std::array<Pixels, 3> pictures;
  while (!window.draw()) {
  }
  pictures[0] = window.pixels();
  window.draw_unlit();
  pictures[1] = window.pixels();
  window.move_lamp();
  while (!window.draw()) {
  }
  pictures[2] = window.pixels();
  return pictures;
}

TEST(HostsDevices, TwoThatTakeTurnsDrawWhatEachDrawsAlone)
{
  {
    const EglHostContext context;
    const char *ci = std::getenv("CI");
    if (!context.is_current() && !(ci && *ci)) {
      GTEST_SKIP() << "EGL gives no surfaceless context";
    }
    ASSERT_TRUE(context.is_current());
  }
  const std::array<Pixels, 3> plaza = alone("plaza.glb");
  const std::array<Pixels, 3> spots = alone("spots.glb");
  ASSERT_NE(plaza[0], plaza[2]);
  ASSERT_NE(spots[0], spots[2]);
  ASSERT_NE(spots[0], plaza[0]);

  Window first("plaza.glb");
  std::optional<Window> second("spots.glb");
  ASSERT_TRUE(first.has_context() && second->has_context());
  // One sample of each in turn.
  for (int i = 1; i <= sample_count; i++) {
    EXPECT_EQ(first.draw(), i == sample_count);
    EXPECT_EQ(second->draw(), i == sample_count);
  }
  EXPECT_EQ(first.pixels(), plaza[0]);
  EXPECT_EQ(second->pixels(), spots[0]);
  first.draw_unlit();
  second->draw_unlit();
  EXPECT_EQ(first.pixels(), plaza[1]);
  EXPECT_EQ(second->pixels(), spots[1]);

  // The first goes on while the second is destroyed in the middle of a picture, and another one begins.
  first.move_lamp();
  second->move_lamp();
  EXPECT_FALSE(first.draw());
  EXPECT_FALSE(second->draw());
  second.reset();
  EXPECT_FALSE(first.draw());
  second.emplace("spots.glb");
  EXPECT_FALSE(second->draw());
  EXPECT_TRUE(first.draw());
  EXPECT_EQ(first.pixels(), plaza[2]);
  while (!second->draw()) {
  }
  EXPECT_EQ(second->pixels(), spots[0]);
}

}  // namespace
}  // namespace gnomon::test
