// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"
#include "shader_check_spirv.hh"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

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

/** Sets options of Vulkan's validation layers, whose defaults differ between versions. */
inline void set_validation_options()
{
  // Versions since 1.3.296 do not check what shaders access by default.
  setenv("VK_KHRONOS_VALIDATION_SYNCVAL_SHADER_ACCESSES_HEURISTIC", "true", 1);
  // Versions with this option check submits without regard to timeline semaphores (Vulkan-ValidationLayers #7457).
  setenv("VK_KHRONOS_VALIDATION_SYNC_QUEUE_SUBMIT", "false", 1);
}

/**
 * \throws Error. Messages of Vulkan's validation layers are errors, or failures where they come from a destructor.
 * \a shader_cache_folder: for SPIR-V; Mesa's driver of OpenGL has a cache of its own.
 */
inline std::unique_ptr<gpu::Device> create_testing_device(const std::string &backend,
                                                          const std::filesystem::path &shader_cache_folder = {})
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
  set_validation_options();
  const auto sink = [](std::string_view message) {
    if (message.starts_with("the validation layers report")) {
      ADD_FAILURE() << message;
    }
    else {
      fmt::print(stderr, "gnomon: {}\n", message);
    }
  };
  return gpu::create_vulkan_device({.compile_spirv = shader_check::compile_spirv,
                                    .is_debug = true,
                                    .sink = sink,
                                    .shader_cache_folder = shader_cache_folder});
}

/**
 * A headless device of \a backend that throws driver errors, also in release builds. If there is no driver, the test is
 * skipped with the reason, or fails if CI is set, and the function returns nullptr. In SetUp, the test then does not
 * run; elsewhere, it must return.
 */
inline std::unique_ptr<gpu::Device> testing_device(const std::string &backend,
                                                   const std::filesystem::path &shader_cache_folder = {})
{
  try {
    return create_testing_device(backend, shader_cache_folder);
  }
  catch (const gpu::Error &error) {
    const char *ci = std::getenv("CI");
    [&] {
      if (ci && *ci) {
        FAIL() << "CI is set and there is no GPU device: " << error.what();
      }
      GTEST_SKIP() << error.what();
    }();
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

/** Base of test cases of the device itself. Each test has a new one. */
class GpuDeviceTest : public testing::Test {
 protected:
  void SetUp() override
  {
    device = testing_device(testing_backend());
  }

  std::unique_ptr<gpu::Device> device;
};

/** The device that the tests of this process share. It ends with them, before the libraries of the driver do. */
class SharedDevice : public testing::Environment {
 public:
  void TearDown() override
  {
    device.reset();
  }

  static inline std::unique_ptr<gpu::Device> device;
};
inline testing::Environment *const shared_device_end = testing::AddGlobalTestEnvironment(new SharedDevice);

/**
 * Base of test cases of what a device draws. They share one, so that programs are compiled once, as for the scenes of a
 * host, and must leave no resource on it. After a test has failed, the next one has a new device.
 */
class SharedDeviceTest : public testing::Test {
 protected:
  ~SharedDeviceTest() override
  {
    if (device) {
      EXPECT_EQ(device->live_resources(), std::vector<std::string>()) << "left by the test";
    }
  }

  void SetUp() override
  {
    static int failed_count = 0;
    const int failed_count_now = testing::UnitTest::GetInstance()->failed_test_count();
    const bool has_failed = std::exchange(failed_count, failed_count_now) != failed_count_now;
    // Passes with names beyond a number are not counted by name.
    if (has_failed ||
        (SharedDevice::device && SharedDevice::device->pass_counts().size() > gpu::Device::pass_name_max / 2)) {
      SharedDevice::device.reset();
    }
    if (!SharedDevice::device) {
      SharedDevice::device = testing_device(testing_backend(), GNOMON_TEST_SHADER_CACHE);
    }
    device = SharedDevice::device.get();
    if (device) {
      counts_before_ = device->pass_counts();
    }
  }

  /**
   * Sets the test up again on a new device, for tests of what a device has compiled or allocated. \pre the test has no
   * resource
   */
  void set_up_on_new_device()
  {
    SharedDevice::device.reset();
    SetUp();
  }

  /** How often a pass named \a pass has run since the test began. */
  [[nodiscard]] std::uint64_t runs(const std::string &pass) const
  {
    const auto count = [&](const gpu::PassCounts &counts) {
      const auto found = counts.find(pass);
      return found == counts.end() ? 0 : found->second;
    };
    return count(device->pass_counts()) - count(counts_before_);
  }

  gpu::Device *device = nullptr;

 private:
  gpu::PassCounts counts_before_;
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
