// SPDX-License-Identifier: MIT
#pragma once

#include "frames/frames_scene.hh"
#include "frames/frames_threads.hh"

#include "gpu_error.hh"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace gnomon::test {

using eevee::SceneRenderer;
using Bytes = std::vector<std::byte>;

inline constexpr glm::ivec2 frames_size_px{48, 32};

/** After the edits of the first \a edit_count frames. */
inline Bytes fresh_picture(gpu::Device &device, int edit_count)
{
  FramesScene frames;
  for (int frame = 0; frame < edit_count; frame++) {
    frames.edit(frame);
  }
  SceneRenderer renderer(device, frames.scene, frames_size_px, frames_settings());
  renderer.sync();
  renderer.draw(FramesScene::camera(0));
  return device.read(renderer.engine().radiance(renderer.viewport()));
}

/** Makes an allocation on the device fail. */
struct FailingAllocation {
  /** Allocations up to the one that fails; negative: none fails. */
  static inline int until_failure = -1;
  /** One has failed. */
  static inline bool is_out_of_memory = false;

  /** \return whether the allocation that is about to be made fails */
  static bool fails()
  {
    const bool fails = until_failure >= 0 && until_failure-- == 0;
    is_out_of_memory = is_out_of_memory || fails;
    return fails;
  }
};

/**
 * In first pictures with lamps and shadows of all kinds, one allocation after the other fails once, and the next
 * picture is \a expected.
 */
inline void expect_pictures_after_each_failed_allocation(gpu::Device &device, const Bytes &expected)
{
  FramesScene frames;
  frames.edit(0);
  int failure_count = 0;
  for (bool has_failed = true; has_failed; failure_count += has_failed) {
    SCOPED_TRACE(failure_count);
    SceneRenderer renderer(device, frames.scene, frames_size_px, frames_settings());
    FailingAllocation::until_failure = failure_count;
    has_failed = false;
    try {
      renderer.sync();
      renderer.draw(FramesScene::camera(0));
    }
    catch (const gpu::Error &error) {
      has_failed = true;
      EXPECT_NE(std::string_view(error.what()).find("the driver is out of memory"), std::string_view::npos)
          << error.what();
    }
    FailingAllocation::until_failure = -1;
    renderer.sync();
    renderer.draw(FramesScene::camera(0));
    ASSERT_EQ(device.read(renderer.engine().radiance(renderer.viewport())), expected);
  }
  EXPECT_GE(failure_count, 15);
  EXPECT_TRUE(device.live_resources().empty());
}

}  // namespace gnomon::test
