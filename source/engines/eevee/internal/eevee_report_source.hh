// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "eevee_frame_tree.hh"
#include "internal/eevee_engine_data.hh"
#include "internal/eevee_frame.hh"

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

/** Parts of Inspection::report: its input state, and the reasons that it gives. Internal to the engine. */
namespace gnomon::eevee {

inline constexpr const char *no_target = "no target was given";

/** The state from which reports are made. */
struct ReportSource {
  render_scene::RenderScene &render_scene;
  const ShaderCache &shaders;
  const Settings &settings;
  const Data &data;
  draw::Viewport &viewport;

  [[nodiscard]] const gpu::Device &device() const
  {
    return viewport.device();
  }
  [[nodiscard]] const scene::Scene &scene() const
  {
    return render_scene.scene();
  }
  [[nodiscard]] const scene::Mesh &mesh(draw::ObjectIndex object) const
  {
    return scene().meshes()[render_scene.object(object).mesh];
  }
  [[nodiscard]] bool has(Feature feature) const
  {
    return eevee::has(data.features, feature);
  }
};

/** A node with children. It is made if at least one child is made. Its bytes and seconds are the sums of theirs. */
[[nodiscard]] FrameNode folder(std::string what, std::string why, std::string why_not, std::vector<FrameNode> children);

/** The images that the materials of drawable objects read. The bool is true for colours and false for data. */
[[nodiscard]] std::set<std::pair<scene::Handle<scene::Image>, scene::ImageUse>> read_images(const ReportSource &source);

/** \see why_no_shadow in eevee_frame.hh */
[[nodiscard]] std::string why_no_shadow(const ReportSource &source, std::string_view no_such_lamp);
/** The reason why a mesh is drawn without a texture of its material; empty if it is drawn with the texture. */
[[nodiscard]] std::string why_no_texture(const scene::Mesh &mesh, const scene::TextureInput &input,
                                         const scene::TextureSlot &slot);
/** The reason why no program has \a feature. \pre no program has it */
[[nodiscard]] std::string why_no_feature(const ReportSource &source, Feature feature);
/** The reason why no variant of a program was created. \pre no variant was created */
[[nodiscard]] std::string why_no_program(const ReportSource &source, ShaderId id);

// Nodes of the report for resources on the device.

/** Textures, and blocks. */
[[nodiscard]] std::array<FrameNode, 2> resource_nodes(const ReportSource &source);
[[nodiscard]] FrameNode mesh_nodes(const ReportSource &source);
[[nodiscard]] FrameNode texture_nodes(const ReportSource &source);

}  // namespace gnomon::eevee
