// SPDX-License-Identifier: MIT
// A lit scene in a window of GLFW. Drag to turn the camera; hold the space bar to move the first lamp.
//   embed_glfw SCENE [PICTURE.ppm]: with a picture's name, the finished picture is saved, and the program ends.
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#define GLFW_INCLUDE_GLEXT
#include <GLFW/glfw3.h>
#include <glm/gtc/matrix_transform.hpp>

#include <cstdio>
#include <memory>

using namespace gnomon;

/** The cursor's way since the last call while the left button is held, as angles in radians. */
static glm::dvec2 dragged(GLFWwindow *window)
{
  static glm::dvec2 last(0.0);
  glm::dvec2 now(0.0);
  glfwGetCursorPos(window, &now.x, &now.y);
  const glm::dvec2 way = now - last;
  last = now;
  return glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS ? -0.01 * way : glm::dvec2(0.0);
}

static void run(GLFWwindow *window, const char *scene_path, const char *picture_path)
{
  // All of these are used and destroyed while the window's context is current.
  const auto device = gpu::create_gl_device({.context = gpu::ContextKind::Host});
  scene::Scene scene = gltf::import_gltf(scene_path);
  eevee::SceneRenderer renderer(*device, scene, {480, 270}, {.sample_count = 8});
  scene::PlacedCamera camera = scene.placed_cameras().front();

  bool is_complete = false;
  while (!glfwWindowShouldClose(window)) {
    glm::ivec2 size_px(0);
    glfwGetFramebufferSize(window, &size_px.x, &size_px.y);
    if (size_px.x == 0 || size_px.y == 0) {  // Minimised.
      glfwWaitEvents();
      continue;
    }
    renderer.resize(size_px);

    // Turn the camera around the middle of the scene.
    const glm::dvec2 angles = dragged(window);
    const glm::dvec3 middle = scene.bounds().center();
    const glm::dvec3 right = camera.world_from_camera[0];
    glm::dmat4 turn = glm::rotate(glm::translate(glm::dmat4(1), middle), angles.x, glm::dvec3(0, 1, 0));
    turn = glm::translate(glm::rotate(turn, angles.y, right), -middle);
    camera.world_from_camera = turn * camera.world_from_camera;

    // Edit the scene by handle; sync takes note of it.
    if (glfwGetKey(window, GLFW_KEY_SPACE) == GLFW_PRESS && !scene.placed_lamps().empty()) {
      const scene::Handle<scene::Node> node = scene.placed_lamps().front().node;
      const glm::dmat4 moved = glm::translate(glm::dmat4(1), {0.02, 0, 0});
      scene.set_transform(node, moved * scene.nodes()[node].parent_from_node);
    }
    renderer.sync();

    // One more sample of the picture, into the window's framebuffer.
    is_complete = renderer.draw_sample(camera, {.framebuffer = gpu::HostFramebuffer{.name = 0, .size_px = size_px}});
    if (is_complete && picture_path) {
      std::vector<std::byte> rgba(4 * std::size_t(size_px.x) * std::size_t(size_px.y));
      glReadPixels(0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
      write_ppm(picture_path, size_px.x, size_px.y, rgba);
      return;
    }
    glfwSwapBuffers(window);
    is_complete ? glfwWaitEvents() : glfwPollEvents();
  }
}

int main(int argc, char **argv)
try {
  if (argc < 2 || argc > 3 || !glfwInit()) {
    std::fprintf(stderr, "usage: embed_glfw SCENE [PICTURE.ppm], with a display\n");
    return 2;
  }
  const std::unique_ptr<void, void (*)(void *)> at_exit(&argc, [](void *) { glfwTerminate(); });
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow *window = glfwCreateWindow(480, 270, "embed_glfw", nullptr, nullptr);
  if (!window) {
    throw std::runtime_error("no window with an OpenGL 4.5 core context");
  }
  glfwMakeContextCurrent(window);
  run(window, argv[1], argc == 3 ? argv[2] : nullptr);
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "embed_glfw: %s\n", error.what());
  return 1;
}
