// SPDX-License-Identifier: MIT
// A viewport as a widget of Qt 6. Drag to turn the camera; the slider sets the intensity of the first lamp.
//   embed_qt SCENE [PICTURE.ppm]: with a picture's name, the finished viewport is saved, and the program ends.
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include <QApplication>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <QOpenGLWidget>
#include <QSlider>
#include <QVBoxLayout>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cstdio>

using namespace gnomon;

class SceneWidget final : public QOpenGLWidget {
 public:
  SceneWidget(const char *scene_path, const char *picture_path)
      : scene_(gltf::import_gltf(scene_path)), camera_(scene_.placed_cameras().front()), picture_path_(picture_path)
  {
    setMinimumSize(320, 180);
  }
  ~SceneWidget() override
  {
    // The context must be current while resources of the device are destroyed.
    makeCurrent();
    renderer_.reset();
    device_.reset();
    doneCurrent();
  }

  void set_intensity(float intensity)
  {
    if (!scene_.placed_lamps().empty()) {
      const scene::Handle<scene::Node> node = scene_.placed_lamps().front().node;
      scene_.edit(scene_.nodes()[node].lamp, [&](scene::Lamp &lamp) { lamp.intensity = intensity; });
      update();
    }
  }

 protected:
  void paintGL() override
  try {
    // Qt's framebuffer, which may be another one after a change of the size.
    const auto pixels = [&](int length) { return std::max(int(length * devicePixelRatio()), 1); };
    const gpu::HostFramebuffer framebuffer{defaultFramebufferObject(), {pixels(width()), pixels(height())}};
    if (!renderer_) {
      device_ = gpu::create_gl_device({.context = gpu::ContextKind::Host});
      renderer_ = std::make_unique<eevee::SceneRenderer>(*device_, scene_, framebuffer.size_px,
                                                         eevee::Settings{.sample_count = 8});
    }
    renderer_->resize(framebuffer.size_px);
    renderer_->sync();
    if (!renderer_->draw_sample(camera_, {.framebuffer = framebuffer})) {
      update();
    }
    else if (picture_path_) {
      const glm::ivec2 size_px = framebuffer.size_px;
      std::vector<std::byte> rgba(4 * std::size_t(size_px.x) * std::size_t(size_px.y));
      context()->functions()->glReadPixels(0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
      write_ppm(picture_path_, size_px.x, size_px.y, rgba);
      QApplication::exit(0);
    }
  }
  catch (const std::exception &error) {
    // Exceptions must not pass through Qt.
    std::fprintf(stderr, "embed_qt: %s\n", error.what());
    QApplication::exit(1);
  }

  void mouseMoveEvent(QMouseEvent *event) override
  {
    const QPointF way = event->position() - last_;
    last_ = event->position();
    if (event->buttons() & Qt::LeftButton) {
      const glm::dvec3 middle = scene_.bounds().center();
      glm::dmat4 turn = glm::rotate(glm::translate(glm::dmat4(1), middle), -0.01 * way.x(), glm::dvec3(0, 1, 0));
      turn = glm::rotate(turn, -0.01 * way.y(), glm::dvec3(camera_.world_from_camera[0]));
      camera_.world_from_camera = glm::translate(turn, -middle) * camera_.world_from_camera;
      update();
    }
  }
  void mousePressEvent(QMouseEvent *event) override
  {
    last_ = event->position();
  }

 private:
  scene::Scene scene_;
  scene::PlacedCamera camera_;
  const char *picture_path_;
  QPointF last_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<eevee::SceneRenderer> renderer_;
};

int main(int argc, char **argv)
try {
  QSurfaceFormat format;
  format.setVersion(4, 5);
  format.setProfile(QSurfaceFormat::CoreProfile);
  QSurfaceFormat::setDefaultFormat(format);
  const QApplication application(argc, argv);
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: embed_qt SCENE [PICTURE.ppm]\n");
    return 2;
  }
  QWidget window;
  auto *viewport = new SceneWidget(argv[1], argc == 3 ? argv[2] : nullptr);
  auto *slider = new QSlider(Qt::Horizontal);
  slider->setRange(0, 1000);
  QObject::connect(slider, &QSlider::valueChanged, [viewport](int value) { viewport->set_intensity(float(value)); });
  auto *layout = new QVBoxLayout(&window);
  layout->addWidget(viewport, 1);
  layout->addWidget(slider);
  window.resize(480, 320);
  window.show();
  return QApplication::exec();
}
catch (const std::exception &error) {
  std::fprintf(stderr, "embed_qt: %s\n", error.what());
  return 1;
}
