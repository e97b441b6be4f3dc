// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <gtest/gtest.h>

#include <cstdlib>

namespace gnomon::test {

/**
 * A headless device that throws driver errors, also in release builds. If there is no driver, the test is skipped with
 * the reason, or fails if CI is set, and the function returns nullptr; the test (or SetUp) must then return.
 */
inline std::unique_ptr<gpu::Device> testing_gl_device()
{
  try {
    return gpu::create_gl_device({.is_debug = true});
  }
  catch (const gpu::Error &error) {
    const char *ci = std::getenv("CI");
    if (ci && *ci) {
      ADD_FAILURE() << "CI is set and there is no GPU device: " << error.what();
    }
    else {
      [&] { GTEST_SKIP() << error.what(); }();
    }
    return nullptr;
  }
}

/** Base of test cases that need a device. Each test has a new one. */
class GpuDeviceTest : public testing::Test {
 protected:
  void SetUp() override
  {
    device = testing_gl_device();
    if (device) {
      return;
    }
    // Repeats the result of testing_gl_device, so that gtest does not run the body.
    if (HasFailure()) {
      FAIL();
    }
    GTEST_SKIP();
  }

  std::unique_ptr<gpu::Device> device;
};

}  // namespace gnomon::test
