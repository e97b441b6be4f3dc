// SPDX-License-Identifier: MIT
#include "internal/eevee_surface_functions.hh"

#include "render_materials.hh"

#include <fmt/format.h>

#include <map>

namespace gnomon::eevee {

FunctionText function_of(const scene::Scene &scene, const scene::Material &material)
{
  const scene::Pool<scene::SurfaceFunction> &functions = scene.surface_functions();
  const scene::SurfaceFunction *function = functions.find(material.surface_function);
  if (!function) {
    return {};
  }
  // No two edits of a scene have the same revision.
  return {functions.revision(material.surface_function, scene::SurfaceFunction::Aspect::Text), function->text,
          function->path.empty() ? function->name : function->path};
}

FunctionText alpha_function_of(const scene::Scene &scene, const scene::Material &material)
{
  return material.alpha_mode == scene::AlphaMode::Opaque ? FunctionText() : function_of(scene, material);
}

void update_surface_functions(gpu::Buffer &block, gpu::Device &device, bool is_needed,
                              const shared::SurfaceFunctionData &data)
{
  if (!is_needed) {
    block = {};
    return;
  }
  if (!block) {
    block = device.create_buffer({"surface_function_block", gpu::BufferKind::Uniform, sizeof(data)});
  }
  device.update(block, data);
}

void free_surface_functions(ShaderCache &shaders, const scene::Scene &scene)
{
  std::set<std::uint64_t> keys;
  for (const auto &[handle, material] : scene.materials()) {
    keys.insert(function_of(scene, material).key);
  }
  shaders.keep_functions(keys);
}

std::vector<std::string> surface_function_warnings(const scene::Scene &scene, const ShaderCache &shaders)
{
  std::map<scene::Handle<scene::SurfaceFunction>, std::vector<std::string_view>> materials;
  for (const auto &[handle, material] : scene.materials()) {
    if (render_scene::has_surface_function(scene, material)) {
      materials[material.surface_function].push_back(material.name);
    }
  }
  std::vector<std::string> warnings;
  for (const auto &[handle, names] : materials) {
    const std::string failure =
        shaders.failure(scene.surface_functions().revision(handle, scene::SurfaceFunction::Aspect::Text));
    if (!failure.empty()) {
      const std::string others = names.size() > 1 ? fmt::format(" and {} others", names.size() - 1) : "";
      warnings.push_back(
          fmt::format("material '{}'{}: its surface function is broken, and magenta is drawn instead: {}",
                      names.front(), others, failure));
    }
  }
  return warnings;
}

}  // namespace gnomon::eevee
