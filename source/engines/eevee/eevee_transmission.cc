// SPDX-License-Identifier: MIT
#include "eevee_transmission.hh"

#include "eevee_engine_data.hh"

#include <algorithm>
#include <bit>

namespace gnomon::eevee {

void make_behind(Data &data, const draw::Viewport &viewport)
{
  gpu::Device &device = viewport.device();
  TextureList &txl = data.txl;
  const glm::ivec2 size_px = viewport.drawn_size_px();
  const int levels = data.stl.is_transmission_rough ? std::bit_width(unsigned(std::max(size_px.x, size_px.y))) : 1;
  if (txl.behind && txl.behind.desc().mip_levels == levels) {
    return;
  }
  txl.behind = device.create_texture({.name = "behind",
                                      .format = txl.radiance.desc().format,
                                      .width = size_px.x,
                                      .height = size_px.y,
                                      .mip_levels = levels});
  txl.behind_sampler =
      device.create_sampler({.name = "behind_sampler", .filter = gpu::Filter::Linear, .mip = gpu::MipFilter::Nearest});
}

/** The need of a step that is needed if \a is_needed and something in the view transmits light. */
static Need need_of(const FrameState &state, bool is_needed, std::string_view why, std::string_view why_not)
{
  if (!state.data.is_seen) {
    return {false, nothing_seen};
  }
  if (!state.data.is_transmission_seen) {
    return {false, state.data.stl.transmissive.empty() ? "no material that is drawn transmits light"
                                                       : "nothing in the view transmits light"};
  }
  return {is_needed, is_needed ? why : why_not};
}

Need need_blend_behind(const FrameState &state)
{
  return need_of(state, !state.data.psl->blend_pass.is_empty() && !state.data.stl.groups_behind.empty(),
                 "blended objects that are seen through others",
                 "no blended object is behind all that transmits light");
}

void record_blend_behind(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  StorageList &stl = sample.data.stl;
  draw::Pass &pass = sample.data.psl->blend_pass;
  pass.set_order(stl.groups_behind);
  record_pass(step, sample, list, sample.data.fbl.main_fb,
              {.color_load = gpu::LoadAction::Load, .depth_load = gpu::LoadAction::Load});
  pass.set_order(stl.groups_in_front);
}

Need need_behind(const FrameState &state)
{
  return need_of(state, true, "what is behind surfaces that transmit light", "");
}

void copy_behind(FrameSample &sample)
{
  const TextureList &txl = sample.data.txl;
  gpu::Device &device = sample.viewport.device();
  device.copy_layers(txl.radiance, txl.behind);
  if (txl.behind.desc().mip_levels > 1) {
    device.generate_mipmaps(txl.behind);
  }
}

Need need_transmission(const FrameState &state)
{
  return need_of(state, !state.data.psl->transmission_pass.is_empty(), "surfaces that transmit light",
                 "all that transmits light is blended");
}

void record_transmission(const FrameStep &step, FrameSample &sample, gpu::CommandList &list)
{
  record_pass(step, sample, list, sample.data.fbl.main_fb,
              {.color_load = gpu::LoadAction::Load,
               .depth_load = gpu::LoadAction::Load,
               .scissor = sample.viewport.part_region()});
}

}  // namespace gnomon::eevee
