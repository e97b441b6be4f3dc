// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "eevee_engine_data.hh"
#include "eevee_frame.hh"

#include <set>
#include <string>
#include <utility>
#include <vector>

/** Parts of Engine::report: the state that it reads, and reasons. For the engine's own files. */
namespace gnomon::eevee {

inline constexpr const char *no_target = "no target was given";
inline constexpr const char *no_full_material = "no material that is drawn needs more than a base colour texture";

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
    return eevee::has(data.stl.features, feature);
  }
};

/** A node of which any child is made is made, too; its bytes and seconds are the sums of theirs. */
[[nodiscard]] FrameNode folder(std::string what, std::string why, std::string why_not, std::vector<FrameNode> children);

/** The images that materials of drawable objects read, and whether for colours. */
[[nodiscard]] std::set<std::pair<scene::Handle<scene::Image>, bool>> read_images(const ReportSource &source);

[[nodiscard]] std::string why_no_shadow(const ReportSource &source, std::string_view no_such_lamp);
/** Why a mesh is drawn without a texture of its material; empty: it is drawn with it. */
[[nodiscard]] std::string why_no_texture(const scene::Mesh &mesh, const scene::TextureInput &input,
                                         const scene::TextureSlot &slot);
[[nodiscard]] std::string why_no_feature(const ReportSource &source, Feature feature);
/** Why no variant of a program was made. \pre none was */
[[nodiscard]] std::string why_no_program(const ReportSource &source, ShaderId id);

// Nodes of the frame's tree for what is on the device.

[[nodiscard]] FrameNode target_nodes(const ReportSource &source);
[[nodiscard]] FrameNode block_nodes(const ReportSource &source);
[[nodiscard]] FrameNode mesh_nodes(const ReportSource &source);
[[nodiscard]] FrameNode texture_nodes(const ReportSource &source);

}  // namespace gnomon::eevee
