// SPDX-License-Identifier: MIT
// Blender as a host: the script host_blender loads this library, and calls it while Blender draws its viewport.
#include "hosts/edited_draws.hh"

#include "../../examples/write_ppm.hh"

#include <epoxy/gl.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>

/**
 * One draw into the framebuffer that Blender has bound. \return whether it was the last one: the picture is written,
 * and nothing is left in Blender's context
 */
extern "C" bool host_blender_draw(const char *scene_path, const char *picture_path)
try {
  static std::unique_ptr<gnomon::test::EditedDraws> draws;
  if (!draws) {
    draws = std::make_unique<gnomon::test::EditedDraws>(scene_path);
  }
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  glm::ivec4 region(0);
  glGetIntegerv(GL_VIEWPORT, &region.x);
  const glm::ivec2 size_px(region.z, region.w);
  if (!draws->draw({.name = GLuint(framebuffer), .size_px = size_px})) {
    return false;
  }
  std::vector<std::byte> rgba(4 * std::size_t(size_px.x) * std::size_t(size_px.y));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  write_ppm(picture_path, size_px.x, size_px.y, rgba);
  draws->release();
  return true;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "host_blender: %s\n", error.what());
  std::_Exit(1);
}
