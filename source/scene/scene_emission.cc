// SPDX-License-Identifier: MIT
#include "scene_emission.hh"

#include "scene_image.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace gnomon::scene {

namespace {

/** Larger images are reduced to this edge, texels. */
constexpr std::uint32_t image_size_max = 256;
/** Most divisions of a triangle's edge, and most lookups along the edge of a patch. */
constexpr int divisions_max = 64;
constexpr int lookups_max = 4;

bool may_emit(const Material &material)
{
  return material.emissive != glm::vec3(0.0F) && !material.is_unlit && !material.surface_function;
}

/** Index of a texel; \a place counts from the first of \a size texels. */
std::uint32_t wrapped(double place, std::uint32_t size, TextureWrap wrap)
{
  const double count = size;
  double texel = std::floor(place * count);
  if (wrap == TextureWrap::Repeat) {
    texel -= count * std::floor(texel / count);
  }
  else if (wrap == TextureWrap::MirroredRepeat) {
    texel -= 2.0 * count * std::floor(texel / (2.0 * count));
    texel = texel < count ? texel : 2.0 * count - 1.0 - texel;
  }
  // Large coordinates may not be exact.
  return std::uint32_t(std::clamp(texel, 0.0, count - 1.0));
}

/** Images of colours, in a bounded size. */
class ImageCache {
 public:
  explicit ImageCache(const Scene &scene) : scene_(scene)
  {
    for (std::size_t i = 0; i < decoded_.size(); i++) {
      decoded_[i] = decoded_srgb(float(i) / 255.0F);
    }
  }
  const Image &get(Handle<Image> handle)
  {
    const Image &image = scene_.images()[handle];
    if (std::max(image.width, image.height) <= image_size_max) {
      return image;
    }
    const auto [found, is_new] = reduced_.try_emplace(handle);
    if (is_new) {
      found->second = reduced(image, image_size_max, ImageUse::Color);
    }
    return found->second;
  }
  [[nodiscard]] float decoded(std::uint8_t value) const
  {
    return decoded_[value];
  }

 private:
  const Scene &scene_;
  std::array<float, 256> decoded_{};
  std::map<Handle<Image>, Image> reduced_;
};

/** A texture of a material on a mesh, by barycentric coordinates of a triangle. */
class SlotLookup {
 public:
  SlotLookup(const Scene &scene, const Mesh &mesh, const TextureSlot &slot, ImageCache &images)
      : uvs_(mesh.uv_set(slot.uv_set)), uv_from_mesh_(slot.uv_from_mesh()), images_(images)
  {
    texture_ = scene.textures().find(slot.texture);
    if (texture_ && scene.images().find(texture_->image) && !uvs_.empty()) {
      image_ = &images.get(texture_->image);
    }
  }
  [[nodiscard]] bool has_image() const
  {
    return image_ != nullptr;
  }
  /** Position of a vertex on the image, whose edges are 1. */
  [[nodiscard]] glm::dvec2 uv(std::uint32_t vertex) const
  {
    return uv_from_mesh_ * glm::dvec3(uvs_[vertex], 1.0);
  }
  [[nodiscard]] std::uint32_t size() const
  {
    return std::max(image_->width, image_->height);
  }
  [[nodiscard]] const std::uint8_t *texel(const glm::dvec2 &uv) const
  {
    const std::size_t x = wrapped(uv.x, image_->width, texture_->wrap_u);
    const std::size_t y = wrapped(uv.y, image_->height, texture_->wrap_v);
    return &image_->texels[4 * (y * image_->width + x)];
  }
  [[nodiscard]] glm::vec3 color(const glm::dvec2 &uv) const
  {
    const std::uint8_t *rgba = texel(uv);
    return {images_.decoded(rgba[0]), images_.decoded(rgba[1]), images_.decoded(rgba[2])};
  }

 private:
  const std::vector<glm::vec2> &uvs_;
  glm::dmat3x2 uv_from_mesh_;
  ImageCache &images_;
  const Texture *texture_ = nullptr;
  const Image *image_ = nullptr;
};

/** A mesh at a node, whose material emits light. */
struct Emitter {
  const Object &object;
  const Mesh &mesh;
  const Material &material;
  SlotLookup emission;
  SlotLookup coverage;

  [[nodiscard]] bool has_coverage() const
  {
    return material.alpha_mode != AlphaMode::Opaque && (coverage.has_image() || !mesh.colors.empty());
  }
  /** Longest edge of triangle \a first on the textures that vary over it, in texture coordinates. */
  [[nodiscard]] double uv_edge(std::size_t first) const
  {
    double longest = 0.0;
    for (const SlotLookup *lookup : {&emission, &coverage}) {
      if (!lookup->has_image() || (lookup == &coverage && material.alpha_mode == AlphaMode::Opaque)) {
        continue;
      }
      for (std::size_t i = 0; i < 3; i++) {
        longest = std::max(
            longest, glm::distance(lookup->uv(mesh.indices[first + i]), lookup->uv(mesh.indices[first + (i + 1) % 3])));
      }
    }
    return std::isfinite(longest) ? longest : 0.0;
  }
  /** Radiance at the barycentric coordinates \a weights of triangle \a first. */
  [[nodiscard]] glm::vec3 radiance(std::size_t first, const glm::dvec3 &weights) const
  {
    const std::uint32_t *vertices = &mesh.indices[first];
    const auto uv = [&](const SlotLookup &lookup) {
      return weights.x * lookup.uv(vertices[0]) + weights.y * lookup.uv(vertices[1]) +
             weights.z * lookup.uv(vertices[2]);
    };
    glm::vec3 value = material.emissive;
    if (emission.has_image()) {
      value *= emission.color(uv(emission));
    }
    if (material.alpha_mode == AlphaMode::Opaque) {
      return value;
    }
    float alpha = material.alpha;
    if (!mesh.colors.empty()) {
      alpha *= float(weights.x) * mesh.colors[vertices[0]].a + float(weights.y) * mesh.colors[vertices[1]].a +
               float(weights.z) * mesh.colors[vertices[2]].a;
    }
    if (coverage.has_image()) {
      alpha *= float(coverage.texel(uv(coverage))[3]) / 255.0F;
    }
    return material.alpha_mode == AlphaMode::Blend ? alpha * value
           : alpha < material.alpha_cutoff         ? glm::vec3(0.0F)
                                                   : value;
  }
};

/** Calls \a action with the barycentric corners of each of the count² equal parts of a triangle. */
template <typename Action>
void for_each_part(int count, Action &&action)
{
  const double step = 1.0 / count;
  const auto corner = [&](int i, int j) { return glm::dvec3(1.0 - step * (i + j), step * i, step * j); };
  for (int i = 0; i < count; i++) {
    for (int j = 0; i + j < count; j++) {
      action(std::array{corner(i, j), corner(i + 1, j), corner(i, j + 1)});
      if (i + j + 1 < count) {
        action(std::array{corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j)});
      }
    }
  }
}

/** The bits of \a value in [0, 1024), with two zeros between neighbours. */
std::uint32_t spread_bits(std::uint32_t value)
{
  value = (value | value << 16U) & 0x030000FFU;
  value = (value | value << 8U) & 0x0300F00FU;
  value = (value | value << 4U) & 0x030C30C3U;
  return (value | value << 2U) & 0x09249249U;
}

/** Number of a point along a Morton curve through a box. */
std::uint32_t morton_code(const Bounds &bounds, const glm::vec3 &point)
{
  const glm::vec3 share = (point - bounds.min) / glm::max(bounds.max - bounds.min, glm::vec3(1e-30F));
  const glm::uvec3 cell(glm::clamp(share, 0.0F, 1.0F) * 1023.0F);
  return spread_bits(cell.x) | spread_bits(cell.y) << 1U | spread_bits(cell.z) << 2U;
}

template <typename Value>
void reorder(std::vector<Value> &values, std::span<const std::size_t> order)
{
  std::vector<Value> reordered;
  reordered.reserve(values.size());
  for (const std::size_t i : order) {
    reordered.push_back(values[i]);
  }
  values = std::move(reordered);
}

/** Number of parts into which an edge of a triangle is divided, which is as long as \a uv_edge of its texture's edge.
 */
double divisions(double uv_edge)
{
  return std::clamp(std::ceil(uv_edge / EmissiveSurfaces::patch_edge_max), 1.0, double(divisions_max));
}

/** The objects that emit light. \a images must outlive the result. */
std::vector<Emitter> emitters_of(const Scene &scene, std::span<const Object> objects, ImageCache &images)
{
  std::vector<Emitter> emitters;
  for (const Object &object : objects) {
    const Mesh &mesh = scene.meshes()[object.mesh];
    const Material &material = scene.material_of(mesh);
    if (mesh.topology != Topology::Triangles || !may_emit(material)) {
      continue;
    }
    Emitter emitter{object, mesh, material, SlotLookup(scene, mesh, material.emissive_texture, images),
                    SlotLookup(scene, mesh, material.base_color_texture, images)};
    // A surface whose emission texture is missing does not emit, in pictures either.
    if (!material.emissive_texture || emitter.emission.has_image()) {
      emitters.push_back(emitter);
    }
  }
  return emitters;
}

/** Factor of divisions() for which there are at most patch_count_max patches, if there are not more triangles. */
double division_scale(std::span<const Emitter> emitters)
{
  double count = 0.0;
  for (const Emitter &emitter : emitters) {
    for (std::size_t first = 0; first + 2 < emitter.mesh.indices.size(); first += 3) {
      const double edge = divisions(emitter.uv_edge(first));
      count += edge * edge;
    }
  }
  return std::min(std::sqrt(double(EmissiveSurfaces::patch_count_max) / std::max(count, 1.0)), 1.0);
}

/** Mean over \a part of triangle \a first. */
glm::vec3 mean_radiance(const Emitter &emitter, std::size_t first, const std::array<glm::dvec3, 3> &part,
                        int lookup_count)
{
  glm::dvec3 sum(0.0);
  for_each_part(lookup_count, [&](const std::array<glm::dvec3, 3> &lookup) {
    const glm::dvec3 middle = (lookup[0] + lookup[1] + lookup[2]) / 3.0;
    sum += glm::dvec3(emitter.radiance(first, middle.x * part[0] + middle.y * part[1] + middle.z * part[2]));
  });
  return glm::min(glm::vec3(sum / double(lookup_count * lookup_count)), EmissiveSurfaces::radiance_max);
}

}  // namespace

bool has_emission(const Scene &scene)
{
  for (const auto &[handle, material] : scene.materials()) {
    if (may_emit(material)) {
      return true;
    }
  }
  return false;
}

EmissionState emission_state(const Scene &scene)
{
  EmissionState state;
  if (!has_emission(scene)) {
    return state;
  }
  const Pool<Node> &nodes = scene.nodes();
  for (const auto &[handle, node] : nodes) {
    if (node.meshes.empty() || !scene.is_visible(handle)) {
      continue;
    }
    for (const Handle<Mesh> used : node.meshes) {
      const Mesh *mesh = scene.meshes().find(used);
      if (!mesh || !may_emit(scene.material_of(*mesh))) {
        continue;
      }
      // An object that joins has a new revision, and one that leaves changes the number of objects.
      state.object_count++;
      state.latest = std::max(
          {state.latest, nodes.revision(handle, Node::Aspect::Transform), nodes.revision(handle, Node::Aspect::Content),
           nodes.revision(handle, Node::Aspect::Visibility), scene.meshes().revision(used, Mesh::Aspect::Shape),
           scene.meshes().revision(used, Mesh::Aspect::Material),
           scene.materials().revision(mesh->material, Material::Aspect::Surface),
           scene.materials().revision(mesh->material, Material::Aspect::Coverage),
           scene.materials().revision(mesh->material, Material::Aspect::Textures)});
    }
  }
  state.latest = std::max({state.latest, scene.textures().latest(), scene.images().latest(Image::Aspect::Content)});
  return state;
}

EmissiveSurfaces::EmissiveSurfaces(const Scene &scene, std::span<const Object> objects)
{
  ImageCache images(scene);
  const std::vector<Emitter> emitters = emitters_of(scene, objects, images);
  const double scale = division_scale(emitters);

  std::vector<double> weights;
  Bounds bounds;
  for (const Emitter &emitter : emitters) {
    const auto position = [&](std::uint32_t vertex) {
      return glm::dvec3(emitter.object.world_from_object * glm::dvec4(emitter.mesh.positions[vertex], 1.0));
    };
    for (std::size_t first = 0; first + 2 < emitter.mesh.indices.size(); first += 3) {
      const double uv_edge = emitter.uv_edge(first);
      const int part_count = std::max(int(scale * divisions(uv_edge)), 1);
      const std::array corners = {position(emitter.mesh.indices[first]), position(emitter.mesh.indices[first + 1]),
                                  position(emitter.mesh.indices[first + 2])};
      const double area = 0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0])) /
                          (double(part_count) * part_count);
      if (!(area > 0.0) || std::isinf(area)) {
        continue;
      }
      const bool is_varying = emitter.emission.has_image() || emitter.has_coverage();
      const double texels = emitter.emission.has_image() ? uv_edge / part_count * emitter.emission.size() : lookups_max;
      const int lookup_count = is_varying ? std::clamp(int(std::min(std::ceil(texels), 1e6)), 1, lookups_max) : 1;
      for_each_part(part_count, [&](const std::array<glm::dvec3, 3> &part) {
        const glm::vec3 radiance = mean_radiance(emitter, first, part, lookup_count);
        const double weight = area * (double(radiance.r) + double(radiance.g) + double(radiance.b));
        if (!(weight > 0.0)) {
          return;
        }
        Patch &patch = patches_.emplace_back();
        patch.radiance = radiance;
        for (std::size_t i = 0; i < 3; i++) {
          patch.corners[i] = part[i].x * corners[0] + part[i].y * corners[1] + part[i].z * corners[2];
          bounds.extend(glm::vec3(patch.corners[i]));
        }
        weights.push_back(weight);
      });
    }
  }
  std::vector<std::uint32_t> codes;
  codes.reserve(patches_.size());
  for (const Patch &patch : patches_) {
    codes.push_back(morton_code(bounds, glm::vec3((patch.corners[0] + patch.corners[1] + patch.corners[2]) / 3.0)));
  }
  std::vector<std::size_t> order(patches_.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return codes[i]; });
  reorder(patches_, order);
  reorder(weights, order);
  cumulative_.resize(weights.size());
  std::partial_sum(weights.begin(), weights.end(), cumulative_.begin());
}

EmissivePoint EmissiveSurfaces::at(const glm::dvec3 &place) const
{
  const double target = place.x * cumulative_.back();
  const auto found = std::min(std::ranges::upper_bound(cumulative_, target), cumulative_.end() - 1);
  const Patch &patch = patches_[std::size_t(found - cumulative_.begin())];
  const glm::dvec3 &first = patch.corners[0];
  const glm::dvec3 x = patch.corners[1] - first;
  const glm::dvec3 y = patch.corners[2] - first;
  // An even distribution over the triangle.
  const double root = std::sqrt(place.y);
  EmissivePoint point;
  point.position = first + root * ((1.0 - place.z) * x + place.z * y);
  const glm::dvec3 across = glm::cross(x, y);
  const double length = glm::length(across);
  point.normal = length > 0.0 ? across / length : glm::dvec3(0.0, 0.0, 1.0);
  point.radiance = glm::dvec3(patch.radiance);
  point.area = cumulative_.back() / (point.radiance.r + point.radiance.g + point.radiance.b);
  return point;
}

}  // namespace gnomon::scene
