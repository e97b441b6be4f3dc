// SPDX-License-Identifier: MIT
#include "cli_device.hh"

#include "shader_check_spirv.hh"
#include "trace.hh"

#include <vector>

namespace gnomon::cli {

void add_backend_option(CLI::App &command, std::string &backend, std::string_view null)
{
  const std::span<const std::string_view> names =
      null.empty() ? gpu::drawing_backend_names : std::span<const std::string_view>(gpu::backend_names);
  command
      .add_option("--backend", backend,
                  fmt::format("gl, vulkan, auto: OpenGL if it starts, otherwise Vulkan{}{}",
                              null.empty() ? "" : ", or null: ", null))
      ->capture_default_str()
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
}

std::unique_ptr<gpu::Device> create_device(std::string_view name)
{
  const trace::Span span("device");
  return gpu::create_device({.backend = gpu::backend_of(name),
                             .compile_spirv = shader_check::compile_spirv,
                             .shader_cache_folder = gpu::default_shader_cache_folder()});
}

}  // namespace gnomon::cli
