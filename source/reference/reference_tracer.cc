// SPDX-License-Identifier: MIT
#include "reference_tracer.hh"

#include "internal/reference_tree.hh"

#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::reference {

Tracer::Tracer(const scene::Scene &scene) : tree_(std::make_unique<Tree>(scene))
{
  for (std::uint32_t i = 0; i < tree_->objects.size(); i++) {
    tree_->add_object(i);
  }
  tree_->build();
}

Tracer::~Tracer() = default;

namespace {

#if GNOMON_EMBREE >= 4
void trace(RTCScene scene, QueryContext &query, RTCRayHit &ray)
{
  rtcInitRayQueryContext(&query);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &query;
  rtcIntersect1(scene, &ray, &arguments);
}

void trace_occluded(RTCScene scene, QueryContext &query, RTCRay &ray)
{
  rtcInitRayQueryContext(&query);
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &query;
  rtcOccluded1(scene, &ray, &arguments);
}
#else
void trace(RTCScene scene, QueryContext &query, RTCRayHit &ray)
{
  rtcInitIntersectContext(&query);
  rtcIntersect1(scene, &query, &ray);
}

void trace_occluded(RTCScene scene, QueryContext &query, RTCRay &ray)
{
  rtcInitIntersectContext(&query);
  rtcOccluded1(scene, &query, &ray);
}
#endif

}  // namespace

std::optional<Hit> Tracer::closest(const Ray &ray, Faces faces) const
{
  const std::optional<Tree::Clipped> clipped = tree_->clipped(ray);
  if (!clipped) {
    return std::nullopt;
  }
  ClosestQuery query{{}, {ray.origin_ws, ray.direction_ws}, ray, faces, clipped->t_enter, clipped->length, {}};
  RTCRayHit hit{};
  hit.ray = clipped->ray;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  trace(tree_->tree, query, hit);
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
  RTCRay occluded = clipped->ray;
  trace_occluded(tree_->tree, query, occluded);
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

std::vector<std::string> untraced_parts(const scene::Scene &scene)
{
  std::set<scene::Handle<scene::Material>> materials;
  std::set<scene::Handle<scene::Mesh>> other_meshes;
  for (const scene::Object &object : scene.objects()) {
    const scene::Mesh &mesh = scene.meshes()[object.mesh];
    if (mesh.topology == scene::Topology::Triangles && !mesh.host_shape) {
      materials.insert(mesh.material);
    }
    else {
      other_meshes.insert(object.mesh);
    }
  }
  std::vector<std::string> lines;
  for (const scene::Handle<scene::Material> handle : materials) {
    const scene::Material *material = scene.materials().find(handle);
    if (material == nullptr) {
      continue;
    }
    std::vector<std::string_view> layers;
    for (const auto &[has_layer, name] :
         {std::pair(material->has_coat(), "coat"),
          {material->has_sheen(), "sheen"},
          {material->has_anisotropy(), "anisotropy"},
          {material->has_transmission(), "transmission"},
          {scene.surface_functions().is_live(material->surface_function), "surface function"}}) {
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
  for (const scene::Handle<scene::Mesh> handle : other_meshes) {
    const scene::Mesh &mesh = scene.meshes()[handle];
    lines.push_back(fmt::format("mesh '{}': the reference does not trace {}; the errors include this difference",
                                mesh.name,
                                mesh.host_shape                           ? "buffers of a host"
                                : mesh.topology == scene::Topology::Lines ? "lines"
                                                                          : "points"));
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
