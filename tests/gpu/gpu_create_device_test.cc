// SPDX-License-Identifier: MIT
#include "gpu_create_device.hh"

#include "gpu/gpu_testing.hh"

namespace gnomon::gpu {
namespace {

TEST(CreateDevice, EachBackendHasAName)
{
  for (const Backend backend : {Backend::Auto, Backend::OpenGl, Backend::Vulkan, Backend::Null}) {
    EXPECT_EQ(backend_of(backend_names[std::size_t(backend)]), backend);
  }
  test::expect_contains(test::error_of([] { static_cast<void>(backend_of("metal")); }),
                        "no backend 'metal'; there are: auto, gl, vulkan, null");
}

TEST(CreateDevice, NullNeedsNoDriver)
{
  test::expect_contains(create_device({.backend = Backend::Null})->description(), "null");
}

TEST(CreateDevice, TheBackendIsTheHosts)
{
  for (const Backend backend : {Backend::Vulkan, Backend::Null}) {
    test::expect_contains(
        test::error_of([&] { static_cast<void>(create_device({.backend = backend, .host = GlHost{}})); }),
        "the host's is 'gl'");
  }
}

TEST(CreateDevice, DriversThatDrawWrongPicturesAreKnown)
{
  EXPECT_TRUE(draws_wrong("OpenGL 4.5.0 NVIDIA 580.159.04, NVIDIA H200/PCIe/SSE2 (EGL device 0)"));
  EXPECT_FALSE(
      draws_wrong("OpenGL 4.5 (Core Profile) Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 256 bits) (EGL surfaceless)"));
}

}  // namespace
}  // namespace gnomon::gpu
