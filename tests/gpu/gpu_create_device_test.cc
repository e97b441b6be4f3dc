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

}  // namespace
}  // namespace gnomon::gpu
