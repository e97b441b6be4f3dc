// SPDX-License-Identifier: MIT
#include "eevee_shaders.hh"

#include "eevee_interfaces.hh"
#include "shader_files.hh"

namespace gnomon::eevee {

namespace {

/** Features that also affect programs without Feature::Light. */
constexpr Feature unlit_features = Feature::BaseColorTexture | Feature::AlphaMask | Feature::FullMaterial |
                                   Feature::TargetDepth | Feature::OpacityThreshold;

/** A reflection function that returns the interface of a variant from the table that the build generated. */
gpu::ShaderReflection generated_reflection(ShaderId id, Feature features)
{
  return [id, features](std::string_view, const std::vector<gpu::ShaderSource> &) {
    return interface_tables()[std::size_t(id)].interface_of(std::uint32_t(features));
  };
}

}  // namespace

ShaderCache::ShaderCache() : files_(shaders::file) {}

void ShaderCache::set_pcf(const PcfKernel &pcf)
{
  if (pcf_ != pcf) {
    std::erase_if(shaders_, [](const auto &entry) { return has(entry.first.second, Feature::ShadowPcf); });
    pcf_ = pcf;
  }
}

const gpu::Shader &ShaderCache::get(gpu::Device &device, ShaderId id, Feature features)
{
  const ShaderDeclaration &declaration = shader_declarations()[std::size_t(id)];
  const Feature reachable = has(features, Feature::Light) ? features : features & unlit_features;
  const Key key(id, reachable & declaration.features);
  const auto found = shaders_.find(key);
  // The program is empty if the packet that contained its creation was lost.
  if (found != shaders_.end() && found->second) {
    return found->second;
  }
  return shaders_[key] = make(device, key);
}

gpu::Shader ShaderCache::make(gpu::Device &device, const Key &key) const
{
  const auto &[id, features] = key;
  return device.create_shader(shader_desc(shader_declarations()[std::size_t(id)], features, pcf_), files_,
                              reflection_ ? reflection_ : generated_reflection(id, features));
}

std::vector<Feature> ShaderCache::made(ShaderId id) const
{
  std::vector<Feature> variants;
  for (const auto &[key, shader] : shaders_) {
    if (key.first == id) {
      variants.push_back(key.second);
    }
  }
  return variants;
}

std::vector<std::string> ShaderCache::reload(gpu::Device &device, gpu::ShaderFiles files,
                                             gpu::ShaderReflection reflection)
{
  if (!reflection) {
    return {
        "shaders are not reloaded: the host gives no reflection function; shader_check::reflect of the library "
        "gnomon::shader_check is one"};
  }
  files_ = std::move(files);
  reflection_ = std::move(reflection);
  std::vector<std::string> failures;
  for (auto &[key, shader] : shaders_) {
    try {
      shader = make(device, key);
    }
    catch (const gpu::Error &error) {
      failures.emplace_back(error.what());
    }
  }
  return failures;
}

}  // namespace gnomon::eevee
