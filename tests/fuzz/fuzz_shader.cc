// SPDX-License-Identifier: MIT
// Preprocesses a text as Gnomon's shaders are, and checks it as a shader of others. The last byte selects the target.
#include "fuzz_file.hh"
#include "gpu_error.hh"
#include "shader_check.hh"

#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  using namespace gnomon;
  if (size == 0) {
    return 0;
  }
  const std::string text(reinterpret_cast<const char *>(data), size - 1);
  const gpu::ShaderFiles files = [&](std::string_view path) -> std::optional<std::string_view> {
    return path == "main.frag" || path == "self.glsl" ? std::optional<std::string_view>(text) : std::nullopt;
  };
  try {
    static_cast<void>(gpu::preprocess({"fuzz", "main.frag", "", "main.frag", {"USE_FUZZ"}}, files));
  }
  catch (const gpu::Error &) {
  }
  const auto targets = shader_check::check_targets();
  static_cast<void>(shader_check::check_program(
      {.name = "fuzz", .files = {{shader_check::Stage::Fragment, "main.frag"}}, .defines = {}}, files,
      {.target = targets[data[size - 1] % targets.size()].target}));
  return 0;
}
