// SPDX-License-Identifier: MIT
#include "internal/gltf_write_world.hh"

#include "internal/gltf_model.hh"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <system_error>

namespace gnomon::gltf {

namespace {

namespace fs = std::filesystem;

/** Unreserved characters of RFC 3986 and slashes stay, others become % and two digits. */
std::string percent_encoded(std::string_view path)
{
  constexpr std::string_view kept = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  std::string uri;
  for (const char character : path) {
    if (kept.find(character) != kept.npos) {
      uri += character;
    }
    else {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(character));
    }
  }
  return uri;
}

/** Empty if there is no such file, or no path to it from \a folder. */
std::string uri_of(const std::string &path, const fs::path &folder)
{
  std::error_code error;
  if (path.empty() || !fs::is_regular_file(path, error)) {
    return {};
  }
  const fs::path relative = fs::relative(path, folder.empty() ? fs::path(".") : folder, error);
  return error ? std::string() : percent_encoded(relative.generic_string());
}

}  // namespace

void add_world_extras(const scene::World &world, const fs::path &folder, WrittenBuffer &buffer, JsonText &extras)
{
  constexpr std::string_view what = "world";
  if (!world.picture) {
    extras.add("gnomon_world", json_numbers(world.color, what));
  }
  else {
    if (const std::string uri = uri_of(world.picture->path, folder); !uri.empty()) {
      extras.add("gnomon_world", '"' + uri + '"');
    }
    else {
      extras.add("gnomon_world_accessor",
                 std::to_string(buffer.add_accessor(world.picture->texels, Model::Float, "VEC3")));
      extras.add("gnomon_world_width", std::to_string(world.picture->width));
    }
    extras.add("gnomon_world_color", json_numbers(world.color, what));
  }
  extras.add("gnomon_world_strength", json_number(world.strength, what));
  extras.add("gnomon_world_rotation", json_number(world.rotation, what));
}

}  // namespace gnomon::gltf
