// SPDX-License-Identifier: MIT
#include "internal/eevee_caster_tree.hh"

#include "render_materials.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace gnomon::eevee {

BoxTree::BoxTree(std::span<const scene::Bounds> boxes) : items_(boxes.size())
{
  std::iota(items_.begin(), items_.end(), 0U);
  if (!boxes.empty()) {
    nodes_.reserve(boxes.size());
    build(boxes, 0, boxes.size());
  }
}

void BoxTree::build(std::span<const scene::Bounds> boxes, std::size_t first, std::size_t end)
{
  const std::size_t index = nodes_.size();
  const auto begin = items_.begin();
  scene::Bounds box = boxes[items_[first]];
  glm::vec3 low = box.min + box.max;
  glm::vec3 high = low;
  for (std::size_t i = first; i < end; i++) {
    const scene::Bounds &item = boxes[items_[i]];
    box = {glm::min(box.min, item.min), glm::max(box.max, item.max)};
    low = glm::min(low, item.min + item.max);
    high = glm::max(high, item.min + item.max);
  }
  nodes_.push_back({box});
  constexpr std::size_t leaf_items = 4;
  if (end - first <= leaf_items) {
    nodes_[index].next = std::uint32_t(first);
    nodes_[index].count = std::uint32_t(end - first);
    return;
  }
  const glm::vec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t middle = (first + end) / 2;
  std::nth_element(begin + std::ptrdiff_t(first), begin + std::ptrdiff_t(middle), begin + std::ptrdiff_t(end),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return boxes[a].min[axis] + boxes[a].max[axis] < boxes[b].min[axis] + boxes[b].max[axis];
                   });
  build(boxes, first, middle);
  nodes_[index].next = std::uint32_t(nodes_.size());
  build(boxes, middle, end);
}

/** The distance in directions at which a ray enters \a box; infinity if it does not before \a t_max. */
static float entry_of(const scene::Bounds &box, const glm::vec3 &origin, const glm::vec3 &inverse, float t_max)
{
  const glm::vec3 a = (box.min - origin) * inverse;
  const glm::vec3 b = (box.max - origin) * inverse;
  const glm::vec3 low = glm::min(a, b);
  const glm::vec3 high = glm::max(a, b);
  const float enter = std::max({low.x, low.y, low.z, 0.0F});
  // Three roundings on each side.
  constexpr float rounding = 1.0F + 6.0F * std::numeric_limits<float>::epsilon();
  const float leave = std::min({high.x, high.y, high.z, t_max}) * rounding;
  return enter <= leave ? enter : std::numeric_limits<float>::infinity();
}

/** 1 / \a direction, finite: an axis with 0 would give NaN for origins on a face of a box. */
static glm::vec3 inverse_of(const glm::vec3 &direction)
{
  const auto inverse = [](float x) { return 1.0F / (std::abs(x) > 1e-30F ? x : std::copysign(1e-30F, x)); };
  return {inverse(direction.x), inverse(direction.y), inverse(direction.z)};
}

template <typename Visit>
void BoxTree::visit(const glm::vec3 &origin, const glm::vec3 &direction, const float &t_max, Visit &&visit) const
{
  struct Entry {
    std::uint32_t node;
    float t;
  };
  constexpr float none = std::numeric_limits<float>::infinity();
  // The depth of a tree of medians is at most 32.
  std::array<Entry, 64> stack;
  std::size_t depth = 0;
  const glm::vec3 inverse = inverse_of(direction);
  if (!nodes_.empty()) {
    stack[depth++] = {0, entry_of(nodes_[0].box, origin, inverse, t_max)};
  }
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.t >= t_max) {
      continue;
    }
    const Node &node = nodes_[entry.node];
    for (std::uint32_t i = 0; i < node.count; i++) {
      if (visit(items_[node.next + i])) {
        return;
      }
    }
    if (node.count > 0) {
      continue;
    }
    Entry near{entry.node + 1, entry_of(nodes_[entry.node + 1].box, origin, inverse, t_max)};
    Entry far{node.next, entry_of(nodes_[node.next].box, origin, inverse, t_max)};
    if (far.t < near.t) {
      std::swap(near, far);
    }
    if (far.t < none) {
      stack[depth++] = far;
    }
    if (near.t < none) {
      stack[depth++] = near;
    }
  }
}

/** The triangles of a mesh, in its space. */
struct CasterTree::MeshTree {
  struct Triangle {
    glm::vec3 corner;
    std::array<glm::vec3, 2> edges;
  };
  std::vector<Triangle> triangles;
  /** Alphas of the corners of each triangle. Empty: all are 1. */
  std::vector<glm::vec3> alphas;
  BoxTree tree;

  explicit MeshTree(const scene::Mesh &mesh)
  {
    std::vector<scene::Bounds> boxes;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const glm::vec3 &a = mesh.positions[mesh.indices[i]];
      const glm::vec3 &b = mesh.positions[mesh.indices[i + 1]];
      const glm::vec3 &c = mesh.positions[mesh.indices[i + 2]];
      triangles.push_back({a, {b - a, c - a}});
      boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    }
    tree = BoxTree(boxes);
    if (std::ranges::any_of(mesh.colors, [](const glm::vec4 &color) { return color.a < 1.0F; })) {
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        alphas.emplace_back(mesh.colors[mesh.indices[i]].a, mesh.colors[mesh.indices[i + 1]].a,
                            mesh.colors[mesh.indices[i + 2]].a);
      }
    }
  }
};

CasterTree::Texels::Texels(const scene::Image &image)
{
  std::array<std::size_t, 256> counts{};
  for (std::size_t i = 3; i < image.texels.size(); i += 4) {
    counts[image.texels[i]]++;
  }
  std::size_t count = 0;
  for (std::size_t byte = counts.size(); byte-- > 0;) {
    count += counts[byte];
    shares[byte] = float(double(count) / double(image.texels.size() / 4));
  }
  fingerprint = fingerprint_of(std::as_bytes(std::span(shares)));
}

CasterTree::Mask CasterTree::mask_of(const scene::Scene &scene, const scene::Mesh &mesh, Images &last)
{
  const scene::Material &material = scene.material_of(mesh);
  const scene::TextureSlot &slot = material.base_color_texture;
  if (!render_scene::is_masked(scene, mesh) || render_scene::has_surface_function(scene, material)) {
    return {};
  }
  Mask mask;
  mask.cutoff = material.alpha_cutoff / material.alpha;
  if (!render_scene::is_drawable(scene, mesh, slot)) {
    return mask;
  }
  const scene::Handle<scene::Image> handle = scene.textures()[slot.texture].image;
  const ImageKey key{handle.key(), scene.images().revision(handle, scene::Image::Aspect::Content)};
  // The node of a map keeps its address.
  images_.insert(last.extract(key));
  const auto [image, is_new] = images_.try_emplace(key);
  if (is_new) {
    image->second = Texels(scene.images()[handle]);
  }
  mask.texels = &image->second;
  mask.opaque_cover = mask.cover(1.0F);
  return mask;
}

float CasterTree::Mask::cover(float alpha) const
{
  if (!texels) {
    return alpha >= cutoff ? 1.0F : 0.0F;
  }
  // The products as is_cut_out of the shaders compares them.
  const auto &shares = texels->shares;
  const auto least = std::ranges::partition_point(shares, [&](const float &share) {
    const auto byte = float(&share - shares.data());
    return alpha * (byte / 255.0F) < cutoff;
  });
  return least == shares.end() ? 0.0F : *least;
}

bool CasterTree::is_covered(const Instance &instance, std::uint32_t triangle, float u, float v)
{
  if (instance.mask.cutoff <= 0.0F) {
    return true;
  }
  const std::vector<glm::vec3> &alphas = instance.mesh->alphas;
  const float cover = alphas.empty() ? instance.mask.opaque_cover
                                     : instance.mask.cover(glm::dot(alphas[triangle], glm::vec3(1.0F - u - v, u, v)));
  // The fraction of the place serves as a random number.
  const double place = 1013.0 * double(u) + 757.0 * double(v);
  return place - std::floor(place) < double(cover);
}

std::vector<scene::Bounds> CasterTree::update(const render_scene::RenderScene &scene)
{
  const std::vector<Caster> casters = std::exchange(casters_, {});
  const auto meshes = std::exchange(meshes_, {});
  Images images = std::exchange(images_, {});
  const scene::Scene &content = scene.scene();
  instances_.clear();
  std::vector<scene::Bounds> boxes;
  for (draw::ObjectIndex i = draw::object_identity + 1; i < scene.objects().index_end(); i++) {
    if (!scene.objects().is_live(i) || !scene.object(i).casts_shadow) {
      continue;
    }
    const scene::Handle<scene::Mesh> handle = scene.object(i).mesh;
    const scene::Mesh &mesh = content.meshes()[handle];
    if (mesh.indices.empty() || !render_scene::is_drawable(content, content.material_of(mesh)) ||
        !render_scene::has_closed_shadow(content, mesh)) {
      continue;
    }
    const MeshKey key{handle.key(), content.meshes().revision(handle, scene::Mesh::Aspect::Shape)};
    std::shared_ptr<const MeshTree> &tree = meshes_[key];
    if (!tree) {
      const auto found = meshes.find(key);
      tree = found != meshes.end() ? found->second : std::make_shared<const MeshTree>(mesh);
    }
    const Mask mask = mask_of(content, mesh, images);
    struct {
      MeshKey mesh;
      std::uint64_t texels;
      glm::mat4 world_from_object;
      // The bytes of members without padding are hashed.
      float cutoff;
      std::uint32_t is_double_sided;
    } print{key, mask.texels ? mask.texels->fingerprint : 0, scene.objects().world_from_object(i), mask.cutoff,
            content.material_of(mesh).is_double_sided ? 1U : 0U};
    casters_.push_back({.bounds_ws = scene.object(i).bounds,
                        .object = i,
                        .fingerprint = fingerprint_of(std::as_bytes(std::span(&print, 1)))});
    instances_.push_back({tree.get(), glm::inverse(print.world_from_object), mask, print.is_double_sided != 0});
    boxes.push_back(scene.object(i).bounds);
  }
  tree_ = BoxTree(boxes);
  return changed_bounds(casters, casters_);
}

template <typename Accept>
void CasterTree::visit(const glm::vec3 &origin_ws, const glm::vec3 &direction_ws, bool is_nearest, float t_max,
                       Accept &&accept) const
{
  tree_.visit(origin_ws, direction_ws, t_max, [&](std::uint32_t i) {
    const Instance &instance = instances_[i];
    const glm::vec3 origin(instance.object_from_world * glm::vec4(origin_ws, 1.0F));
    const glm::vec3 direction(instance.object_from_world * glm::vec4(direction_ws, 0.0F));
    bool is_over = false;
    instance.mesh->tree.visit(origin, direction, t_max, [&](std::uint32_t k) {
      // Möller and Trumbore 1997. The margin keeps rays from passing between triangles that share an edge.
      constexpr float margin = 1e-5F;
      const MeshTree::Triangle &triangle = instance.mesh->triangles[k];
      const glm::vec3 p = glm::cross(direction, triangle.edges[1]);
      const float determinant = glm::dot(triangle.edges[0], p);
      const float inverse = 1.0F / determinant;
      const glm::vec3 from_corner = origin - triangle.corner;
      const glm::vec3 q = glm::cross(from_corner, triangle.edges[0]);
      const float u = glm::dot(from_corner, p) * inverse;
      const float v = glm::dot(direction, q) * inverse;
      const float t = glm::dot(triangle.edges[1], q) * inverse;
      // The front is found in the space of the object, so that mirrored objects have theirs outside, too.
      if (determinant != 0.0F && u >= -margin && v >= -margin && u + v <= 1.0F + margin && t > 0.0F && t < t_max &&
          is_covered(instance, k, u, v) && accept(Meeting{i, k, t, determinant > 0.0F})) {
        t_max = t;
        is_over = !is_nearest;
      }
      return is_over;
    });
    return is_over;
  });
}

RayHit CasterTree::trace(const glm::vec3 &origin_ws, const glm::vec3 &direction_ws, bool is_nearest, float t_max) const
{
  RayHit hit = RayHit::None;
  visit(origin_ws, direction_ws, is_nearest, t_max, [&](const Meeting &meeting) {
    hit = meeting.is_front ? RayHit::Front : RayHit::Back;
    return true;
  });
  return hit;
}

std::optional<SurfacePoint> CasterTree::seen(const draw::View &view, const glm::vec3 &origin_ws,
                                             const glm::vec3 &direction_ws) const
{
  std::optional<Meeting> nearest;
  visit(origin_ws, direction_ws, true, std::numeric_limits<float>::max(), [&](const Meeting &meeting) {
    const glm::vec4 place(origin_ws + meeting.t * direction_ws, 1.0F);
    const bool is_seen =
        (meeting.is_front || instances_[meeting.instance].is_double_sided) &&
        !view.hidden().contains(casters_[meeting.instance].object) &&
        std::ranges::all_of(view.clip_planes(), [&](const glm::vec4 &plane) { return glm::dot(plane, place) >= 0.0F; });
    if (is_seen) {
      nearest = meeting;
    }
    return is_seen;
  });
  if (!nearest) {
    return std::nullopt;
  }
  const Instance &instance = instances_[nearest->instance];
  const MeshTree::Triangle &triangle = instance.mesh->triangles[nearest->triangle];
  const glm::vec3 normal = glm::normalize(glm::transpose(glm::mat3(instance.object_from_world)) *
                                          glm::cross(triangle.edges[0], triangle.edges[1]));
  return SurfacePoint{origin_ws + nearest->t * direction_ws, glm::dot(normal, direction_ws) > 0.0F ? -normal : normal};
}

}  // namespace gnomon::eevee
