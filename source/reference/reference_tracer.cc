// SPDX-License-Identifier: MIT
#include "reference_tracer.hh"

#include "internal/reference_texture.hh"
#include "internal/reference_triangle.hh"

#include <embree3/rtcore.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::reference {

namespace {

struct Triangle {
  /** World space, counter-clockwise from the front. */
  Corners corners;
  /** Largest error of the corners due to rounding, metres. */
  double error_m = 0.0;
  std::uint32_t object = 0;
  /** Indices in the mesh's positions. */
  std::array<std::uint32_t, 3> vertices{};
};

double largest(const glm::dvec3 &v)
{
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

bool is_finite(const glm::dvec3 &v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/**
 * Margin of the boxes in the tree. Coordinates in the tree are at most 1, and a ray in its box is at most 2·√3 long.
 * Rounding the origin and unit direction of such a ray to float moves its points by at most 2^-24 + 3.5 · 2^-25, and
 * the corner of a box by 2^-25. The sum is about an eighth of this margin.
 */
constexpr double tree_margin = 0x1p-20;

float rounded_up(double value)
{
  return std::nextafter(float(value), std::numeric_limits<float>::infinity());
}

float rounded_down(double value)
{
  return std::nextafter(float(value), -std::numeric_limits<float>::infinity());
}

}  // namespace

struct Tracer::Tree {
  const scene::Scene &scene;
  const std::vector<scene::Object> objects;
  const std::vector<scene::PlacedLamp> lamps;
  std::vector<Triangle> triangles;
  double largest_coordinate = 0.0;
  /** Coordinates in the tree are (world - center) · scale. Their bounding box is ±half_size. */
  glm::dvec3 center{0.0};
  double scale = 1.0;
  glm::dvec3 half_size{0.0};
  RTCDevice device = nullptr;
  RTCScene tree = nullptr;

  explicit Tree(const scene::Scene &scene_) : scene(scene_), objects(scene_.objects()), lamps(scene_.placed_lamps()) {}
  ~Tree()
  {
    if (tree != nullptr) {
      rtcReleaseScene(tree);
    }
    if (device != nullptr) {
      rtcReleaseDevice(device);
    }
  }
  Tree(const Tree &) = delete;
  Tree &operator=(const Tree &) = delete;

  void add_object(std::uint32_t index);
  void place();
  void build();
  [[noreturn]] void fail(const std::string &reason) const;

  [[nodiscard]] const scene::Mesh &mesh_of(const Triangle &triangle) const
  {
    return scene.meshes()[objects[triangle.object].mesh];
  }
  [[nodiscard]] const scene::Material &material_of(const Triangle &triangle) const
  {
    return scene.material_of(mesh_of(triangle));
  }
  [[nodiscard]] MeshPoint point_on(const Triangle &triangle, const glm::dvec3 &weights) const
  {
    return {scene, mesh_of(triangle), triangle.vertices, weights};
  }
  /** In [0, 1]. 0 if the material is masked and cut out at this point; between 0 and 1 only if it is blended. */
  [[nodiscard]] double opacity_at(const Triangle &triangle, const glm::dvec3 &weights) const;

  /** The part of a ray inside the tree's box, as an Embree ray. */
  struct Clipped {
    RTCRay ray{};
    /** Embree's t is (t - t_enter) · length. */
    double t_enter = 0.0;
    double length = 1.0;
  };
  /** Empty if the ray misses the box, or is not finite. */
  [[nodiscard]] std::optional<Clipped> clipped(const Ray &ray) const;
};

namespace {

/** Context that Embree passes to its callbacks. */
struct ClosestQuery : RTCIntersectContext {
  ShearedRay sheared;
  const Ray &ray;
  Faces faces;
  double t_enter;
  double length;
  std::optional<Hit> best;
};

struct BlockedQuery : RTCIntersectContext {
  ShearedRay sheared;
  const glm::dvec3 &point;
  double error_m;
  const LightPoint &light;
  double transmission = 1.0;
};

}  // namespace

void Tracer::Tree::fail(const std::string &reason) const
{
  throw std::runtime_error(fmt::format("{}: cannot build the ray tracing tree: {}", scene.path, reason));
}

double Tracer::Tree::opacity_at(const Triangle &triangle, const glm::dvec3 &weights) const
{
  const scene::Material &material = material_of(triangle);
  switch (material.alpha_mode) {
    case scene::AlphaMode::Mask:
      return point_on(triangle, weights).base_color().a >= double(material.alpha_cutoff) ? 1.0 : 0.0;
    case scene::AlphaMode::Blend: return std::clamp(point_on(triangle, weights).base_color().a, 0.0, 1.0);
    default: return 1.0;
  }
}

void Tracer::Tree::add_object(std::uint32_t index)
{
  const scene::Mesh &mesh = scene.meshes()[objects[index].mesh];
  const glm::dmat4 &world_from_object = objects[index].world_from_object;
  const bool is_mirrored = glm::determinant(glm::dmat3(world_from_object)) < 0.0;
  std::vector<glm::dvec3> positions;
  std::vector<double> errors;
  positions.reserve(mesh.positions.size());
  errors.reserve(mesh.positions.size());
  for (const glm::vec3 &position : mesh.positions) {
    const glm::dvec3 p(position);
    positions.emplace_back(world_from_object * glm::dvec4(p, 1.0));
    // Products of two floats are exact in double. Only the three sums are rounded, with terms of at most this
    // magnitude.
    const glm::dvec3 terms =
        glm::abs(glm::dvec3(world_from_object[0]) * p.x) + glm::abs(glm::dvec3(world_from_object[1]) * p.y) +
        glm::abs(glm::dvec3(world_from_object[2]) * p.z) + glm::abs(glm::dvec3(world_from_object[3]));
    // √3, because each axis has this error. Doubled for points between the corners.
    errors.push_back(2.0 * std::sqrt(3.0) * 3.0 * double_rounding * largest(terms));
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle triangle;
    triangle.object = index;
    triangle.vertices = {mesh.indices[i], mesh.indices[i + (is_mirrored ? 2 : 1)],
                         mesh.indices[i + (is_mirrored ? 1 : 2)]};
    for (std::size_t k = 0; k < 3; k++) {
      triangle.corners[k] = positions[triangle.vertices[k]];
      triangle.error_m = std::max(triangle.error_m, errors[triangle.vertices[k]]);
    }
    const double area = TrianglePlane(triangle.corners).normal_length;
    if (area > 0.0 && std::isfinite(area)) {
      triangles.push_back(triangle);
    }
  }
}

void Tracer::Tree::place()
{
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const Triangle &triangle : triangles) {
    for (const glm::dvec3 &corner : triangle.corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
      largest_coordinate = std::max(largest_coordinate, largest(corner));
    }
  }
  center = 0.5 * low + 0.5 * high;
  scale = 1.0 / largest(0.5 * high - 0.5 * low);
  half_size = (0.5 * high - 0.5 * low) * scale;
}

void Tracer::Tree::build()
{
  if (triangles.empty()) {
    return;
  }
  if (triangles.size() >= RTC_INVALID_GEOMETRY_ID) {
    fail(fmt::format("{} triangles are too many", triangles.size()));
  }
  place();
  device = rtcNewDevice(nullptr);
  if (device == nullptr) {
    fail(fmt::format("Embree error {}", int(rtcGetDeviceError(nullptr))));
  }
  tree = rtcNewScene(device);
  rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(triangles.size()));
  rtcSetGeometryUserData(geometry, this);

  const auto bounds = [](const RTCBoundsFunctionArguments *a) {
    const Tree &self = *static_cast<const Tree *>(a->geometryUserPtr);
    const Corners &corners = self.triangles[a->primID].corners;
    const glm::dvec3 low = (glm::min(glm::min(corners[0], corners[1]), corners[2]) - self.center) * self.scale;
    const glm::dvec3 high = (glm::max(glm::max(corners[0], corners[1]), corners[2]) - self.center) * self.scale;
    RTCBounds &box = *a->bounds_o;
    box.lower_x = rounded_down(low.x - tree_margin);
    box.lower_y = rounded_down(low.y - tree_margin);
    box.lower_z = rounded_down(low.z - tree_margin);
    box.upper_x = rounded_up(high.x + tree_margin);
    box.upper_y = rounded_up(high.y + tree_margin);
    box.upper_z = rounded_up(high.z + tree_margin);
  };
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);

  const auto intersect = [](const RTCIntersectFunctionNArguments *a) {
    const Tree &self = *static_cast<const Tree *>(a->geometryUserPtr);
    auto &query = *static_cast<ClosestQuery *>(a->context);
    const Triangle &triangle = self.triangles[a->primID];
    const std::optional<glm::dvec3> weights = line_triangle(query.sheared, triangle.corners);
    if (!weights) {
      return;
    }
    const TrianglePlane plane(triangle.corners);
    const double rise = glm::dot(plane.normal, query.ray.direction_ws);
    const double t = -plane.height(query.ray.origin_ws) / rise;
    // Written so that NaN is outside the range.
    if (!(t >= query.ray.t_min && t <= query.ray.t_max)) {
      return;
    }
    if (query.best && (t > query.best->t || (t == query.best->t && a->primID > query.best->triangle))) {
      return;
    }
    if (query.faces == Faces::Drawn && rise > 0.0 && !self.material_of(triangle).is_double_sided) {
      return;
    }
    if (self.opacity_at(triangle, *weights) == 0.0) {
      return;
    }
    query.best = Hit{t, a->primID, *weights};
    // Boxes farther away can be skipped. Boxes at the same distance cannot: they may contain a triangle that comes
    // first.
    RTCRay &ray = reinterpret_cast<RTCRayHit *>(a->rayhit)->ray;
    ray.tfar = std::min(ray.tfar, rounded_up((t - query.t_enter) * query.length + tree_margin));
  };
  rtcSetGeometryIntersectFunction(geometry, intersect);

  const auto occluded = [](const RTCOccludedFunctionNArguments *a) {
    const Tree &self = *static_cast<const Tree *>(a->geometryUserPtr);
    auto &query = *static_cast<BlockedQuery *>(a->context);
    const Triangle &triangle = self.triangles[a->primID];
    const std::optional<glm::dvec3> weights = line_triangle(query.sheared, triangle.corners);
    if (!weights) {
      return;
    }
    const TrianglePlane plane(triangle.corners);
    const double height = plane.height(query.point);
    if (!(std::abs(height) > plane.height_error(query.point, query.error_m + triangle.error_m))) {
      return;
    }
    const glm::dvec3 &end = query.light.vector_ws;
    const double end_height = query.light.is_direction ? glm::dot(plane.normal, end) : plane.height(end);
    // A direction has no position error.
    const double end_error = query.light.is_direction ? 16.0 * double_rounding * plane.edge_product * glm::length(end)
                                                      : plane.height_error(end, triangle.error_m);
    const bool is_between = std::abs(end_height) > end_error && (height < 0.0) != (end_height < 0.0);
    if (is_between) {
      query.transmission *= 1.0 - self.opacity_at(triangle, *weights);
    }
    if (query.transmission == 0.0) {
      // Embree's convention for a blocked ray.
      reinterpret_cast<RTCRay *>(a->ray)->tfar = -std::numeric_limits<float>::infinity();
    }
  };
  rtcSetGeometryOccludedFunction(geometry, occluded);

  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tree, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(tree);
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE) {
    fail(fmt::format("Embree error {}", int(error)));
  }
}

std::optional<Tracer::Tree::Clipped> Tracer::Tree::clipped(const Ray &ray) const
{
  if (tree == nullptr || !is_finite(ray.origin_ws) || !is_finite(ray.direction_ws) ||
      ray.direction_ws == glm::dvec3(0.0)) {
    return std::nullopt;
  }
  const glm::dvec3 origin = (ray.origin_ws - center) * scale;
  const glm::dvec3 direction = ray.direction_ws * scale;
  double enter = ray.t_min;
  double leave = ray.t_max;
  for (int axis = 0; axis < 3; axis++) {
    const double bound = half_size[axis] + tree_margin;
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > bound) {
        return std::nullopt;
      }
      continue;
    }
    const double a = (-bound - origin[axis]) / direction[axis];
    const double b = (bound - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter <= leave)) {
    return std::nullopt;
  }
  Clipped result;
  result.t_enter = enter;
  result.length = glm::length(direction);
  const glm::dvec3 start = origin + direction * enter;
  const glm::dvec3 unit = direction / result.length;
  RTCRay &out = result.ray;
  out.org_x = float(start.x);
  out.org_y = float(start.y);
  out.org_z = float(start.z);
  out.dir_x = float(unit.x);
  out.dir_y = float(unit.y);
  out.dir_z = float(unit.z);
  out.tnear = 0.0F;
  out.tfar = rounded_up((leave - enter) * result.length + tree_margin);
  out.mask = 0xFFFFFFFFU;
  return result;
}

Tracer::Tracer(const scene::Scene &scene) : tree_(std::make_unique<Tree>(scene))
{
  for (std::uint32_t i = 0; i < tree_->objects.size(); i++) {
    tree_->add_object(i);
  }
  tree_->build();
}

Tracer::~Tracer() = default;

std::optional<Hit> Tracer::closest(const Ray &ray, Faces faces) const
{
  const std::optional<Tree::Clipped> clipped = tree_->clipped(ray);
  if (!clipped) {
    return std::nullopt;
  }
  ClosestQuery query{{}, {ray.origin_ws, ray.direction_ws}, ray, faces, clipped->t_enter, clipped->length, {}};
  rtcInitIntersectContext(&query);
  RTCRayHit hit{};
  hit.ray = clipped->ray;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(tree_->tree, &query, &hit);
  return query.best;
}

double Tracer::transmission(const glm::dvec3 &point_ws, double error_m, const LightPoint &light) const
{
  const glm::dvec3 direction = light.is_direction ? light.vector_ws : light.vector_ws - point_ws;
  const Ray ray{point_ws, direction, 0.0, light.is_direction ? std::numeric_limits<double>::infinity() : 1.0};
  const std::optional<Tree::Clipped> clipped = tree_->clipped(ray);
  if (!clipped) {
    return 1.0;
  }
  BlockedQuery query{{}, {point_ws, direction}, point_ws, error_m, light};
  rtcInitIntersectContext(&query);
  RTCRay occluded = clipped->ray;
  rtcOccluded1(tree_->tree, &query, &occluded);
  return query.transmission;
}

Surface Tracer::surface_at(const Hit &hit) const
{
  const Triangle &triangle = tree_->triangles[hit.triangle];
  const MeshPoint point = tree_->point_on(triangle, hit.weights);
  const scene::Material &material = point.scene.material_of(point.mesh);
  const TrianglePlane plane(triangle.corners);
  Surface surface;
  surface.object = triangle.object;
  surface.material = &material;
  surface.geometric_normal_ws = plane.normal / plane.normal_length;
  const Corners &corners = triangle.corners;
  surface.error_m =
      triangle.error_m + std::max({position_error(corners[0]), position_error(corners[1]), position_error(corners[2])});
  for (std::size_t i = 0; i < 3; i++) {
    surface.position_ws += hit.weights[int(i)] * triangle.corners[i];
  }
  const glm::dmat3 linear(glm::dmat4(tree_->objects[triangle.object].world_from_object));
  const auto unit_or = [](const glm::dvec3 &v, const glm::dvec3 &fallback) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : fallback;
  };
  surface.smooth_normal_ws = unit_or(point.smooth_normal_ws(linear), surface.geometric_normal_ws);
  surface.shading_normal_ws = unit_or(point.normal_ws(linear), surface.smooth_normal_ws);

  const auto texel = [&point](const scene::TextureSlot &slot, bool is_color) {
    return point.texture(slot, is_color).value_or(glm::dvec4(1.0));
  };
  const glm::dvec4 roughness_metallic = texel(material.metallic_roughness_texture, false);
  surface.base_color = glm::dvec3(point.base_color());
  surface.opacity = tree_->opacity_at(triangle, hit.weights);
  surface.metallic = double(material.metallic) * roughness_metallic.b;
  surface.roughness = double(material.roughness) * roughness_metallic.g;
  surface.specular = double(material.specular) * texel(material.specular_texture, false).a;
  surface.specular_color =
      glm::dvec3(material.specular_color) * glm::dvec3(texel(material.specular_color_texture, true));
  // A surface whose emission texture is missing does not emit.
  surface.emissive = material.emissive_texture
                         ? glm::dvec3(material.emissive) *
                               glm::dvec3(point.texture(material.emissive_texture, true).value_or(glm::dvec4(0.0)))
                         : glm::dvec3(material.emissive);
  surface.occlusion = 1.0 + double(material.occlusion_strength) * (texel(material.occlusion_texture, false).r - 1.0);
  return surface;
}

double Tracer::largest_coordinate() const
{
  return tree_->largest_coordinate;
}

const std::vector<scene::PlacedLamp> &Tracer::lamps() const
{
  return tree_->lamps;
}

const scene::Scene &Tracer::scene() const
{
  return tree_->scene;
}

std::vector<std::string> untraced_layers(const scene::Scene &scene)
{
  std::set<scene::Handle<scene::Material>> materials;
  for (const scene::Object &object : scene.objects()) {
    materials.insert(scene.meshes()[object.mesh].material);
  }
  std::vector<std::string> lines;
  for (const scene::Handle<scene::Material> handle : materials) {
    const scene::Material *material = scene.materials().find(handle);
    if (material == nullptr) {
      continue;
    }
    std::vector<std::string_view> layers;
    for (const auto &[has_layer, name] : {std::pair(material->has_coat(), "coat"),
                                          {material->has_sheen(), "sheen"},
                                          {material->has_anisotropy(), "anisotropy"},
                                          {material->has_transmission(), "transmission"}}) {
      if (has_layer) {
        layers.emplace_back(name);
      }
    }
    if (!layers.empty()) {
      lines.push_back(
          fmt::format("material '{}': the reference does not trace its {}; the errors include this difference",
                      material->name, fmt::join(layers, " and ")));
    }
  }
  return lines;
}

double position_error(const glm::dvec3 &position_ws)
{
  // A weighted sum of three corners has five roundings on each of three axes. The rest covers the rounding of the
  // weights.
  return 16.0 * double_rounding * largest(position_ws);
}

}  // namespace gnomon::reference
