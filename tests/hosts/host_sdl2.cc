// SPDX-License-Identifier: MIT
// A host with a window of SDL2: host_sdl2 SCENE PICTURE.ppm
#include "hosts/edited_draws.hh"

#include "../../examples/write_ppm.hh"

#define SDL_MAIN_HANDLED
#include <SDL.h>
#include <SDL_opengl.h>

#include <cstdio>
#include <stdexcept>

int main(int argc, char **argv)
try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: host_sdl2 SCENE PICTURE.ppm\n");
    return 2;
  }
  SDL_SetMainReady();
  if (SDL_Init(SDL_INIT_VIDEO) != 0) {
    throw std::runtime_error(SDL_GetError());
  }
  const std::unique_ptr<void, void (*)(void *)> at_exit(argv, [](void *) { SDL_Quit(); });
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 4);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 5);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_Window *window = SDL_CreateWindow("host_sdl2", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 320, 180,
                                        SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE);
  const SDL_GLContext context = window ? SDL_GL_CreateContext(window) : nullptr;
  if (!context) {
    throw std::runtime_error(SDL_GetError());
  }
  gnomon::test::EditedDraws draws(argv[1]);
  glm::ivec2 size_px(0);
  for (bool is_done = false; !is_done; SDL_GL_SwapWindow(window)) {
    for (SDL_Event event; SDL_PollEvent(&event) != 0;) {
    }
    SDL_GL_GetDrawableSize(window, &size_px.x, &size_px.y);
    is_done = draws.draw({.name = 0, .size_px = size_px});
    if (is_done) {
      std::vector<std::byte> rgba(4 * std::size_t(size_px.x) * std::size_t(size_px.y));
      glReadPixels(0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
      write_ppm(argv[2], size_px.x, size_px.y, rgba);
    }
  }
  draws.release();
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "host_sdl2: %s\n", error.what());
  return 1;
}
