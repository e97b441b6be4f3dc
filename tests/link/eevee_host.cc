// SPDX-License-Identifier: MIT
// A host that links the engine only: it makes programs and has no shader compiler of its own.
#include "eevee_shaders.hh"

#include <cstdio>

int main()
{
  using namespace gnomon;
  const auto device = gpu::create_null_device();
  eevee::ShaderCache shaders;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    shaders.get(*device, declaration.id, eevee::shader_variants(declaration).back());
  }
  for (const std::string &failure : shaders.reload(*device, {}, {})) {
    std::printf("%s\n", failure.c_str());
  }
}
