// SPDX-License-Identifier: MIT
#include "internal/verify_contract.hh"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::verify {

namespace {

bool is_finite(const glm::vec3 &v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/** Collects the faults of the elements. */
class Checker {
 public:
  std::vector<std::string> faults;

  void element(std::string what)
  {
    what_ = std::move(what);
  }
  void check(bool is_right, const char *promise)
  {
    if (!is_right) {
      faults.push_back(fmt::format("{}: not {}", what_, promise));
    }
  }
  /** Also finite in float, which engines use. */
  void check_affine(const glm::dmat4 &matrix)
  {
    bool is_affine = true;
    for (int column = 0; column < 4; column++) {
      is_affine = is_affine && is_finite(glm::vec3(matrix[column])) && matrix[column][3] == (column == 3 ? 1.0 : 0.0);
    }
    check(is_affine, "a finite affine matrix");
  }
  /** A rigid, right-handed matrix. */
  void check_frame(const glm::dmat4 &matrix)
  {
    check_affine(matrix);
    const glm::dvec3 x(matrix[0]);
    const glm::dvec3 y(matrix[1]);
    const glm::dvec3 z(matrix[2]);
    constexpr double rounding = 1e-14;
    check(std::abs(glm::length(x) - 1.0) <= rounding && std::abs(glm::length(y) - 1.0) <= rounding &&
              glm::length(glm::cross(x, y) - z) <= rounding,
          "a right-handed orthonormal frame");
  }

 private:
  std::string what_;
};

void check_mesh(const scene::Scene &scene, const scene::Mesh &mesh, Checker &checker)
{
  checker.check(!mesh.material || scene.materials().is_live(mesh.material), "of a material that is there");
  checker.check(mesh.normals.size() == mesh.positions.size(), "with a normal a position");
  checker.check(!mesh.indices.empty() && mesh.indices.size() % index_count_of(mesh.topology) == 0,
                "of whole triangles, lines or points");
  checker.check(std::ranges::all_of(mesh.indices, [&](std::uint32_t i) { return i < mesh.positions.size(); }),
                "with indices in range");
  checker.check(!mesh.bounds.is_empty(), "with bounds");
  scene::for_each_stream(mesh, [&](const auto &stream) {
    checker.check(stream.size() == mesh.positions.size(), "with a value a position");
  });
  const scene::Material &material = scene.material_of(mesh);
  for (int set = 0; set < 2; set++) {
    const bool is_read = std::ranges::any_of(scene::texture_inputs, [&](const scene::TextureInput &input) {
      return (material.*input.slot) && (material.*input.slot).uv_set == set;
    });
    // A surface function may read both sets.
    checker.check(mesh.uv_set(set).empty() == !is_read || bool(material.surface_function),
                  "with texture coordinates just where its material looks a texture up");
    checker.check(std::ranges::all_of(mesh.uv_set(set),
                                      [](const glm::vec2 &uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); }),
                  "with finite texture coordinates");
  }
  checker.check(!mesh.tangents.empty() || !(material.normal_texture || material.coat_normal_texture),
                "with tangents for its normal textures");
  const bool may_turn_anisotropic = std::ranges::any_of(scene.animations, [&](const scene::Animation &animation) {
    return std::ranges::any_of(animation.values, [&](const scene::AnimatedValue &value) {
      return value.property == "anisotropy" && value.target == decltype(value.target)(mesh.material);
    });
  });
  checker.check(mesh.tangents.empty() || material.has_frame() || may_turn_anisotropic,
                "with tangents only where its material has a normal texture or anisotropy");
  checker.check(std::ranges::all_of(mesh.tangents,
                                    [](const glm::vec4 &t) {
                                      return std::abs(glm::length(glm::vec3(t)) - 1.0F) <= 1e-5F &&
                                             std::abs(t.w) == 1.0F;
                                    }),
                "with unit tangents");
  checker.check(std::ranges::all_of(mesh.positions,
                                    [&](const glm::vec3 &p) {
                                      return is_finite(p) && glm::min(mesh.bounds.min, p) == mesh.bounds.min &&
                                             glm::max(mesh.bounds.max, p) == mesh.bounds.max;
                                    }),
                "with finite positions within its bounds");
  checker.check(
      std::ranges::all_of(mesh.normals,
                          [](const glm::vec3 &n) { return is_finite(n) && std::abs(glm::length(n) - 1.0F) <= 1e-5F; }),
      "with unit normals");
}

/** The properties of \a part, which is \a thing or a part of it, are within their limits. */
template <typename Thing, typename Part>
void check_properties(const Thing &thing, const Part &part, Checker &checker)
{
  Part::for_each_property([&](const auto &row) {
    scene::for_each_number(part.*row.member, [&](double value) {
      const bool is_allowed = row.has_kind(scene::kind_of(thing)) ? row.allows(value) : std::isfinite(value);
      checker.check(is_allowed, fmt::format("of a {} {}", row.name, range_text(row)).c_str());
    });
  });
}

void check_material(const scene::Scene &scene, const scene::Material &material, Checker &checker)
{
  check_properties(material, material, checker);
  for (const scene::TextureInput &input : scene::texture_inputs) {
    const scene::TextureSlot &slot = material.*input.slot;
    checker.check(!slot || scene.textures().is_live(slot.texture), "of a texture that is there");
    check_properties(slot, slot, checker);
  }
}

void check_lamp(const scene::Lamp &lamp, Checker &checker)
{
  const scene::LampShadow &shadow = lamp.shadow;
  check_properties(lamp, lamp, checker);
  check_properties(lamp, shadow, checker);
  checker.check(!shadow.clip_start || !shadow.clip_end || *shadow.clip_end > *shadow.clip_start,
                "of a clip end beyond the start");
}

void check_camera(const scene::Camera &camera, Checker &checker)
{
  const bool is_perspective = camera.kind == scene::CameraKind::Perspective;
  check_properties(camera, camera, checker);
  checker.check(is_perspective ? camera.near > 0.0F : camera.near >= 0.0F, "of a near distance");
  checker.check(camera.far > camera.near || (is_perspective && camera.far == 0.0F),
                "of a far distance beyond the near one");
}

}  // namespace

std::vector<std::string> contract_faults(const scene::Scene &scene)
{
  Checker checker;
  for (const auto &[handle, mesh] : scene.meshes()) {
    checker.element("mesh '" + mesh.name + "'");
    check_mesh(scene, mesh, checker);
  }
  for (const auto &[handle, material] : scene.materials()) {
    checker.element("material '" + material.name + "'");
    check_material(scene, material, checker);
  }
  for (const auto &[handle, texture] : scene.textures()) {
    checker.element("texture");
    checker.check(scene.images().is_live(texture.image), "of an image that is there");
  }
  for (const auto &[handle, image] : scene.images()) {
    checker.element("image '" + image.name + "'");
    checker.check(image.width > 0 && image.height > 0, "of a size");
    checker.check(image.texels.size() == std::size_t(4) * image.width * image.height, "of as many texels");
  }
  for (const auto &[handle, node] : scene.nodes()) {
    checker.element("node '" + node.name + "'");
    checker.check_affine(scene.world_from_node(handle));
  }
  for (const auto &[handle, lamp] : scene.lamps()) {
    checker.element("lamp '" + lamp.name + "'");
    check_lamp(lamp, checker);
  }
  for (const auto &[handle, camera] : scene.cameras()) {
    checker.element("camera '" + camera.name + "'");
    check_camera(camera, checker);
  }
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  for (const scene::PlacedLamp &lamp : lamps) {
    checker.element("lamp '" + lamp.name + "'");
    checker.check_frame(lamp.world_from_lamp);
  }
  const std::vector<scene::PlacedCamera> cameras = scene.placed_cameras();
  for (const scene::PlacedCamera &camera : cameras) {
    checker.element("camera '" + camera.name + "'");
    checker.check_frame(camera.world_from_camera);
  }
  for (const std::string &line : scene.stale_references()) {
    checker.element(line);
    checker.check(false, "possible after an import");
  }
  checker.element("scene");
  checker.check(!scene.lamps().empty() || scene.world(), "with a lamp or a world");
  checker.check(!cameras.empty(), "with a camera");
  checker.check(scene.objects().empty() || std::isfinite(scene.bounds().radius()), "of finite bounds");
  for (const std::string &warning : scene.warnings) {
    checker.element("warning '" + warning + "'");
    checker.check(warning.find('\n') == warning.npos, "one line");
  }
  return checker.faults;
}

}  // namespace gnomon::verify
