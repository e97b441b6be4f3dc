// SPDX-License-Identifier: MIT
#include "cli_shader_files.hh"

#include <fmt/format.h>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct Ending {
  shader_check::Stage stage;
  std::size_t size;
};

std::optional<Ending> ending_of(std::string_view path)
{
  for (const shader_check::StageName &stage : shader_check::stage_names()) {
    for (const std::string &ending : {fmt::format(".{}", stage.ending), fmt::format(".{}.glsl", stage.ending),
                                      fmt::format("_{}.glsl", stage.ending)}) {
      if (path.ends_with(ending)) {
        return Ending{stage.stage, ending.size()};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<shader_check::Stage> stage_of(const fs::path &path)
{
  const std::optional<Ending> ending = ending_of(path.string());
  return ending ? std::optional(ending->stage) : std::nullopt;
}

std::string with_stage(const fs::path &path, shader_check::Stage stage)
{
  std::string text = path.string();
  const std::optional<Ending> ending = ending_of(text);
  if (!ending) {
    return {};
  }
  // A dot or an underscore precedes the name of the stage.
  const std::string_view name = shader_check::stage_names()[std::size_t(ending->stage)].ending;
  const std::string_view wanted = shader_check::stage_names()[std::size_t(stage)].ending;
  return text.replace(text.size() - ending->size + 1, name.size(), wanted);
}

bool is_surface_function(const fs::path &path)
{
  const std::string text = path.string();
  return text.ends_with(".surface.glsl") || text.ends_with("_surface.glsl");
}

std::string stem_of(const fs::path &path)
{
  const std::string text = path.string();
  const std::optional<Ending> ending = ending_of(text);
  return ending ? text.substr(0, text.size() - ending->size) : text;
}

}  // namespace gnomon::cli
