// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_report.hh"
#include "scene.hh"

#include <array>
#include <cstdint>
#include <map>
#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Textures that replace missing or damaged ones, one for each slot that needs it. */
class StandIns {
 public:
  explicit StandIns(scene::Scene &scene) : scene_(scene) {}

  [[nodiscard]] scene::Handle<scene::Texture> texture_of(const scene::TextureInput &input)
  {
    scene::Handle<scene::Texture> &texture = textures_[input.key()];
    if (!texture) {
      // Only a base colour is a checkerboard, so that the stand-in is visible as such.
      const std::array<std::uint8_t, 4> other = input.slot == &scene::Material::base_color_texture
                                                    ? std::array<std::uint8_t, 4>{0, 0, 0, 255}
                                                    : input.stand_in;
      scene::Image image{"stand-in for " + std::string(input.key()), 2, 2, {}};
      for (const auto &texel : {input.stand_in, other, other, input.stand_in}) {
        image.texels.insert(image.texels.end(), texel.begin(), texel.end());
      }
      scene::Texture value{.image = scene_.add(std::move(image))};
      value.magnified = value.minified = scene::TextureFilter::Nearest;
      value.mip = scene::MipFilter::Linear;
      texture = scene_.add(value);
    }
    return texture;
  }

  /** Warns that \a input of \a material has a stand-in, and notes the limit that is the reason. */
  void warn(const std::string &material, const scene::TextureInput &input, const Fault &fault, Warnings &warnings)
  {
    const std::string reason =
        "its " + std::string(input.key()) + " is drawn as " + std::string(input.stand_in_name) + ": " + fault.what();
    warnings.add(material, reason);
    if (fault.is_limit) {
      scene_.limits.push_back(material + ": " + reason);
    }
  }

 private:
  scene::Scene &scene_;
  std::map<std::string_view, scene::Handle<scene::Texture>> textures_;
};

}  // namespace gnomon::gltf
