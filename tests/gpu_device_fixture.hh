// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <gtest/gtest.h>

#include <cstdlib>

namespace gnomon::test {

/**
 * Headless device whose driver errors are exceptions, in every build. Where there is none, the running test is
 * skipped with the reason, or fails where CI is set; then nullptr, and the test (or SetUp) returns.
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

/** Base of test cases that need a device: a fresh one for each. */
class GpuDeviceTest : public testing::Test {
 protected:
  void SetUp() override
  {
    device = testing_gl_device();
    if (device) {
      return;
    }
    // Says again what testing_gl_device has reported, so that gtest leaves the body out.
    if (HasFailure()) {
      FAIL();
    }
    GTEST_SKIP();
  }

  std::unique_ptr<gpu::Device> device;
};

}  // namespace gnomon::test
