// SPDX-License-Identifier: MIT
#include "internal/gltf_material.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace gnomon::gltf {

using scene::AlphaMode;
using scene::Handle;
using scene::Material;
using scene::Scene;

namespace {

/** Reads one material; every message names it. */
class MaterialReader {
 public:
  MaterialReader(const Model::Material &source, std::size_t index, TextureImporter &textures, Warnings &warnings)
      : source_(source), what_(label("material", source.name, index)), textures_(textures), warnings_(warnings)
  {
    result_.name = source.name.empty() ? "material " + std::to_string(index) : source.name;
  }

  Material read()
  {
    read_metallic_roughness();
    read_specular();
    read_emissive();
    read_alpha();
    read_base_color_texture();
    result_.is_double_sided = source_.is_double_sided;
    warn_textures();
    warn_extensions();
    return result_;
  }

  [[nodiscard]] const TextureCoordinates &texture_coordinates() const
  {
    return texture_coordinates_;
  }

 private:
  const Model::Material &source_;
  std::string what_;
  TextureImporter &textures_;
  Warnings &warnings_;
  Material result_;
  TextureCoordinates texture_coordinates_;

  template <std::size_t Count>
  static glm::dvec3 vec3(const std::array<double, Count> &values)
  {
    return {values[0], values[1], values[2]};
  }

  float clamped(const char *factor, double value, double max)
  {
    const double result = std::clamp(value, 0.0, max);
    if (result != value) {
      warnings_.add(what_, std::string(factor) + " is " + text(value) + ", clamped to " + text(result));
    }
    return static_cast<float>(result);
  }

  glm::vec3 clamped(const char *factor, const glm::dvec3 &value, double max)
  {
    return {clamped(factor, value[0], max), clamped(factor, value[1], max), clamped(factor, value[2], max)};
  }

  void read_metallic_roughness()
  {
    result_.base_color = clamped("baseColorFactor", vec3(source_.base_color), 1.0);
    result_.alpha = clamped("baseColorFactor", source_.base_color[3], 1.0);
    result_.metallic = clamped("metallicFactor", source_.metallic, 1.0);
    result_.roughness = clamped("roughnessFactor", source_.roughness, 1.0);
  }

  void read_specular()
  {
    result_.specular = clamped("specularFactor", source_.specular, 1.0);
    result_.specular_color = clamped("specularColorFactor", vec3(source_.specular_color), large);
    if (source_.ior) {
      result_.specular_color *= reflectance_ratio(*source_.ior);
    }
  }

  /**
   * An index of refraction other than 1.5 scales the reflection at normal incidence, exactly as the specular colour
   * does, so it is folded into that. 0 stands for full reflection at every angle.
   */
  float reflectance_ratio(double ior)
  {
    if (ior != 0.0 && ior < 1.0) {
      warnings_.add(what_, "ior is " + text(ior) + ", clamped to 1");
      ior = 1.0;
    }
    constexpr double default_reflectance = 0.04;
    const double root = (ior - 1.0) / (ior + 1.0);
    return static_cast<float>(root * root / default_reflectance);
  }

  void read_emissive()
  {
    const float strength = clamped("emissiveStrength", source_.emissive_strength, large);
    result_.emissive = clamped("emissiveFactor", vec3(source_.emissive), 1.0) * strength;
  }

  void read_alpha()
  {
    result_.alpha_cutoff = clamped("alphaCutoff", source_.alpha_cutoff, 1.0);
    if (source_.alpha_mode == "MASK") {
      result_.alpha_mode = AlphaMode::Mask;
    }
    else if (source_.alpha_mode == "BLEND") {
      result_.alpha_mode = AlphaMode::Blend;
    }
    else if (source_.alpha_mode != "OPAQUE") {
      warnings_.add(what_, "alphaMode '" + printable(source_.alpha_mode) + "' is unknown, taken for OPAQUE");
    }
    if (result_.alpha_mode == AlphaMode::Blend) {
      warnings_.add(what_, "alphaMode " + source_.alpha_mode + " is drawn opaque for now");
    }
  }

  void read_base_color_texture()
  {
    const Model::TextureSlot &slot = source_.base_color_texture;
    if (slot.index < 0) {
      return;
    }
    texture_coordinates_ = {slot.set, {slot.offset[0], slot.offset[1]}, slot.rotation, {slot.scale[0], slot.scale[1]}};
    try {
      result_.base_color_texture = textures_.handle_of(slot.index);
    }
    catch (const Fault &fault) {
      warnings_.add(what_, std::string("its baseColorFactor is drawn without a texture: ") + fault.what());
    }
  }

  void warn_textures()
  {
    std::string slots;
    const auto add_slot = [&slots](bool is_used, const char *name) {
      if (is_used) {
        slots += slots.empty() ? name : std::string(", ") + name;
      }
    };
    add_slot(source_.has_metallic_roughness_texture, "metallicRoughnessTexture");
    add_slot(source_.has_normal_texture, "normalTexture");
    add_slot(source_.has_occlusion_texture, "occlusionTexture");
    add_slot(source_.has_emissive_texture, "emissiveTexture");
    add_slot(source_.has_specular_texture, "specularTexture");
    add_slot(source_.has_specular_color_texture, "specularColorTexture");
    if (!slots.empty()) {
      const bool is_one = slots.find(',') == slots.npos;
      warnings_.add(what_, slots + (is_one ? " is" : " are") + " not drawn yet");
    }
  }

  void warn_extensions()
  {
    constexpr std::array read_or_without_effect{"KHR_materials_specular", "KHR_materials_emissive_strength",
                                                "KHR_materials_ior", "KHR_materials_variants"};
    for (const std::string &name : source_.extensions) {
      if (std::find(read_or_without_effect.begin(), read_or_without_effect.end(), name) ==
          read_or_without_effect.end()) {
        warnings_.add(what_, printable(name) + " is not drawn");
      }
    }
  }

  /** For what has no upper limit: products of a few such numbers stay finite in float. */
  static constexpr double large = 1e9;
};

}  // namespace

glm::vec2 TextureCoordinates::transformed(const glm::vec2 &uv) const
{
  const glm::dvec2 scaled = scale * glm::dvec2(uv);
  const double sine = std::sin(rotation);
  const double cosine = std::cos(rotation);
  // v runs down the image, which turns the sense of the angle.
  return glm::vec2(offset + glm::dvec2(cosine * scaled.x + sine * scaled.y, cosine * scaled.y - sine * scaled.x));
}

MaterialImporter::MaterialImporter(const File &file, Warnings &warnings, Scene &scene)
    : file_(file), warnings_(warnings), scene_(scene), textures_(file, warnings, scene)
{
}

Handle<Material> MaterialImporter::handle_of(int gltf_material)
{
  const auto [place, is_new] = handle_of_.try_emplace(gltf_material);
  if (is_new && gltf_material < 0) {
    place->second = scene_.add(Material{.name = "default"});
    texture_coordinates_.try_emplace(place->second);
  }
  else if (is_new) {
    const Model::Material &source = file_.model.materials[gltf_material];
    MaterialReader reader(source, static_cast<std::size_t>(gltf_material), textures_, warnings_);
    place->second = scene_.add(reader.read());
    texture_coordinates_.emplace(place->second, reader.texture_coordinates());
  }
  return place->second;
}

}  // namespace gnomon::gltf
