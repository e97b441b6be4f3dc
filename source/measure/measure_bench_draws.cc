// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include "draw_view_shared.h"

#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::measure {

DrawSeconds measure_draws(gpu::Device &device, int draw_count, int rounds)
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
  gpu::BufferRange object_block;
  draw::Pass pass("depth_pass", gpu::State::WriteDepth, &objects);
  const draw::View view;
  DrawSeconds seconds;
  for (int round = 0; round <= rounds; round++) {
    for (draw::ObjectIndex i = objects.index_end() - 1; i > draw::object_identity; i--) {
      objects.remove(i);
    }
    const double start = now(Clock::ThreadCpu);
    pass.clear();
    draw::ShadingGroup &group = pass.group(shader);
    group.bind_uniform("view_block", view_block);
    group.bind_storage_ref("object_block", &object_block);
    for (std::size_t i = 0; i < std::size_t(draw_count); i++) {
      group.call(batches[i % bench_mesh_count], matrices[i]);
    }
    objects.upload(device);
    object_block = {objects.buffer().id()};
    const double called = now(Clock::ThreadCpu);
    gpu::CommandList list;
    list.begin_pass("depth_prepass", framebuffer, {});
    pass.record(view, list);
    list.end_pass();
    device.submit(list);
    const double submitted = now(Clock::ThreadCpu);
    // The first warms up.
    if (round > 0) {
      seconds.recorded.push_back((called - start) / draw_count);
      seconds.submitted.push_back((submitted - called) / draw_count);
      seconds.sum.push_back((submitted - start) / draw_count);
    }
  }
  return seconds;
}

}  // namespace gnomon::measure
