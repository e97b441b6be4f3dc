// SPDX-License-Identifier: MIT
// A picture of a glTF scene from C++, without a window and without the program gnomon.
//   offline_library SCENE PICTURE.ppm
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include <cstdio>

int main(int argc, char **argv)
try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: offline_library SCENE PICTURE.ppm\n");
    return 2;
  }
  using namespace gnomon;
  constexpr glm::ivec2 size_px(320, 180);

  const scene::Scene scene = gltf::import_gltf(argv[1]);
  for (const std::string &warning : scene.warnings) {
    std::fprintf(stderr, "%s\n", warning.c_str());
  }

  // The device makes its own context: no display and no GPU are needed.
  const auto device = gpu::create_gl_device();
  const draw::TargetTexture picture(*device, "picture", gpu::Format::RGBA8, size_px);
  eevee::SceneRenderer renderer(*device, scene, size_px, {.sample_count = 8});
  renderer.sync();
  renderer.draw(scene.placed_cameras().front(), {}, picture.target());
  write_ppm(argv[2], size_px.x, size_px.y, device->read(picture.texture()));
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "offline_library: %s\n", error.what());
  return 1;
}
