// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"
#include "shader_check_spirv.hh"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace gnomon::test {

/**
 * The backend of devices of tests: the environment variable GNOMON_TEST_BACKEND, `gl` (the default), `vulkan`, or
 * `swiftshader`: Vulkan with SwiftShader, a second driver on the CPU.
 */
inline std::string testing_backend()
{
  const char *backend = std::getenv("GNOMON_TEST_BACKEND");
  return backend && *backend ? backend : "gl";
}

/** The description of SwiftShader for the loader of Vulkan. \throws Error if scripts/setup did not unpack it */
inline std::string swiftshader_driver()
{
  const std::string path = GNOMON_SOURCE "/build/swiftshader/vk_swiftshader_icd.json";
  if (!std::filesystem::exists(path)) {
    throw gpu::Error("there is no {}, which scripts/setup unpacks", path);
  }
  return path;
}

/** \throws Error. Messages of Vulkan's validation layers are errors, or failures where they come from a destructor. */
inline std::unique_ptr<gpu::Device> create_testing_device(const std::string &backend)
{
  if (backend == "gl") {
    return gpu::create_gl_device({.is_debug = true});
  }
  if (backend == "swiftshader") {
    setenv("VK_DRIVER_FILES", swiftshader_driver().c_str(), 1);
  }
  else if (backend != "vulkan") {
    throw gpu::Error("GNOMON_TEST_BACKEND is '{}', not 'gl', 'vulkan' or 'swiftshader'", backend);
  }
  const auto sink = [](std::string_view message) {
    if (message.starts_with("Validation")) {
      ADD_FAILURE() << message;
    }
    else {
      fmt::print(stderr, "gnomon: {}\n", message);
    }
  };
  return gpu::create_vulkan_device({.compile_spirv = shader_check::compile_spirv, .is_debug = true, .sink = sink});
}

/**
 * A headless device of \a backend that throws driver errors, also in release builds. If there is no driver, the test is
 * skipped with the reason, or fails if CI is set, and the function returns nullptr; the test (or SetUp) must then
 * return.
 */
inline std::unique_ptr<gpu::Device> testing_device(const std::string &backend)
{
  try {
    return create_testing_device(backend);
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

/** For tests of OpenGL, and of programs that use it. */
inline std::unique_ptr<gpu::Device> testing_gl_device()
{
  return testing_device("gl");
}

/** For tests of Vulkan: with SwiftShader if it is tested, and otherwise with the driver that the loader finds. */
inline std::unique_ptr<gpu::Device> testing_vulkan_device()
{
  return testing_device(testing_backend() == "swiftshader" ? "swiftshader" : "vulkan");
}

/** Base of test cases that need a device. Each test has a new one. */
class GpuDeviceTest : public testing::Test {
 protected:
  void SetUp() override
  {
    device = testing_device(testing_backend());
    if (device) {
      return;
    }
    // Repeats the result of testing_device, so that gtest does not run the body.
    if (HasFailure()) {
      FAIL();
    }
    GTEST_SKIP();
  }

  std::unique_ptr<gpu::Device> device;
};

/** Base of test cases that need a device of OpenGL. Skipped if another backend is tested. */
class GlDeviceTest : public GpuDeviceTest {
 protected:
  void SetUp() override
  {
    if (testing_backend() != "gl") {
      GTEST_SKIP() << "of OpenGL alone";
    }
    GpuDeviceTest::SetUp();
  }
};

}  // namespace gnomon::test
