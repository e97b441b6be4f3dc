// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include "eevee_shaders.hh"

#include "draw_pass.hh"
#include "draw_view_shared.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace gnomon::measure {

std::vector<PartCost> measure_record(gpu::Device &device, int draw_count, int rounds)
{
  const std::vector<gpu::Batch> batches = column_batches(device);
  const gpu::Texture texture = device.create_texture({.name = "depth", .format = gpu::Format::Depth32F});
  const gpu::Framebuffer framebuffer =
      device.create_framebuffer({.name = "depth", .colors = {}, .depth = {.texture = &texture}});
  eevee::ShaderCache shaders;
  const gpu::Shader &shader = shaders.get(device, eevee::ShaderId::Depth);
  std::vector<glm::mat4> matrices;
  for (int i = 0; i < draw_count; i++) {
    const glm::vec3 axis(1.0F, float(i % 7), float(i % 3));
    matrices.push_back(glm::rotate(glm::translate(glm::mat4(1.0F), glm::vec3(i % 100, i / 100, 0)), float(i), axis));
  }
  const gpu::Buffer view_block =
      device.create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
  draw::ObjectBuffer objects;
  draw::Pass pass("depth_pass", gpu::State::WriteDepth, &objects);
  gpu::CommandList list;
  std::vector<glm::mat4> plain_matrices;
  gpu::CommandList plain;
  const auto draw = [&](const draw::View &view) {
    list.clear();
    list.begin_pass("depth_prepass", framebuffer, {});
    pass.record(view, list);
    list.end_pass();
    device.submit(list);
  };
  std::vector<PartCost> costs = {{"matrices and draws written to plain arrays"},
                                 {"recorded in a pass"},
                                 {"pass drawn for another view"},
                                 {"pass drawn again"}};
  for (int round = 0; round <= rounds; round++) {
    for (draw::ObjectIndex i = objects.index_end() - 1; i > draw::object_identity; i--) {
      objects.remove(i);
    }
    std::vector<double> times = {now(Clock::ThreadCpu)};
    plain_matrices.clear();
    plain.clear();
    for (std::size_t i = 0; i < std::size_t(draw_count); i++) {
      const gpu::BatchRange &range = batches[i % bench_mesh_count].range();
      plain_matrices.push_back(matrices[i]);
      plain.instances.push_back({std::uint32_t(i), 0});
      plain.draws.push_back({range.index_count, 1, range.first_index, range.base_vertex, std::uint32_t(i)});
    }
    times.push_back(now(Clock::ThreadCpu));
    pass.clear();
    draw::ShadingGroup &group = pass.group(shader);
    group.bind_uniform("view_block", view_block);
    for (std::size_t i = 0; i < std::size_t(draw_count); i++) {
      group.call(batches[i % bench_mesh_count], matrices[i]);
    }
    objects.upload(device);
    times.push_back(now(Clock::ThreadCpu));
    const draw::View view;
    draw(view);
    times.push_back(now(Clock::ThreadCpu));
    draw(view);
    times.push_back(now(Clock::ThreadCpu));
    // The first warms up.
    for (std::size_t i = 0; round > 0 && i < costs.size(); i++) {
      costs[i].seconds.push_back((times[i + 1] - times[i]) / draw_count);
    }
  }
  return costs;
}

std::vector<PartCost> measure_cull(int box_count, int rounds)
{
  // A camera within a lattice of boxes, so that many are on both sides of each plane.
  const int edge = int(std::ceil(std::cbrt(double(box_count))));
  draw::ObjectBuffer objects;
  for (int i = 0; i < box_count; i++) {
    const glm::vec3 center(i % edge, i / edge % edge, i / (edge * edge));
    objects.add(glm::translate(glm::mat4(1.0F), center), 0, {center, 0.5F});
  }
  const glm::vec3 middle(0.5F * float(edge));
  const glm::mat4 clip_from_view = draw::perspective(0.6F, 0.4F, 0.1F, float(edge));
  std::vector<PartCost> costs = {{"one by one"}, {"together"}};
  draw::VisibleObjects visible;
  std::vector<bool> is_visible(objects.index_end());
  for (int round = 0; round <= rounds; round++) {
    const draw::View view(glm::lookAt(middle, middle + glm::vec3(std::cos(float(round)), std::sin(float(round)), 0.1F),
                                      glm::vec3(0, 0, 1)),
                          clip_from_view);
    std::vector<double> times = {now(Clock::ThreadCpu)};
    for (draw::ObjectIndex i = 0; i < objects.index_end(); i++) {
      is_visible[i] = view.touches(objects.volume(i));
    }
    times.push_back(now(Clock::ThreadCpu));
    visible.update(view, objects);
    times.push_back(now(Clock::ThreadCpu));
    // The first warms up.
    for (std::size_t i = 0; round > 0 && i < costs.size(); i++) {
      costs[i].seconds.push_back(times[i + 1] - times[i]);
    }
  }
  return costs;
}

}  // namespace gnomon::measure
