// SPDX-License-Identifier: MIT
// This file has OpenGL's functions from epoxy; examples have them from their toolkits.
#include "engines/scene_edits.hh"

#include "hosts/checked_renderer.hh"

#include "gpu/gpu_gl_state_table.hh"
#include "hosts/host_calls.hh"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string_view>

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
    std::printf("%d edits, %d calls left %zu items of the state of OpenGL as they were\n", edit_count, count,
                item_count);
  }
  int count = 0;
  int edit_count = 0;
  std::size_t item_count = 0;
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
  try {
    call();
  }
  catch (const std::exception &failure) {
    std::fprintf(stderr, "%s: %s\n", name, failure.what());
    std::_Exit(1);
  }
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
  calls.item_count = table.size();
}

void expect_state_kept_by_all_calls(const scene::Scene &scene, const draw::Target &target)
{
  make_host_calls(scene, std::get<gpu::HostFramebuffer>(target.framebuffer), expect_state_kept);
}

std::function<std::string()> listed_edits(scene::Scene &scene)
{
  std::vector<SceneEdit> edits = edited_scene_of(scene).edits;
  std::shuffle(edits.begin(), edits.end(), std::mt19937(1));
  const char *filter = std::getenv("GTEST_FILTER");
  const int count = filter && std::string_view(filter).starts_with("-Slow") ? 40 : 1000;
  return [&scene, edits = std::move(edits), count, i = 0]() mutable {
    if (i == count) {
      return std::string();
    }
    const SceneEdit &edit = edits[std::size_t(i / 2) % edits.size()];
    const bool is_taken_back = i++ % 2 == 1;
    (is_taken_back ? edit.undo : edit.apply)(scene);
    calls.edit_count++;
    return (is_taken_back ? "not " : "") + edit.name;
  };
}

}  // namespace gnomon::test
