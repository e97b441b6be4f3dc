// SPDX-License-Identifier: MIT
#include "internal/eevee_probe.hh"
#include "internal/eevee_resource_report.hh"

namespace gnomon::eevee {

using gpu::State;

static constexpr std::array<const char *, 2> visibility_names = {"probe_position", "probe_normal"};
static constexpr std::array<const char *, 3> surface_names = {"surface_position", "surface_normal", "surface_albedo"};

SurfaceProbe::SurfaceProbe(draw::ObjectBuffer &objects, const RenderBuffers &buffers, const DepthPasses &depth,
                           const Transmission &transmission)
    : buffers_(buffers),
      depth_(depth),
      transmission_(transmission),
      visibility_pass_("probe_pass", State::WriteColor | State::DepthEqual, &objects),
      surfaces_pass_("surfaces_pass", State::WriteColor | State::DepthEqual, &objects)
{
}

void SurfaceProbe::make(draw::Viewport &viewport, const Settings &settings)
{
  gpu::Device &device = viewport.device();
  const auto make = [&](auto &textures, const auto &names, gpu::Framebuffer &framebuffer, const char *name) {
    gpu::FramebufferDesc desc{.name = name, .colors = {}, .depth = {&viewport.depth_texture()}};
    for (std::size_t i = 0; i < textures.size(); i++) {
      textures[i] = create_target(device, names[i], gpu::Format::RGBA32F, viewport.drawn_size_px());
      desc.colors.push_back({&textures[i]});
    }
    framebuffer = device.create_framebuffer(desc);
  };
  if (settings.has_probe && !visibility_fb_) {
    make(visibility_, visibility_names, visibility_fb_, "probe_fb");
  }
  if (settings.has_surfaces && !surfaces_fb_) {
    make(surfaces_, surface_names, surfaces_fb_, "surfaces_fb");
  }
}

void SurfaceProbe::resized()
{
  visibility_fb_ = {};
  surfaces_fb_ = {};
  visibility_ = {};
  surfaces_ = {};
}

void SurfaceProbe::clear()
{
  visibility_pass_.clear();
  surfaces_pass_.clear();
}

void SurfaceProbe::draw(const draw::View &view, const char *name, const draw::Pass &pass,
                        const gpu::Framebuffer &framebuffer, gpu::CommandList &list) const
{
  list.begin_pass("depth_prepass", buffers_.depth_fb, {});
  for (const FramePass &depth : depth_.passes()) {
    depth.pass->record(view, list);
  }
  transmission_.depths().pass->record(view, list);
  list.end_pass();
  list.begin_pass(name, framebuffer, {.depth_load = gpu::LoadAction::Load});
  pass.record(view, list);
  list.end_pass();
}

void SurfaceProbe::draw_visibility(const draw::View &view, int entry, gpu::CommandList &list)
{
  light_ = entry;
  draw(view, "probe", visibility_pass_, visibility_fb_, list);
}

void SurfaceProbe::draw_surfaces(const draw::View &view, gpu::CommandList &list) const
{
  draw(view, "surfaces", surfaces_pass_, surfaces_fb_, list);
}

void SurfaceProbe::report(ResourceReport &report) const
{
  const auto add = [&](const auto &textures, const auto &names, bool is_asked_for) {
    for (std::size_t i = 0; i < textures.size(); i++) {
      report.add_target(textures[i], names[i], "asked for", is_asked_for ? nothing_seen : not_asked_for);
    }
  };
  add(visibility_, visibility_names, report.settings.has_probe);
  add(surfaces_, surface_names, report.settings.has_surfaces);
}

}  // namespace gnomon::eevee
