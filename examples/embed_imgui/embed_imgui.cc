// SPDX-License-Identifier: MIT
// A viewport as an image of Dear ImGui, with the lamps' intensities beside it, and a brush: drag to push surfaces out.
//   embed_imgui SCENE [PICTURE.ppm]: with a picture's name, the finished viewport is saved, and the program ends.
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cstdio>

using namespace gnomon;

/** A texture of the host's, and a framebuffer that draws into it. */
struct Canvas {
  Canvas()
  {
    glCreateFramebuffers(1, &framebuffer);
  }
  Canvas(const Canvas &) = delete;
  Canvas &operator=(const Canvas &) = delete;
  ~Canvas()
  {
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteTextures(1, &texture);
  }
  void resize(glm::ivec2 size)
  {
    if (size != size_px) {
      glDeleteTextures(1, &texture);
      glCreateTextures(GL_TEXTURE_2D, 1, &texture);
      glTextureStorage2D(texture, 1, GL_RGBA8, size.x, size.y);
      glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
      size_px = size;
    }
  }
  glm::ivec2 size_px{0};
  GLuint texture = 0;
  GLuint framebuffer = 0;
};

static void show_lamps(scene::Scene &scene)
{
  ImGui::SetNextWindowPos({440, 20}, ImGuiCond_FirstUseEver);
  ImGui::Begin("Lamps");
  for (const scene::PlacedLamp &placed : scene.placed_lamps()) {
    float intensity = placed.intensity;
    if (ImGui::DragFloat(placed.name.c_str(), &intensity, 0.05F, 0.0F, 1e6F)) {
      scene.edit(scene.nodes()[placed.node].lamp, [&](scene::Lamp &lamp) { lamp.intensity = intensity; });
    }
  }
  ImGui::End();
}

/** Move the vertices around the hit outwards. In a large mesh, only these are uploaded. */
static void sculpt(scene::Scene &scene, const overlay::Hit &hit)
{
  const scene::Mesh &mesh = scene.meshes()[hit.mesh];
  const glm::vec3 middle(glm::inverse(scene.world_from_node(hit.node)) * glm::dvec4(hit.position_ws, 1.0));
  const float radius = 0.2F * mesh.bounds.radius();
  std::vector<std::uint32_t> vertices;
  std::vector<glm::vec3> positions;
  for (std::uint32_t i = 0; i < mesh.positions.size(); i++) {
    const float distance = glm::distance(mesh.positions[i], middle);
    if (distance < radius) {
      vertices.push_back(i);
      positions.push_back(mesh.positions[i] + 0.1F * (radius - distance) * mesh.normals[i]);
    }
  }
  scene.set_vertices(hit.mesh, {.vertices = vertices, .positions = positions});
}

static void run(GLFWwindow *window, const char *scene_path, const char *picture_path)
{
  const auto device = gpu::create_gl_device({.context = gpu::ContextKind::Host});
  scene::Scene scene = gltf::import_gltf(scene_path);
  eevee::SceneRenderer renderer(*device, scene, {320, 180}, {.sample_count = 8});
  overlay::Overlay overlay(renderer.render_scene());
  Canvas canvas;
  while (!glfwWindowShouldClose(window)) {
    glfwPollEvents();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    show_lamps(scene);

    ImGui::SetNextWindowPos({20, 20}, ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize({400, 260}, ImGuiCond_FirstUseEver);
    ImGui::Begin("Viewport");
    const ImVec2 space = ImGui::GetContentRegionAvail();
    canvas.resize(glm::max(glm::ivec2(space.x, space.y), 1));
    renderer.resize(canvas.size_px);
    renderer.sync();
    const bool is_complete = renderer.draw_sample(
        scene.placed_cameras().front(), {.framebuffer = gpu::HostFramebuffer{canvas.framebuffer, canvas.size_px}});
    // OpenGL's first row is the lowest.
    ImGui::Image(reinterpret_cast<ImTextureID>(std::uintptr_t(canvas.texture)), space, {0, 1}, {1, 0});
    if (ImGui::IsItemHovered() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
      const ImVec2 corner = ImGui::GetItemRectMin();
      const glm::ivec2 pixel_px(ImGui::GetMousePos().x - corner.x,
                                canvas.size_px.y - 1 - (ImGui::GetMousePos().y - corner.y));
      if (const auto hit = overlay.pick(renderer.view_of(scene.placed_cameras().front()), canvas.size_px, pixel_px)) {
        sculpt(scene, *hit);
      }
    }
    ImGui::End();

    ImGui::Render();
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window);
    if (is_complete && picture_path) {
      std::vector<std::byte> rgba(4 * std::size_t(canvas.size_px.x) * std::size_t(canvas.size_px.y));
      glGetTextureImage(canvas.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(rgba.size()), rgba.data());
      write_ppm(picture_path, canvas.size_px.x, canvas.size_px.y, rgba);
      return;
    }
  }
}

int main(int argc, char **argv)
{
  if (argc < 2 || argc > 3 || !glfwInit()) {
    std::fprintf(stderr, "usage: embed_imgui SCENE [PICTURE.ppm], with a display\n");
    return 2;
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow *window = glfwCreateWindow(800, 450, "embed_imgui", nullptr, nullptr);
  if (!window) {
    std::fprintf(stderr, "embed_imgui: no window with an OpenGL 4.5 core context\n");
    return 1;
  }
  glfwMakeContextCurrent(window);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init();
  int status = 0;
  try {
    run(window, argv[1], argc == 3 ? argv[2] : nullptr);
  }
  catch (const std::exception &error) {
    std::fprintf(stderr, "embed_imgui: %s\n", error.what());
    status = 1;
  }
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwTerminate();
  return status;
}
