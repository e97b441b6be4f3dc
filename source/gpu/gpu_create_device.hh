// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <array>
#include <span>
#include <variant>

namespace gnomon::gpu {

/** Auto: the host's; without a host OpenGL 4.5, or Vulkan if OpenGL does not start. Null: draws nothing. */
enum class Backend : std::uint8_t { Auto, OpenGl, Vulkan, Null };

/** "auto", "gl", "vulkan", "null": for users, in the order of Backend. */
inline constexpr std::array<std::string_view, 4> backend_names = {"auto", "gl", "vulkan", "null"};
/** The names for users who want a picture: all but "null". */
inline constexpr std::span<const std::string_view> drawing_backend_names = std::span(backend_names).first<3>();
/** \throws Error if \a name is none of backend_names */
[[nodiscard]] Backend backend_of(std::string_view name);

/** The context of OpenGL that is current on the thread. \see ContextKind::Host */
struct GlHost {};

/** Where a device draws: in a context of its own, or in the host's. */
using Host = std::variant<std::monostate, GlHost, VulkanHost>;

struct DeviceDesc {
  Backend backend = Backend::Auto;
  Host host{};
  /** The same as VulkanDeviceDesc::compile_spirv. Empty: Vulkan does not start. */
  SpirvCompiler compile_spirv{};
  MessageSink sink{};
  /** The same as GlDeviceDesc::shader_cache_folder. */
  std::filesystem::path shader_cache_folder{};
};

/**
 * Create a device. If Backend::Auto takes Vulkan without a host, the sink gets a line that says so and why.
 *
 * \throws Error with the reasons, each named, for which the backend does not start, or if \a desc asks for another
 * backend than that of the host
 */
[[nodiscard]] std::unique_ptr<Device> create_device(const DeviceDesc &desc);

}  // namespace gnomon::gpu
