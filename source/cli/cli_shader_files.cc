// SPDX-License-Identifier: MIT
#include "cli_shader_files.hh"

#include <array>

namespace gnomon::cli {

namespace fs = std::filesystem;

gpu::IncludePath include_path(std::vector<fs::path> folders)
{
  return [folders = std::move(folders)](std::string_view named, std::string_view includer) {
    const fs::path beside = (fs::path(includer).parent_path() / named).lexically_normal();
    if (fs::exists(beside)) {
      return beside.string();
    }
    for (const fs::path &folder : folders) {
      const fs::path file = (folder / named).lexically_normal();
      if (fs::exists(file)) {
        return file.string();
      }
    }
    return beside.string();
  };
}

namespace {

struct Ending {
  gpu::ShaderStage stage;
  std::string_view name;
};

constexpr std::array<Ending, 9> endings = {{{gpu::ShaderStage::Vertex, ".vert"},
                                            {gpu::ShaderStage::Vertex, ".vert.glsl"},
                                            {gpu::ShaderStage::Vertex, "_vert.glsl"},
                                            {gpu::ShaderStage::Geometry, ".geom"},
                                            {gpu::ShaderStage::Geometry, ".geom.glsl"},
                                            {gpu::ShaderStage::Geometry, "_geom.glsl"},
                                            {gpu::ShaderStage::Fragment, ".frag"},
                                            {gpu::ShaderStage::Fragment, ".frag.glsl"},
                                            {gpu::ShaderStage::Fragment, "_frag.glsl"}}};

const Ending *ending_of(std::string_view path)
{
  for (const Ending &ending : endings) {
    if (path.ends_with(ending.name)) {
      return &ending;
    }
  }
  return nullptr;
}

}  // namespace

std::optional<gpu::ShaderStage> stage_of(const fs::path &path)
{
  const Ending *ending = ending_of(path.string());
  return ending == nullptr ? std::nullopt : std::optional(ending->stage);
}

bool is_surface_function(const fs::path &path)
{
  const std::string text = path.string();
  return text.ends_with(".surface.glsl") || text.ends_with("_surface.glsl");
}

std::string stem_of(const fs::path &path)
{
  const std::string text = path.string();
  const Ending *ending = ending_of(text);
  return ending == nullptr ? text : text.substr(0, text.size() - ending->name.size());
}

}  // namespace gnomon::cli
