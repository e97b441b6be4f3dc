// SPDX-License-Identifier: MIT
#include "internal/gltf_material.hh"

#include "internal/gltf_pointer.hh"
#include "internal/gltf_units.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>

namespace gnomon::gltf {

using scene::AlphaMode;
using scene::Handle;
using scene::Material;
using scene::Scene;
using scene::TextureSlot;

namespace {

/** Number of uv sets of a mesh. \see scene::TextureSlot::uv_set */
constexpr std::size_t uv_sets_max = 2;

/** Reads one material; every message names it. */
class MaterialReader {
 public:
  /** \a moved: paths of the material that animations move. All references must outlive the reader. */
  MaterialReader(const Model::Material &source, std::size_t index, const std::set<std::string_view> &moved,
                 TextureImporter &textures, StandIns &stand_ins, Warnings &warnings)
      : source_(source),
        moved_(moved),
        what_(label("material", source.name, index)),
        textures_(textures),
        stand_ins_(stand_ins),
        warnings_(warnings)
  {
    result_.name = source.name.empty() ? "material " + std::to_string(index) : source.name;
  }

  Material read()
  {
    read_factors();
    read_alpha();
    read_specular_color();
    read_transmission();
    read_emissive();
    read_textures();
    return result_;
  }

  [[nodiscard]] const std::vector<int> &uv_sets() const
  {
    return uv_sets_;
  }
  /** Whether the material is anisotropic at any time. */
  [[nodiscard]] bool is_ever_anisotropic() const
  {
    return moving_.has_anisotropy();
  }

 private:
  const Model::Material &source_;
  const std::set<std::string_view> &moved_;
  std::string what_;
  TextureImporter &textures_;
  StandIns &stand_ins_;
  Warnings &warnings_;
  Material result_;
  /** The emissive factor of the file, before its strength multiplies it. */
  glm::vec3 emissive_factor_{0.0F};
  /** A copy of `result_` with 0.5 for each factor that moves. It decides which textures have an effect at some time. */
  Material moving_;
  std::vector<int> uv_sets_;

  /** \a value within the limits of \a row. \a name: in the file, for a warning. */
  float clamped(const scene::Description &row, std::string_view name, double value)
  {
    const float result = row.nearest(value);
    if (!row.allows(value)) {
      warnings_.add(what_, std::string(name) + " is " + text(value) + ", clamped to " + text(result));
    }
    return result;
  }

  /** Name of a factor in messages: its key, and for the factor of a texture that of the slot, "normalTexture.scale". */
  static std::string name_of(std::string_view path)
  {
    const std::size_t last = path.rfind('/');
    const std::string_view outer = path.substr(0, last == path.npos ? 0 : last);
    const auto *const slot = std::ranges::find(scene::texture_inputs, outer, &scene::TextureInput::path);
    const std::string key(path.substr(last + 1));
    return slot == scene::texture_inputs.end() ? key : std::string(slot->key()) + '.' + key;
  }

  /** The factors that mean in the file what they mean in the scene. */
  void read_factors()
  {
    Material::for_each_property([&](const auto &row) {
      using Value = typename std::decay_t<decltype(row)>::Value;
      const std::array<double, 4> *const numbers = source_.factor(row.name);
      const bool is_converted = row.name == "ior" || row.name == "attenuation_distance" || row.name == "emissive";
      if (numbers == nullptr || is_converted) {
        return;
      }
      if constexpr (std::is_same_v<Value, bool>) {
        result_.*row.member = (*numbers)[0] != 0.0;
      }
      else if constexpr (std::is_same_v<Value, float>) {
        result_.*row.member = clamped(row, name_of(row.path), (*numbers)[0]);
      }
      else if constexpr (std::is_same_v<Value, glm::vec3>) {
        for (int i = 0; i < 3; i++) {
          (result_.*row.member)[i] = clamped(row, name_of(row.path), (*numbers)[std::size_t(i)]);
        }
      }
    });
  }

  void read_specular_color()
  {
    const std::array<double, 4> *const source = source_.factor("ior");
    if (source == nullptr) {
      return;
    }
    const double ior = valid_ior((*source)[0]);
    if (ior != (*source)[0]) {
      warnings_.add(what_, "ior is " + text((*source)[0]) + ", clamped to " + text(ior));
    }
    // The exporter divides by the same float, so that the tint is exactly the file's again. A tint beyond the limit
    // reflects all light, as the limit does.
    const scene::Description row = scene::description_of<Material>("specular_color");
    const float ratio = reflectance_ratio(static_cast<float>(ior));
    for (int i = 0; i < 3; i++) {
      result_.specular_color[i] = row.nearest(result_.specular_color[i] * ratio);
    }
    // A surface that reflects all light refracts none.
    result_.ior = ior == 0.0 ? result_.ior : static_cast<float>(ior);
  }

  void read_transmission()
  {
    if (source_.own_thickness) {
      const scene::Description thickness = scene::description_of<Material>("thickness");
      result_.thickness = clamped(thickness, "gnomon_thickness", *source_.own_thickness);
    }
    const std::array<double, 4> *const source = source_.factor("attenuation_distance");
    if (source == nullptr) {
      return;
    }
    const double distance = (*source)[0];
    if (distance > 0.0) {
      // A distance of 0 would mean that nothing is absorbed, therefore the minimum limits it. Exporters write the
      // largest number if nothing is absorbed, therefore a number beyond the maximum needs no warning.
      const scene::Description row = scene::description_of<Material>("attenuation_distance");
      result_.attenuation_distance = static_cast<float>(std::clamp(distance, row.min, row.max));
    }
    else {
      warnings_.add(what_, "attenuationDistance is " + text(distance) + ", not above 0; nothing is absorbed");
    }
  }

  void find_moving()
  {
    moving_ = result_;
    Material::for_each_property([&](const auto &row) {
      using Value = typename std::decay_t<decltype(row)>::Value;
      if constexpr (std::is_same_v<Value, float> || std::is_same_v<Value, glm::vec3>) {
        if (row.is_animated && moved_.contains(row.path)) {
          moving_.*row.member = Value(0.5F);
        }
      }
    });
    if (moved_.contains(strength_path)) {
      moving_.emissive = glm::max(moving_.emissive, emissive_factor_);
    }
  }

  /** Whether the material's factors let the texture have an effect at some time. Other textures are not decoded. */
  [[nodiscard]] bool is_read(const scene::TextureInput &input) const
  {
    const auto is_one_of = [&](auto... slots) { return ((input.slot == slots) || ...); };
    if (is_one_of(&Material::coat_texture, &Material::coat_roughness_texture, &Material::coat_normal_texture)) {
      return moving_.coat > 0.0F;
    }
    if (is_one_of(&Material::sheen_color_texture, &Material::sheen_roughness_texture)) {
      return moving_.sheen_color != glm::vec3(0.0F);
    }
    if (is_one_of(&Material::anisotropy_texture)) {
      return moving_.anisotropy > 0.0F;
    }
    if (is_one_of(&Material::transmission_texture)) {
      return moving_.transmission > 0.0F;
    }
    if (is_one_of(&Material::thickness_texture)) {
      return moving_.transmission > 0.0F && moving_.thickness > 0.0F;
    }
    return true;
  }

  void read_emissive()
  {
    const scene::Description row = scene::description_of<Material>("emissive");
    scene::Description factor_row = row;
    factor_row.max = 1.0;
    if (const std::array<double, 4> *const source = source_.factor("emissive")) {
      for (int i = 0; i < 3; i++) {
        emissive_factor_[i] = clamped(factor_row, "emissiveFactor", (*source)[std::size_t(i)]);
      }
    }
    // The limit is that of the product.
    const double largest = std::max({emissive_factor_.r, emissive_factor_.g, emissive_factor_.b});
    double strength = std::max(0.0, source_.emissive_strength);
    if (!row.allows((largest > 0.0 ? largest : 1.0) * strength)) {
      strength = row.max / (largest > 0.0 ? largest : 1.0);
    }
    if (strength != source_.emissive_strength) {
      warnings_.add(what_, "emissiveStrength is " + text(source_.emissive_strength) + ", clamped to " + text(strength));
    }
    const double factor = float(std::min(strength, scene::float_max));
    for (int i = 0; i < 3; i++) {
      result_.emissive[i] = row.nearest(factor * double(emissive_factor_[i]));
    }
  }

  void read_alpha()
  {
    if (const std::array<double, 4> *const base_color = source_.factor("base_color")) {
      result_.alpha = clamped(scene::description_of<Material>("alpha"), "baseColorFactor", (*base_color)[3]);
    }
    if (source_.alpha_mode == "MASK") {
      result_.alpha_mode = AlphaMode::Mask;
    }
    else if (source_.alpha_mode == "BLEND") {
      result_.alpha_mode = AlphaMode::Blend;
    }
    else if (source_.alpha_mode != "OPAQUE") {
      warnings_.add(what_, "alphaMode '" + printable(source_.alpha_mode) + "' is unknown, taken for OPAQUE");
    }
  }

  void read_textures()
  {
    find_moving();
    choose_uv_sets();
    for (const scene::TextureInput &input : scene::texture_inputs) {
      const Model::TextureSlot *const slot = source_.texture(input.name);
      if (slot != nullptr && is_read(input)) {
        result_.*input.slot = read_slot(input, *slot);
      }
    }
  }

  /**
   * The sets of the textures that are read: those of the lowest ranks if there are more than a mesh has. A texture
   * without an effect comes after the others.
   */
  void choose_uv_sets()
  {
    const auto add = [&](int set) {
      if (uv_sets_.size() < uv_sets_max && std::ranges::find(uv_sets_, set) == uv_sets_.end()) {
        uv_sets_.push_back(set);
      }
    };
    std::array inputs = scene::texture_inputs;
    std::ranges::sort(inputs, {}, &scene::TextureInput::rank);
    for (const bool has_effect : {true, false}) {
      for (const scene::TextureInput &input : inputs) {
        const Model::TextureSlot *const slot = source_.texture(input.name);
        if (slot != nullptr && is_read(input) && this->has_effect(input) == has_effect) {
          add(slot->set);
        }
      }
    }
    // A surface function may read both sets.
    for (int set = 0; !source_.surface_uri.empty() && set < int(uv_sets_max); set++) {
      add(set);
    }
    std::ranges::sort(uv_sets_);
  }

  /** Whether the texture may change a pixel. */
  [[nodiscard]] bool has_effect(const scene::TextureInput &input) const
  {
    if (!source_.surface_uri.empty()) {
      return true;
    }
    if (input.slot == &Material::emissive_texture) {
      return moving_.emissive != glm::vec3(0.0F) && !result_.is_unlit;
    }
    if (input.slot == &Material::normal_texture) {
      return moving_.normal_scale != 0.0F && !result_.is_unlit;
    }
    if (input.slot == &Material::occlusion_texture) {
      return moving_.occlusion_strength > 0.0F && !result_.is_unlit;
    }
    if (input.slot == &Material::specular_texture || input.slot == &Material::specular_color_texture) {
      return moving_.specular > 0.0F && moving_.metallic < 1.0F && !result_.is_unlit;
    }
    return input.slot == &Material::base_color_texture || !result_.is_unlit;
  }

  TextureSlot read_slot(const scene::TextureInput &input, const Model::TextureSlot &slot)
  {
    TextureSlot result;
    try {
      const auto set = std::find(uv_sets_.begin(), uv_sets_.end(), slot.set);
      if (set == uv_sets_.end()) {
        throw LimitFault("texCoord", std::to_string(slot.set) +
                                         " is a third set of texture coordinates, and two of more "
                                         "important textures are kept");
      }
      result.uv_set = static_cast<int>(set - uv_sets_.begin());
      const bool is_glossiness = source_.glossiness && input.slot == &Material::metallic_roughness_texture;
      result.texture =
          is_glossiness ? textures_.roughness_of(slot.index, *source_.glossiness) : textures_.handle_of(slot.index);
      // The derived image contains the factor.
      result_.roughness = is_glossiness ? 1.0F : result_.roughness;
    }
    catch (const Fault &fault) {
      result.texture = stand_ins_.texture_of(input);
      stand_ins_.warn(what_, input, fault, warnings_);
    }
    const auto limited = [&](std::string_view name, double value) {
      return clamped(scene::description_of<TextureSlot>(name), name, value);
    };
    result.offset = {limited("offset", slot.offset[0]), limited("offset", slot.offset[1])};
    result.rotation = limited("rotation", slot.rotation);
    result.scale = {limited("scale", slot.scale[0]), limited("scale", slot.scale[1])};
    return result;
  }
};

}  // namespace

MaterialImporter::MaterialImporter(const File &file, const ImportOptions &options, ForeignExtras &extras,
                                   Warnings &warnings, Scene &scene)
    : file_(file),
      extras_(extras),
      warnings_(warnings),
      scene_(scene),
      textures_(file, options, warnings, scene),
      stand_ins_(scene)
{
  for (const Model::Animation &animation : file.model.animations) {
    for (const Model::AnimationChannel &channel : animation.channels) {
      const std::optional<PointerParts> parts = parts_of(channel.pointer);
      if (parts && parts->collection == "materials") {
        moved_[parts->index].insert(parts->path);
      }
    }
  }
}

Handle<Material> MaterialImporter::handle_of(int gltf_material)
{
  const auto [place, is_new] = handle_of_.try_emplace(gltf_material);
  if (is_new && gltf_material < 0) {
    place->second = scene_.add(Material{.name = "default"});
    uv_sets_.try_emplace(place->second);
  }
  else if (is_new) {
    const Model::Material &source = file_.model.materials[gltf_material];
    MaterialReader reader(source, static_cast<std::size_t>(gltf_material), moved_[gltf_material], textures_, stand_ins_,
                          warnings_);
    Material material = reader.read();
    material.extras = extras_.of("materials", gltf_material);
    if (!source.surface_uri.empty()) {
      material.surface_function =
          surface_function(source.surface_uri, label("material", source.name, static_cast<std::size_t>(gltf_material)));
    }
    place->second = scene_.add(std::move(material));
    if (source.glossiness) {
      factor_roughness_.emplace(place->second, float(1.0 - std::clamp(*source.glossiness, 0.0, 1.0)));
    }
    uv_sets_.emplace(place->second, reader.uv_sets());
    if (reader.is_ever_anisotropic()) {
      anisotropic_.insert(place->second);
    }
  }
  return place->second;
}

Handle<Material> MaterialImporter::handle_for_lines(int gltf_material, bool has_normals, bool has_tangents)
{
  const Handle<Material> of_triangles = handle_of(gltf_material);
  const Material &source = scene_.materials()[of_triangles];
  const bool has_frame = has_tangents || !source.has_frame();
  if (source.is_unlit || (has_normals && has_frame)) {
    return of_triangles;
  }
  const auto [place, is_new] = handle_for_lines_.try_emplace({gltf_material, has_normals, has_tangents});
  if (!is_new) {
    return place->second;
  }
  Material material = source;
  material.extras = extras_.of("materials", gltf_material);
  if (!has_normals) {
    const glm::vec3 sum = material.base_color + material.emissive;
    const bool has_sum = !material.base_color_texture && !material.emissive_texture && sum == glm::min(sum, 1.0F);
    if (!has_sum && material.emissive != glm::vec3(0.0F)) {
      warnings_.add("material '" + printable(material.name) + '\'', "its points and lines without normals do not emit");
    }
    material.base_color = has_sum ? sum : material.base_color;
    material.is_unlit = true;
  }
  material.normal_texture = material.coat_normal_texture = {};
  material.anisotropy = 0.0F;
  place->second = scene_.add(std::move(material));
  uv_sets_.emplace(place->second, uv_sets_.at(of_triangles));
  if (const auto found = factor_roughness_.find(of_triangles); found != factor_roughness_.end()) {
    factor_roughness_.emplace(place->second, found->second);
  }
  return place->second;
}

Handle<scene::SurfaceFunction> MaterialImporter::surface_function(const std::string &uri, const std::string &what)
{
  const auto [place, is_new] = surface_functions_.try_emplace(uri);
  if (!is_new) {
    return place->second;
  }
  scene::SurfaceFunction function{.name = is_data_uri(uri) ? "surface of " + what : uri};
  try {
    const std::vector<unsigned char> bytes =
        bytes_of_uri(file_.base, "surface function", uri, scene::SurfaceFunction::text_bytes_max);
    function.text.assign(bytes.begin(), bytes.end());
    function.path = is_data_uri(uri) ? std::string() : path_of_uri(file_.base, "surface function", uri).string();
    place->second = scene_.add(std::move(function));
  }
  catch (const std::exception &error) {
    warnings_.add(what, printable(error.what()) + "; magenta is drawn instead");
    place->second = scene_.add(scene::SurfaceFunction{.name = "surface of " + what});
  }
  return place->second;
}

void MaterialImporter::finish(Progress &progress)
{
  const std::map<Handle<scene::Image>, Fault> damaged = textures_.decode(progress);
  if (damaged.empty()) {
    return;
  }
  for (const auto &[handle, material] : scene_.materials()) {
    Material changed = material;
    for (const scene::TextureInput &input : scene::texture_inputs) {
      TextureSlot &slot = changed.*input.slot;
      const scene::Texture *texture = scene_.textures().find(slot.texture);
      const auto found = texture != nullptr ? damaged.find(texture->image) : damaged.end();
      if (found != damaged.end()) {
        slot.texture = stand_ins_.texture_of(input);
        const auto factor = factor_roughness_.find(handle);
        if (input.slot == &Material::metallic_roughness_texture && factor != factor_roughness_.end()) {
          changed.roughness = factor->second;
        }
        stand_ins_.warn("material '" + printable(material.name) + '\'', input, found->second, warnings_);
      }
    }
    scene_.replace(handle, std::move(changed));
  }
  std::vector<Handle<scene::Texture>> unused;
  for (const auto &[handle, texture] : scene_.textures()) {
    if (damaged.count(texture.image) > 0) {
      unused.push_back(handle);
    }
  }
  for (const Handle<scene::Texture> handle : unused) {
    scene_.remove(handle);
  }
  for (const auto &[handle, fault] : damaged) {
    scene_.remove(handle);
  }
}

}  // namespace gnomon::gltf
