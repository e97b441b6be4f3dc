// SPDX-License-Identifier: MIT
#include "eevee_shaders.hh"

#include "eevee_interfaces.hh"
#include "gpu_shader_text.hh"
#include "shader_files.hh"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Adds the bindings that the code around a surface function reads. They are the same in all programs. */
void add_function_bindings(gpu::ShaderInterface &interface)
{
  using Binding = gpu::ShaderInterface::Binding;
  const auto features = std::uint32_t(Feature::AlphaMask | Feature::FullMaterial);
  const gpu::ShaderInterface function = interface_tables()[std::size_t(ShaderId::DepthFunction)].interface_of(features);
  for (const Binding &binding : function.bindings) {
    const bool is_added = binding.kind == gpu::BindingKind::Texture || binding.name == "surface_function_block";
    if (is_added && !interface.find(binding.kind, binding.name)) {
      interface.bindings.push_back(binding);
    }
  }
  std::ranges::sort(interface.bindings, {},
                    [](const Binding &binding) { return std::pair(binding.kind, binding.slot); });
}

/** A reflection function that returns the interface of a variant from the table that the build generated. */
gpu::ShaderReflection generated_reflection(ShaderId id, Feature features, bool has_function)
{
  return [=](std::string_view, const std::vector<gpu::ShaderSource> &) {
    gpu::ShaderInterface interface = interface_tables()[std::size_t(id)].interface_of(std::uint32_t(features));
    if (has_function) {
      add_function_bindings(interface);
    }
    return interface;
  };
}

/** Added to the lines of functions, by which they are found in messages: Mesa names the wrong file in most of its own.
 */
constexpr int function_line_offset = 1000000;

std::string numbered(std::string_view text)
{
  return fmt::format("#line {}\n{}", function_line_offset + 1, text);
}

/** The first line of a compiler's \a message about a numbered() text, or else its first error. */
std::string failure_of(std::string_view message, const std::string &file)
{
  std::istringstream lines{std::string(message)};
  std::string first_error;
  for (std::string line; std::getline(lines, line);) {
    for (std::size_t at = line.find_first_of(":("); at != std::string::npos; at = line.find_first_of(":(", at + 1)) {
      gpu::TextScanner scanner(std::string_view(line).substr(at + 1));
      const int number = scanner.take_number().value_or(0);
      if (number > function_line_offset) {
        return fmt::format("{}:{}{}", file, number - function_line_offset, scanner.rest());
      }
    }
    const bool is_error = line.find("error") != std::string::npos || line.find("ERROR") != std::string::npos;
    first_error = first_error.empty() && is_error ? line : first_error;
  }
  return fmt::format("{}: {}", file, first_error.empty() ? message : first_error);
}

}  // namespace

ShaderCache::ShaderCache() : files_(shaders::file) {}

void ShaderCache::set_pcf(const PcfKernel &pcf)
{
  if (pcf_ != pcf) {
    std::erase_if(shaders_, [](const auto &entry) { return has(std::get<Feature>(entry.first), Feature::ShadowPcf); });
    pcf_ = pcf;
  }
}

const gpu::Shader &ShaderCache::get(gpu::Device &device, ShaderId id, Feature features, const FunctionText &function)
{
  const ShaderDeclaration &declaration = shader_declarations()[std::size_t(id)];
  const Feature variant = variant_of(declaration, features);
  // With 8 bits, positions from depths are off their plane by less than the normal offset of receivers.
  const bool is_on_grid = device.limits().subpixel_bits < 8 && !has(features, Feature::LinesOrPoints);
  const Feature grid = is_on_grid ? Feature::CoarseGrid : Feature::None;
  const Key key(id, variant | ((features | grid) & constants_of(declaration, variant)), function.key);
  const auto found = shaders_.find(key);
  // The program is empty if the packet that contained its creation was lost.
  if (found != shaders_.end() && found->second->shader) {
    return found->second->shader;
  }
  if (function.key != 0) {
    functions_.try_emplace(function.key, Function{std::string(function.text), std::string(function.file)});
  }
  return (shaders_[key] = make(device, key))->shader;
}

std::shared_ptr<gpu::SharedShader> ShaderCache::make(gpu::Device &device, const Key &key) const
{
  const auto &[id, features, function] = key;
  const ShaderDeclaration &declaration = shader_declarations()[std::size_t(id)];
  gpu::ShaderDesc desc = shader_desc(declaration, features, pcf_);
  const gpu::ShaderReflection reflection =
      reflection_ ? reflection_ : generated_reflection(id, without(features, program_constants), function != 0);
  std::string text;
  if (function != 0) {
    desc = with_surface_function(desc, declaration);
    text = fmt::format("{}\n{}", functions_.at(function).file, functions_.at(function).text);
  }
  const auto fill = [&, function = function](gpu::SharedShader &made) {
    made = function == 0 ? gpu::SharedShader{device.create_shader(desc, files_, reflection)}
                         : make_with(function, device, desc, reflection);
  };
  if (reflection_) {
    // Files of a reload are known to this engine alone.
    auto own = std::make_shared<gpu::SharedShader>();
    fill(*own);
    return own;
  }
  return device.shared_shader(desc, text, fill);
}

gpu::SharedShader ShaderCache::make_with(std::uint64_t function_key, gpu::Device &device, const gpu::ShaderDesc &desc,
                                         const gpu::ShaderReflection &reflection) const
{
  const Function &function = functions_.at(function_key);
  const auto files_with = [this](std::optional<std::string_view> text) {
    return [this, text](std::string_view path) { return path == surface_function_file ? text : files_(path); };
  };
  const gpu::ShaderFiles stand_in = files_with(files_("eevee/eevee_surface_stand_in.glsl"));
  // The failure of another program with this function.
  std::string known = failure(function_key);
  if (const auto fault = surface_function_fault(function.text)) {
    known = fmt::format("{}:{}: {}", function.file, fault->line, fault->reason);
  }
  if (function.text.empty()) {
    known = fmt::format("{}: it has no text", function.file);
  }
  if (known.empty()) {
    try {
      const std::string text = numbered(function.text);
      return {device.create_shader(desc, files_with(text), reflection, stand_in)};
    }
    catch (const gpu::Error &error) {
      known = failure_of(error.what(), function.file);
    }
  }
  return {device.create_shader(desc, stand_in, reflection), known};
}

void ShaderCache::keep_functions(const std::set<std::uint64_t> &keys)
{
  std::erase_if(functions_, [&](const auto &entry) { return !keys.contains(entry.first); });
  std::erase_if(shaders_, [&](const auto &entry) {
    const auto &[id, features, function] = entry.first;
    return function != 0 && !keys.contains(function);
  });
}

void ShaderCache::take_failures(const gpu::Feedback &feedback)
{
  for (const gpu::Feedback::FailedShader &failed : feedback.failed_shaders) {
    for (const auto &[key, shared] : shaders_) {
      const auto function = functions_.find(std::get<2>(key));
      if (shared->shader.id() == failed.shader && function != functions_.end()) {
        shared->failure = failure_of(failed.reason, function->second.file);
      }
    }
  }
}

std::string ShaderCache::failure(std::uint64_t function_key) const
{
  for (const auto &[key, shared] : shaders_) {
    if (std::get<2>(key) == function_key && !shared->failure.empty()) {
      return shared->failure;
    }
  }
  return {};
}

std::vector<Feature> ShaderCache::made(ShaderId id) const
{
  std::set<Feature> variants;
  for (const auto &[key, shader] : shaders_) {
    const auto &[made_id, features, function] = key;
    if (made_id == id) {
      variants.insert(without(features, program_constants));
    }
  }
  return {variants.begin(), variants.end()};
}

std::vector<std::string> ShaderCache::reload(gpu::Device &device, gpu::ShaderFiles files,
                                             gpu::ShaderReflection reflection)
{
  revision_++;
  if (!reflection) {
    return {
        "shaders are not reloaded: the host gives no reflection function; shader_check::reflect of the library "
        "gnomon::shader_check is one"};
  }
  files_ = std::move(files);
  reflection_ = std::move(reflection);
  std::vector<std::string> failures;
  // Meanwhile, failures of functions are those of their programs that were made again.
  const std::map<Key, std::shared_ptr<gpu::SharedShader>> last = std::exchange(shaders_, {});
  for (const auto &[key, shared] : last) {
    try {
      shaders_[key] = make(device, key);
    }
    catch (const gpu::Error &error) {
      shaders_[key] = shared;
      failures.emplace_back(error.what());
    }
  }
  return failures;
}

}  // namespace gnomon::eevee
