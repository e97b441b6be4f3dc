// SPDX-License-Identifier: MIT
#include "internal/eevee_bodies.hh"

#include "eevee_bodies_shared.h"
#include "internal/eevee_background.hh"
#include "internal/eevee_caster_tree.hh"
#include "internal/eevee_resource_report.hh"
#include "render_materials.hh"

#include <fmt/format.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <numbers>
#include <utility>
#include <vector>

namespace gnomon::eevee {

namespace {

/** World space. */
struct Triangle {
  std::array<glm::vec3, 3> corners;
  std::array<glm::vec3, 3> normals;
  std::uint32_t material;
};

std::vector<Bodies::Body> bodies_of(const render_scene::RenderScene &render_scene,
                                    std::span<const TransmissiveObject> objects, const draw::ObjectSet &hidden)
{
  const scene::Scene &scene = render_scene.scene();
  std::vector<Bodies::Body> bodies;
  for (const TransmissiveObject &one : objects) {
    const scene::Handle<scene::Mesh> handle = render_scene.object(one.object).mesh;
    const scene::Mesh &mesh = scene.meshes()[handle];
    if (one.is_blended || hidden.contains(one.object) || mesh.topology != scene::Topology::Triangles ||
        mesh.positions.empty() || render_scene::is_masked(scene, mesh)) {
      continue;
    }
    bodies.push_back({.mesh = handle,
                      .shape = scene.meshes().revision(handle, scene::Mesh::Aspect::Shape),
                      .material = render_scene::MaterialTable::place_of(scene, mesh.material),
                      .world_from_object = render_scene.objects().world_from_object(one.object)});
  }
  return bodies;
}

void add_triangles(const scene::Scene &scene, const Bodies::Body &body, std::vector<Triangle> &triangles)
{
  const scene::Mesh &mesh = scene.meshes()[body.mesh];
  const glm::mat3 normals_ws = draw::normal_matrix(body.world_from_object);
  const bool is_mirrored = draw::is_mirrored(body.world_from_object);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle &triangle = triangles.emplace_back();
    triangle.material = body.material;
    for (std::size_t k = 0; k < 3; k++) {
      const std::uint32_t vertex = mesh.indices[i + (is_mirrored && k > 0 ? 3 - k : k)];
      triangle.corners[k] = glm::vec3(body.world_from_object * glm::vec4(mesh.positions[vertex], 1.0F));
      const glm::vec3 normal = vertex < mesh.normals.size() ? normals_ws * mesh.normals[vertex] : glm::vec3(0.0F);
      const float length = glm::length(normal);
      triangle.normals[k] = length > 0.0F ? normal / length : glm::vec3(0.0F);
    }
  }
}

/** \see eevee_bodies_shared.h */
void write(const BoxTree &tree, std::span<const Triangle> triangles, std::vector<glm::vec4> &texels)
{
  const std::span<const BoxTree::Node> nodes = tree.nodes();
  std::vector<std::uint32_t> ends(nodes.size(), std::uint32_t(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); i++) {
    const BoxTree::Node &node = nodes[i];
    if (node.count == 0) {
      ends[i + 1] = node.next;
      ends[node.next] = ends[i];
    }
    const std::uint32_t leaf = node.count > 0 ? node.next * BODY_LEAF + node.count : 0;
    texels.emplace_back(node.box.min, float(ends[i]));
    texels.emplace_back(node.box.max, float(leaf));
  }
  for (const std::uint32_t item : tree.items()) {
    const Triangle &triangle = triangles[item];
    texels.emplace_back(triangle.corners[0], float(triangle.material));
    texels.emplace_back(triangle.corners[1] - triangle.corners[0], 0.0F);
    texels.emplace_back(triangle.corners[2] - triangle.corners[0], 0.0F);
    for (const glm::vec3 &normal : triangle.normals) {
      texels.emplace_back(normal, 0.0F);
    }
  }
}

}  // namespace

void Bodies::update(const render_scene::RenderScene &scene, std::span<const TransmissiveObject> objects,
                    const draw::ObjectSet &hidden, const Settings &settings, const SceneWorld &world,
                    const draw::TextureBinding &stand_in)
{
  gpu::Device &device = scene.device();
  const float turn = world.picture() ? scene.scene().world()->rotation / (2.0F * std::numbers::pi_v<float>) : 0.0F;
  picture_binding_ =
      world.picture() ? draw::TextureBinding{world.picture().id(), world.picture_sampler().id()} : stand_in;
  Key key{bodies_of(scene, objects, hidden), device.loss_count()};
  const Head background{background_color(settings, scene), {0.0F, turn, world.picture() ? 1.0F : 0.0F, 0.0F}};
  if (texels_ && key_ == key) {
    write_head(device, background);
    return;
  }
  key_.reset();
  std::size_t count = 0;
  for (const Body &body : key.bodies) {
    count += scene.scene().meshes()[body.mesh].indices.size() / 3;
  }
  // A tree has fewer nodes than items.
  const auto texels_max = std::size_t(device.limits().buffer_texels_max) - BODY_HEAD_TEXELS;
  const std::size_t triangles_max =
      std::min(texels_max / (BODY_TRIANGLE_TEXELS + BODY_NODE_TEXELS), std::size_t(BODY_TRIANGLE_MAX));
  left_out_ = count > triangles_max ? count : 0;
  std::vector<Triangle> triangles;
  if (left_out_ == 0) {
    triangles.reserve(count);
    for (const Body &body : key.bodies) {
      add_triangles(scene.scene(), body, triangles);
    }
  }
  triangle_count_ = triangles.size();
  std::vector<scene::Bounds> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle &triangle : triangles) {
    const auto &[a, b, c] = triangle.corners;
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  const BoxTree tree(boxes);
  node_count_ = tree.nodes().size();
  std::vector<glm::vec4> texels(BODY_HEAD_TEXELS);
  write(tree, triangles, texels);
  const int width = std::min(int(std::bit_ceil(texels.size())), device.limits().buffer_texels_max);
  texels.resize(std::size_t(width));
  if (!texels_ || texels_.desc().width != width) {
    texels_ = device.create_texture(
        {.name = "bodies", .kind = gpu::TextureKind::Buffer, .format = gpu::Format::RGBA32F, .width = width});
  }
  if (!sampler_) {
    sampler_ = device.create_sampler({.name = "bodies_sampler"});
  }
  device.upload(texels_, 0, std::as_bytes(std::span(texels)));
  texels_binding_ = {texels_.id(), sampler_.id()};
  head_.reset();
  write_head(device, background);
  key_ = std::move(key);
}

void Bodies::write_head(gpu::Device &device, Head head)
{
  head[1].x = float(node_count_);
  if (head_ != head) {
    // The texels after it keep their content.
    device.upload(texels_, 0, std::as_bytes(std::span(head)));
    head_ = head;
  }
}

void Bodies::free()
{
  texels_ = {};
  triangle_count_ = left_out_ = 0;
}

void Bodies::bind(draw::ShadingGroup &group) const
{
  group.bind_texture_ref("bodies", &texels_binding_);
  group.bind_texture_ref("world_picture", &picture_binding_);
}

void Bodies::report(ResourceReport &report) const
{
  const std::string purpose =
      left_out_ > 0 ? fmt::format("the background alone: {} triangles exceed the limit of the device", left_out_)
                    : fmt::format("{} triangles of surfaces that transmit light", triangle_count_);
  report.add_target(texels_, "bodies", purpose, report.why_no_feature(Feature::Transmission));
}

}  // namespace gnomon::eevee
