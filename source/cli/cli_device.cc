// SPDX-License-Identifier: MIT
#include "cli_device.hh"

#include "shader_check_spirv.hh"
#include "trace.hh"

namespace gnomon::cli {

std::unique_ptr<gpu::Device> create_device(std::string_view name)
{
  const trace::Span span("device");
  return gpu::create_device({.backend = gpu::backend_of(name),
                             .compile_spirv = shader_check::compile_spirv,
                             .shader_cache_folder = gpu::default_shader_cache_folder()});
}

}  // namespace gnomon::cli
