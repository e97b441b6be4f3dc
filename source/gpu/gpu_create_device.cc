// SPDX-License-Identifier: MIT
#include "gpu_create_device.hh"

#include <fmt/ranges.h>

#include <algorithm>

namespace gnomon::gpu {

namespace {

template <typename T>
bool is_of(const DeviceDesc &desc)
{
  return std::holds_alternative<T>(desc.host);
}

std::unique_ptr<Device> create_gl(const DeviceDesc &desc)
{
  return create_gl_device({.context = is_of<GlHost>(desc) ? ContextKind::Host : ContextKind::Headless,
                           .sink = desc.sink,
                           .shader_cache_folder = desc.shader_cache_folder});
}

std::unique_ptr<Device> create_vulkan(const DeviceDesc &desc)
{
  const auto *host = std::get_if<VulkanHost>(&desc.host);
  return create_vulkan_device({.compile_spirv = desc.compile_spirv,
                               .host = host ? std::optional(*host) : std::nullopt,
                               .sink = desc.sink,
                               .shader_cache_folder = desc.shader_cache_folder});
}

std::unique_ptr<Device> create_any(const DeviceDesc &desc)
{
  std::string reason;
  try {
    return create_gl(desc);
  }
  // Other errors are those of the caller, such as a context of its own that is current.
  catch (const TransientError &error) {
    reason = error.what();
  }
  try {
    std::unique_ptr<Device> device = create_vulkan(desc);
    send_message(desc.sink,
                 fmt::format("backend: {}, because OpenGL does not start: {}", device->description(), reason));
    return device;
  }
  catch (const Error &error) {
    throw TransientError("{}; {}", reason, error.what());
  }
}

}  // namespace

Backend backend_of(std::string_view name)
{
  const auto found = std::ranges::find(backend_names, name);
  if (found == backend_names.end()) {
    throw Error("no backend '{}'; there are: {}", name, fmt::join(backend_names, ", "));
  }
  return Backend(found - backend_names.begin());
}

std::unique_ptr<Device> create_device(const DeviceDesc &desc)
{
  const Backend of_host = is_of<GlHost>(desc)       ? Backend::OpenGl
                          : is_of<VulkanHost>(desc) ? Backend::Vulkan
                                                    : desc.backend;
  if (desc.backend != Backend::Auto && desc.backend != of_host) {
    throw Error("backend '{}': the host's is '{}'", backend_names[std::size_t(desc.backend)],
                backend_names[std::size_t(of_host)]);
  }
  switch (of_host) {
    case Backend::Auto: return create_any(desc);
    case Backend::OpenGl: return create_gl(desc);
    case Backend::Vulkan: return create_vulkan(desc);
    case Backend::Null: return create_null_device({}, desc.sink);
  }
  return nullptr;
}

}  // namespace gnomon::gpu
