// SPDX-License-Identifier: MIT
#include "overlay.hh"

#include "gpu_read.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace gnomon::overlay {

namespace {

/** Where the outline crosses a row of a picture, in ascending order of x. */
void find_crossings(std::span<const glm::dvec2> corners, double y, std::vector<double> &crossings)
{
  crossings.clear();
  for (std::size_t i = 0; i < corners.size(); i++) {
    const glm::dvec2 &from = corners[i];
    const glm::dvec2 &to = corners[(i + 1) % corners.size()];
    // Each edge with its lower end and without its upper one, so that a row through a corner counts once.
    if ((from.y <= y) != (to.y <= y)) {
      crossings.push_back(from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y));
    }
  }
  std::ranges::sort(crossings);
}

/** The pixels of a picture in the box around an outline; an empty size: none. */
gpu::Rectangle pixels_around(std::span<const glm::dvec2> corners, glm::ivec2 size_px)
{
  const glm::dvec2 size(size_px);
  glm::dvec2 low = size;
  glm::dvec2 high(0.0);
  for (const glm::dvec2 &corner : corners) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const glm::ivec2 first(glm::clamp(glm::floor(low), glm::dvec2(0.0), size));
  const glm::ivec2 end(glm::clamp(glm::ceil(high), glm::dvec2(0.0), size));
  return {first, glm::max(end - first, glm::ivec2(0))};
}

/** By pixel of \a region, row by row: 1 if its middle is within the outline. */
std::vector<std::uint8_t> inside_of(std::span<const glm::dvec2> corners, const gpu::Rectangle &region)
{
  std::vector<std::uint8_t> inside(std::size_t(region.size_px.x) * std::size_t(region.size_px.y));
  std::vector<double> crossings;
  auto row = inside.begin();
  for (int y = 0; y < region.size_px.y; y++, row += region.size_px.x) {
    find_crossings(corners, region.origin_px.y + y + 0.5, crossings);
    // The first column whose middle is not before x.
    const auto column = [&](double x) {
      return std::ptrdiff_t(std::clamp(std::ceil(x - 0.5) - region.origin_px.x, 0.0, double(region.size_px.x)));
    };
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      std::fill(row + column(crossings[i]), row + column(crossings[i + 1]), std::uint8_t(1));
    }
  }
  return inside;
}

/** \throws gpu::Error if a corner is not finite */
void check_finite(std::span<const glm::dvec2> corners)
{
  const auto wrong = std::ranges::find_if(
      corners, [](const glm::dvec2 &corner) { return !(std::isfinite(corner.x) && std::isfinite(corner.y)); });
  if (wrong != corners.end()) {
    throw gpu::Error("overlay: corner {}, {}, {}, is not finite", wrong - corners.begin(), wrong->x, wrong->y);
  }
}

}  // namespace

std::array<glm::dvec2, 4> rectangle(const glm::dvec2 &from_px, const glm::dvec2 &to_px)
{
  return {from_px, {to_px.x, from_px.y}, to_px, {from_px.x, to_px.y}};
}

bool is_inside(std::span<const glm::dvec2> corners, const glm::dvec2 &point)
{
  std::vector<double> crossings;
  find_crossings(corners, point.y, crossings);
  return std::ranges::count_if(crossings, [&](double x) { return x <= point.x; }) % 2 == 1;
}

std::vector<glm::dvec4> Overlay::planes_around(const draw::View &view, glm::ivec2 size_px, const glm::dvec2 &from_px,
                                               const glm::dvec2 &to_px) const
{
  check_finite(std::array{from_px, to_px});
  const glm::dvec2 size(size_px);
  const glm::ivec2 first(glm::clamp(glm::floor(glm::min(from_px, to_px)), glm::dvec2(0.0), size - 1.0));
  const glm::ivec2 end(glm::clamp(glm::ceil(glm::max(from_px, to_px)), glm::dvec2(first) + 1.0, size));
  const draw::View part = view_of_region(view, size_px, {first, end - first});
  std::vector<glm::dvec4> planes;
  for (const glm::vec4 &plane : std::span(part.frustum_planes_ws()).first(4)) {
    const glm::dvec3 normal(plane);
    planes.emplace_back(normal, double(plane.w) - glm::dot(normal, scene_.origin_ws()));
  }
  return planes;
}

std::vector<bool> Overlay::objects_at(const draw::View &view, glm::ivec2 size_px, const gpu::Rectangle &region,
                                      std::span<const std::uint8_t> mask, Reach reach, const IsDrawn &is_drawn)
{
  const draw::View region_view = view_of_region(view, size_px, region);
  gpu::Device &device = scene_.device();
  // The target has the region's size, so that nothing else is read back.
  ObjectsTarget area;
  std::vector<bool> is_found(scene_.objects().index_end());
  bool has_more = true;
  for (bool is_first = true; has_more && (is_first || reach == Reach::Through); is_first = false) {
    has_more = false;
    gpu::CommandList list;
    const auto is_left = [&](draw::ObjectIndex object) { return !is_found[object] && is_drawn(object); };
    if (!record_objects(region_view, region.size_px, is_left, area, list)) {
      break;
    }
    device.submit(list);
    const auto texels = gpu::read_as<glm::vec2>(device, area.objects);
    for (std::size_t i = 0; i < texels.size(); i++) {
      const auto object = draw::ObjectIndex(texels[i].x);
      if (mask[i] != 0 && object != draw::object_identity && !is_found[object]) {
        is_found[object] = has_more = true;
      }
    }
  }
  return is_found;
}

bool Overlay::is_in_picture(const draw::View &view, draw::ObjectIndex object) const
{
  const render_scene::RenderObject &drawn = scene_.object(object);
  const scene::Mesh &mesh = scene_.scene().meshes()[drawn.mesh];
  glm::dmat4 world_from_object = scene_.scene().world_from_node(drawn.node);
  world_from_object[3] -= glm::dvec4(scene_.origin_ws(), 0.0);
  const glm::dmat4 clip_from_object =
      glm::dmat4(view.clip_from_view()) * glm::dmat4(view.view_from_world()) * world_from_object;
  const auto is_there = [&](const glm::vec3 &vertex) {
    const glm::dvec4 place = clip_from_object * glm::dvec4(vertex, 1.0);
    // The far plane has z = 0, the near plane z = w.
    return place.w > 0.0 && place.z <= place.w && std::abs(place.x) <= place.w && std::abs(place.y) <= place.w;
  };
  if (!mesh.host_shape) {
    // Vertices that no index names are not drawn.
    return std::ranges::all_of(mesh.indices, [&](std::uint32_t index) { return is_there(mesh.positions[index]); });
  }
  // The vertices are in buffers of the host.
  bool is_all_there = true;
  for (int corner = 0; corner < 8; corner++) {
    const glm::bvec3 is_max((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0);
    is_all_there &= is_there(glm::mix(mesh.bounds.min, mesh.bounds.max, is_max));
  }
  return is_all_there;
}

std::vector<scene::Handle<scene::Node>> Overlay::select(const draw::View &view, glm::ivec2 size_px,
                                                        std::span<const glm::dvec2> polygon_px, Reach reach,
                                                        Extent extent)
{
  check_up_to_date();
  check_finite(polygon_px);
  const gpu::Rectangle region = pixels_around(polygon_px, size_px);
  if (region.size_px.x == 0 || region.size_px.y == 0) {
    return {};
  }
  const auto is_any = [](draw::ObjectIndex /*object*/) { return true; };
  const std::vector<bool> is_found = objects_at(view, size_px, region, inside_of(polygon_px, region), reach, is_any);
  std::vector<scene::Handle<scene::Node>> nodes;
  std::unordered_set<scene::Handle<scene::Node>> known;
  for (draw::ObjectIndex object = draw::object_identity + 1; object < is_found.size(); object++) {
    if (is_found[object] && known.insert(scene_.object(object).node).second) {
      nodes.push_back(scene_.object(object).node);
    }
  }
  if (extent == Extent::Part || nodes.empty()) {
    return nodes;
  }
  const gpu::Rectangle picture{glm::ivec2(0), size_px};
  std::vector<std::uint8_t> outside = inside_of(polygon_px, picture);
  std::ranges::transform(outside, outside.begin(), [](std::uint8_t inside) { return std::uint8_t(1 - inside); });
  const auto is_candidate = [&](draw::ObjectIndex object) { return known.contains(scene_.object(object).node); };
  // Nodes that are wholly inside cover no pixel outside, so that the others show there.
  const std::vector<bool> reaches_out = objects_at(view, size_px, picture, outside, Reach::Through, is_candidate);
  for (draw::ObjectIndex object = draw::object_identity + 1; object < reaches_out.size(); object++) {
    if (scene_.objects().is_live(object) && is_candidate(object) &&
        (reaches_out[object] || !is_in_picture(view, object))) {
      known.erase(scene_.object(object).node);
    }
  }
  std::erase_if(nodes, [&](scene::Handle<scene::Node> node) { return !known.contains(node); });
  return nodes;
}

}  // namespace gnomon::overlay
