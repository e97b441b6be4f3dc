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
  MaterialReader(const tinygltf::Material &source, std::size_t index, TextureImporter &textures, Warnings &warnings)
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
    result_.is_double_sided = source_.doubleSided;
    warn_textures();
    warn_extensions();
    return result_;
  }

  [[nodiscard]] const TextureCoordinates &texture_coordinates() const
  {
    return texture_coordinates_;
  }

 private:
  const tinygltf::Material &source_;
  std::string what_;
  TextureImporter &textures_;
  Warnings &warnings_;
  Material result_;
  TextureCoordinates texture_coordinates_;

  float clamped(const char *factor, double value, double max)
  {
    const double result = std::clamp(value, 0.0, max);
    if (result != value) {
      warnings_.add(what_, std::string(factor) + " is " + text(value) + ", clamped to " + text(result));
    }
    return static_cast<float>(result);
  }

  glm::vec3 clamped(const char *factor, const std::vector<double> &value, double max)
  {
    return {clamped(factor, value[0], max), clamped(factor, value[1], max), clamped(factor, value[2], max)};
  }

  /** nullptr when the material does not have it. */
  const tinygltf::Value *extension(const char *name) const
  {
    const auto found = source_.extensions.find(name);
    return found == source_.extensions.end() ? nullptr : &found->second;
  }

  static double number(const tinygltf::Value &object, const char *key, double fallback)
  {
    return object.Has(key) ? object.Get(key).GetNumberAsDouble() : fallback;
  }

  void read_metallic_roughness()
  {
    const tinygltf::PbrMetallicRoughness &roughness = source_.pbrMetallicRoughness;
    result_.base_color = clamped("baseColorFactor", roughness.baseColorFactor, 1.0);
    result_.alpha = clamped("baseColorFactor", roughness.baseColorFactor[3], 1.0);
    result_.metallic = clamped("metallicFactor", roughness.metallicFactor, 1.0);
    result_.roughness = clamped("roughnessFactor", roughness.roughnessFactor, 1.0);
  }

  void read_specular()
  {
    if (const tinygltf::Value *specular = extension("KHR_materials_specular")) {
      result_.specular = clamped("specularFactor", number(*specular, "specularFactor", 1.0), 1.0);
      if (specular->Has("specularColorFactor")) {
        const tinygltf::Value &color = specular->Get("specularColorFactor");
        const std::vector<double> values{color.Get(0).GetNumberAsDouble(), color.Get(1).GetNumberAsDouble(),
                                         color.Get(2).GetNumberAsDouble()};
        result_.specular_color = clamped("specularColorFactor", values, large);
      }
    }
    if (const tinygltf::Value *refraction = extension("KHR_materials_ior")) {
      result_.specular_color *= reflectance_ratio(number(*refraction, "ior", 1.5));
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
    double strength = 1.0;
    if (const tinygltf::Value *emissive = extension("KHR_materials_emissive_strength")) {
      strength = clamped("emissiveStrength", number(*emissive, "emissiveStrength", 1.0), large);
    }
    result_.emissive = clamped("emissiveFactor", source_.emissiveFactor, 1.0) * static_cast<float>(strength);
  }

  void read_alpha()
  {
    result_.alpha_cutoff = clamped("alphaCutoff", source_.alphaCutoff, 1.0);
    if (source_.alphaMode == "MASK") {
      result_.alpha_mode = AlphaMode::Mask;
    }
    else if (source_.alphaMode == "BLEND") {
      result_.alpha_mode = AlphaMode::Blend;
    }
    else if (source_.alphaMode != "OPAQUE") {
      warnings_.add(what_, "alphaMode '" + printable(source_.alphaMode) + "' is unknown, taken for OPAQUE");
    }
    if (result_.alpha_mode == AlphaMode::Blend) {
      warnings_.add(what_, "alphaMode " + source_.alphaMode + " is drawn opaque for now");
    }
  }

  void read_base_color_texture()
  {
    const tinygltf::TextureInfo &slot = source_.pbrMetallicRoughness.baseColorTexture;
    if (slot.index < 0) {
      return;
    }
    try {
      texture_coordinates_.set = slot.texCoord;
      if (const auto found = slot.extensions.find("KHR_texture_transform"); found != slot.extensions.end()) {
        read_texture_transform(found->second);
      }
      result_.base_color_texture = textures_.handle_of(slot.index);
    }
    catch (const Fault &fault) {
      warnings_.add(what_, std::string("its baseColorFactor is drawn without a texture: ") + fault.what());
    }
  }

  void read_texture_transform(const tinygltf::Value &transform)
  {
    const auto vec2 = [&transform](const char *key, const glm::dvec2 &fallback) {
      return transform.Has(key) ? glm::dvec2(transform.Get(key).Get(0).GetNumberAsDouble(),
                                             transform.Get(key).Get(1).GetNumberAsDouble())
                                : fallback;
    };
    texture_coordinates_.set = static_cast<int>(number(transform, "texCoord", texture_coordinates_.set));
    texture_coordinates_.offset = vec2("offset", glm::dvec2(0.0));
    texture_coordinates_.rotation = number(transform, "rotation", 0.0);
    texture_coordinates_.scale = vec2("scale", glm::dvec2(1.0));
  }

  void warn_textures()
  {
    std::string slots;
    const auto add_slot = [&slots](bool is_used, const char *name) {
      if (is_used) {
        slots += slots.empty() ? name : std::string(", ") + name;
      }
    };
    add_slot(source_.pbrMetallicRoughness.metallicRoughnessTexture.index >= 0, "metallicRoughnessTexture");
    add_slot(source_.normalTexture.index >= 0, "normalTexture");
    add_slot(source_.occlusionTexture.index >= 0, "occlusionTexture");
    add_slot(source_.emissiveTexture.index >= 0, "emissiveTexture");
    if (const tinygltf::Value *specular = extension("KHR_materials_specular")) {
      add_slot(specular->Has("specularTexture"), "specularTexture");
      add_slot(specular->Has("specularColorTexture"), "specularColorTexture");
    }
    if (!slots.empty()) {
      const bool is_one = slots.find(',') == slots.npos;
      warnings_.add(what_, slots + (is_one ? " is" : " are") + " not drawn yet");
    }
  }

  void warn_extensions()
  {
    constexpr std::array read_or_without_effect{"KHR_materials_specular", "KHR_materials_emissive_strength",
                                                "KHR_materials_ior", "KHR_materials_variants"};
    for (const auto &[name, content] : source_.extensions) {
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
    const tinygltf::Material &source = file_.model.materials[gltf_material];
    MaterialReader reader(source, static_cast<std::size_t>(gltf_material), textures_, warnings_);
    place->second = scene_.add(reader.read());
    texture_coordinates_.emplace(place->second, reader.texture_coordinates());
  }
  return place->second;
}

}  // namespace gnomon::gltf
