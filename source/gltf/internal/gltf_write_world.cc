// SPDX-License-Identifier: MIT
#include "internal/gltf_write_world.hh"

#include "internal/gltf_file.hh"
#include "internal/gltf_write_uri.hh"

#include <string>
#include <string_view>

namespace gnomon::gltf {

namespace fs = std::filesystem;

void add_world_extras(const scene::World &world, const fs::path &folder, WrittenBuffer &buffer, JsonText &extras)
{
  constexpr std::string_view what = "world";
  if (!world.picture) {
    extras.add(world_picture_key, json_numbers(world.color, what));
  }
  else {
    if (const std::string uri = uri_of_file(world.picture->path, folder); !uri.empty()) {
      extras.add(world_picture_key, '"' + uri + '"');
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
