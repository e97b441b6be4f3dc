// SPDX-License-Identifier: MIT
// This file has OpenGL's functions from epoxy; examples have them from their toolkits.
#include "hosts/checked_renderer.hh"

#include "gpu/gpu_gl_state_table.hh"
#include "hosts/host_calls.hh"

#include <cstdio>
#include <cstdlib>

namespace gnomon::test {

namespace {

/** Counts calls, and fails at the end of the program if there was none. */
struct CallCount {
  ~CallCount()
  {
    if (count == 0) {
      std::fputs("no call of the library was checked\n", stderr);
      std::_Exit(1);
    }
    std::printf("%d calls left the state of OpenGL as it was\n", count);
  }
  int count = 0;
};
CallCount calls;

}  // namespace

void expect_state_kept(const char *name, const std::function<void()> &call)
{
  static const std::vector<StateItem> table = state_table();
  // Errors of the toolkit.
  while (glGetError() != GL_NO_ERROR) {
  }
  const StateSnapshot before(table);
  call();
  const GLenum error = glGetError();
  std::vector<std::string> changes = before.differences();
  if (error != GL_NO_ERROR) {
    changes.push_back(fmt::format("glGetError: {:#x}", error));
  }
  for (const std::string &change : changes) {
    std::fprintf(stderr, "%s: %s\n", name, change.c_str());
  }
  if (!changes.empty()) {
    std::_Exit(1);
  }
  calls.count++;
}

void expect_state_kept_by_all_calls(const scene::Scene &scene, const draw::Target &target)
{
  make_host_calls(scene, std::get<gpu::HostFramebuffer>(target.framebuffer), expect_state_kept);
}

}  // namespace gnomon::test
