// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>

/** The texture slots of materials. Internal to source/gltf. */
namespace gnomon::gltf {

struct SlotName {
  std::string_view name;
  Model::TextureSlot Model::Material::*source;
  scene::TextureSlot scene::Material::*target;
  /** The texel of the image that replaces a missing or damaged one, and a description of its appearance. */
  std::array<std::uint8_t, 4> stand_in;
  std::string_view stand_in_name;
};

/** In the order of scene::texture_inputs. */
inline constexpr std::array<SlotName, 15> slot_names = {{
    {"baseColorTexture",
     &Model::Material::base_color_texture,
     &scene::Material::base_color_texture,
     {255, 0, 255, 255},
     "a checkerboard"},
    {"metallicRoughnessTexture",
     &Model::Material::metallic_roughness_texture,
     &scene::Material::metallic_roughness_texture,
     {255, 255, 0, 255},
     "no metal, of the factor's roughness"},
    {"normalTexture",
     &Model::Material::normal_texture,
     &scene::Material::normal_texture,
     {128, 128, 255, 255},
     "a flat surface"},
    {"occlusionTexture",
     &Model::Material::occlusion_texture,
     &scene::Material::occlusion_texture,
     {255, 255, 255, 255},
     "no occlusion"},
    {"emissiveTexture",
     &Model::Material::emissive_texture,
     &scene::Material::emissive_texture,
     {0, 0, 0, 255},
     "no emission"},
    {"specularTexture",
     &Model::Material::specular_texture,
     &scene::Material::specular_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"specularColorTexture",
     &Model::Material::specular_color_texture,
     &scene::Material::specular_color_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"clearcoatTexture",
     &Model::Material::coat_texture,
     &scene::Material::coat_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"clearcoatRoughnessTexture",
     &Model::Material::coat_roughness_texture,
     &scene::Material::coat_roughness_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"sheenColorTexture",
     &Model::Material::sheen_color_texture,
     &scene::Material::sheen_color_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"sheenRoughnessTexture",
     &Model::Material::sheen_roughness_texture,
     &scene::Material::sheen_roughness_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"anisotropyTexture",
     &Model::Material::anisotropy_texture,
     &scene::Material::anisotropy_texture,
     {255, 128, 255, 255},
     "the factor alone"},
    {"clearcoatNormalTexture",
     &Model::Material::coat_normal_texture,
     &scene::Material::coat_normal_texture,
     {128, 128, 255, 255},
     "a coat as smooth as the mesh"},
    {"transmissionTexture",
     &Model::Material::transmission_texture,
     &scene::Material::transmission_texture,
     {255, 255, 255, 255},
     "the factor alone"},
    {"thicknessTexture",
     &Model::Material::thickness_texture,
     &scene::Material::thickness_texture,
     {255, 255, 255, 255},
     "the factor alone"},
}};

/** Place of a slot in a material of glTF, with '/' between keys. */
[[nodiscard]] inline std::string path_of(const SlotName &slot)
{
  constexpr std::array<std::array<std::string_view, 2>, 9> places{
      {{"baseColor", "pbrMetallicRoughness/"},
       {"metallicRoughness", "pbrMetallicRoughness/"},
       {"specular", "extensions/KHR_materials_specular/"},
       {"clearcoat", "extensions/KHR_materials_clearcoat/"},
       {"sheen", "extensions/KHR_materials_sheen/"},
       {"anisotropy", "extensions/KHR_materials_anisotropy/"},
       {"transmission", "extensions/KHR_materials_transmission/"},
       {"thickness", "extensions/KHR_materials_volume/"},
       {"", ""}}};
  const auto *const place =
      std::ranges::find_if(places, [&](const auto &one) { return slot.name.starts_with(one[0]); });
  return std::string((*place)[1]) + std::string(slot.name);
}

/** Textures that replace missing or damaged ones, one for each slot that needs it. */
class StandIns {
 public:
  explicit StandIns(scene::Scene &scene) : scene_(scene) {}

  [[nodiscard]] scene::Handle<scene::Texture> texture_of(const SlotName &slot)
  {
    scene::Handle<scene::Texture> &texture = textures_[slot.name];
    if (!texture) {
      // Only a base colour is a checkerboard, so that the stand-in is visible as such.
      const std::array<std::uint8_t, 4> other = slot.target == &scene::Material::base_color_texture
                                                    ? std::array<std::uint8_t, 4>{0, 0, 0, 255}
                                                    : slot.stand_in;
      scene::Image image{"stand-in for " + std::string(slot.name), 2, 2, {}};
      for (const auto &texel : {slot.stand_in, other, other, slot.stand_in}) {
        image.texels.insert(image.texels.end(), texel.begin(), texel.end());
      }
      scene::Texture value{.image = scene_.add(std::move(image))};
      value.magnified = value.minified = scene::TextureFilter::Nearest;
      value.mip = scene::MipFilter::Linear;
      texture = scene_.add(value);
    }
    return texture;
  }

  /** Warns that \a slot of \a material has a stand-in, and notes the limit that is the reason. */
  void warn(const std::string &material, const SlotName &slot, const Fault &fault, Warnings &warnings)
  {
    const std::string reason =
        "its " + std::string(slot.name) + " is drawn as " + std::string(slot.stand_in_name) + ": " + fault.what();
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
