// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamp_points.hh"
#include "eevee_settings.hh"
#include "eevee_shaders.hh"
#include "internal/eevee_frame_check.hh"

#include "draw_pass.hh"
#include "draw_viewport.hh"
#include "render_scene.hh"

#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

/**
 * The frame as an ordered list of steps. Drawing, timings, `--explain`, `--json` and serialize_passes all read this
 * list. A step is described by the module that draws it; eevee_engine_data.cc has their order. Internal to the engine.
 */
namespace gnomon::eevee {

struct ResourceReport;

/** The state from which the needs of steps and passes are decided, beside that of their modules. */
struct FrameState {
  const Settings &settings;
  /** Features that the programs of the frame have. */
  Feature features = Feature::None;
  /** An object or a background was visible in at least one sample of the current picture. */
  bool is_seen = false;
  /** A surface that transmits light is in the view of the current sample. */
  bool is_transmission_seen = false;
  /** A material that is drawn transmits light. */
  bool has_transmission = false;
  /** A sun has the cascades that Settings::has_cascade_tint shows. */
  bool has_tinted_light = false;
  /** Lamps have other points in each sample. */
  bool has_lamp_points = false;
  /** Objects cast other shadows in each sample, because they are blended. */
  bool has_blended_casters = false;
  /** Converged pixels of the current picture are skipped. \see AdaptiveSampling */
  bool skips_converged = false;
};

/** Whether a step is needed, and the reason why it is or is not. */
struct Need {
  bool is_needed = false;
  std::string_view reason;
};

struct DrawnStep;

/** The sample that is being drawn. */
struct FrameSample : FrameState {
  draw::Viewport &viewport;
  /** The view of the picture and its guard band. */
  const draw::View &view;
  /** The view from the sample's point of the lens. */
  const draw::View &eye_view;
  /** The view from there, with the sample's offset within the pixel. */
  const draw::View &sample_view;
  /** The bounds of the scene, world space. */
  const scene::Bounds &bounds_ws;
  /** The number of the sample in the picture, from 0. */
  int index = 0;
  /** The visible objects of the view that was recorded last. */
  draw::VisibleObjects &visible;
  /** If true, only the steps with `is_read_back` are drawn. */
  bool is_for_feedback = false;
  /** Suns are fitted to depths, and the host does not have those of `view` yet. */
  bool awaits_depths = false;
  /** Set by the step lamp_points. Empty where no lamp has a point of its own. */
  std::span<const LampPoint> lamp_points{};
  /** The step that is being drawn. */
  DrawnStep *step = nullptr;

  /** The region that steps before the transmission of light draw: all, where that reads other pixels. */
  [[nodiscard]] gpu::Rectangle read_region() const
  {
    return is_transmission_seen ? gpu::Rectangle() : viewport.part_region();
  }
};

/** A pass of a step. The passes of one step share a target and a timer. */
struct FramePass {
  const draw::Pass *pass;
  /** The reason to draw the pass, for reports. */
  std::string_view purpose;
  /** The reason why the pass has no calls, for reports. Empty: nothing is seen. */
  std::function<std::string_view(const FrameState &)> why_empty{};
};

/** A texture or a buffer that a step reads, and that another step writes. */
struct FrameRead {
  // NOLINTNEXTLINE(google-explicit-constructor)
  FrameRead(const char *read, std::string_view group_name = {}, std::function<bool(const FrameState &)> condition = {})
      : name(read), group(group_name), when(std::move(condition))
  {
  }
  std::string_view name;
  /**
   * A list binds all reads of a group or none of them: programs without lighting bind none. Empty: each list that draws
   * binds it.
   */
  std::string_view group;
  /** The condition under which lists bind it. Empty: always. */
  std::function<bool(const FrameState &)> when;
};

struct FrameStep {
  std::string_view name;
  /** Markdown for doc/frame.md. */
  std::string_view summary;
  /** EachSample: drawn with each sample of the picture. EachTarget: drawn with each draw that has a target. */
  enum class When { EachSample, EachTarget } when = When::EachSample;
  /**
   * The time of a step in a sample that is drawn in parts. First: with its first part. Rows: with each part, the rows
   * of which it draws, if any. Each: with each part, because another viewport may have drawn between two parts. Last:
   * after all rows.
   */
  enum class Part { First, Rows, Each, Last } part;
  /** Decides whether the step is drawn. Called before each sample or target. */
  std::function<Need(const FrameState &)> need;
  /**
   * The reads of the step, and the names of textures and buffers that it writes. "target" stands for the attachments of
   * the draw's target. Builds with assertions check both lists. \see FrameCheck
   */
  std::vector<FrameRead> reads{};
  std::vector<std::string_view> writes{};
  /** In the order in which they are drawn. */
  std::vector<FramePass> passes{};
  /** Appends the step's render passes to the list. May be empty. */
  std::function<void(FrameSample &, gpu::CommandList &)> record{};
  /** Called after the submission of the list. May be empty. */
  std::function<void(FrameSample &)> submitted{};
  /** The result of the step is read back to the host. */
  bool is_read_back = false;
  /** Work on the device that command lists cannot hold, after the list. May be empty. */
  std::function<void(FrameSample &)> work{};
};

/** A step, and its work in the samples of the current picture. */
struct DrawnStep {
  FrameStep step;
  /** Empty before the first sample. It is needed if at least one sample needed it. */
  std::optional<Need> need{};
  struct PassRecord {
    /** Number of samples, or parts of samples, in which the pass drew at least one call. */
    std::uint64_t runs = 0;
    draw::RecordCounts counts;
  };
  /** One entry for each of FrameStep::passes. */
  std::vector<PassRecord> passes{};
  /** Empty unless the step was timed. */
  gpu::TimerQuery query{};
  /** The step was timed since the last call of Inspection::take_step_times. */
  bool is_pending = false;
  /** The last result of Inspection::take_step_times; empty if the backend measures no times (null backend). */
  std::optional<double> taken_seconds{};

  /** The need in the current picture, or in one that begins with \a state. */
  [[nodiscard]] Need need_in(const FrameState &state) const
  {
    return need ? *need : step.need(state);
  }
};

/** The steps of a viewport's frame, in the order in which they are drawn. */
class Frame {
 public:
  explicit Frame(std::vector<FrameStep> steps);

  void begin_picture();
  /** \see draw::Pass::is_current */
  [[nodiscard]] bool is_current(const gpu::Device &device) const;
  /** Draw the needed steps of \a when, and keep the need and the counts of each step. */
  void draw(FrameSample &sample, FrameStep::When when);
  [[nodiscard]] const std::vector<DrawnStep> &steps() const
  {
    return steps_;
  }
  /** \see Inspection::take_step_times */
  [[nodiscard]] std::vector<DrawnStep> &timed_steps()
  {
    return steps_;
  }

 private:
  std::vector<DrawnStep> steps_;
  /** Used in builds with assertions. */
  FrameCheck check_;
};

/** Append the visible calls of the current step's passes to \a list, and count them. */
void record_calls(FrameSample &sample, const draw::View &view, gpu::CommandList &list);

/** Append a render pass that draws the calls of the step's passes that are visible in the sample's view. */
void record_pass(FrameSample &sample, gpu::CommandList &list, const gpu::Framebuffer &framebuffer,
                 const gpu::PassActions &actions);

/** Actions of a render pass that keeps the content of its attachments. */
[[nodiscard]] inline gpu::PassActions drawn_over(const gpu::Rectangle &scissor = {})
{
  return {.color_load = gpu::LoadAction::Load, .depth_load = gpu::LoadAction::Load, .scissor = scissor};
}

/** The reason why \a pass was drawn or not, for reports. */
[[nodiscard]] std::string_view reason_of(const FramePass &pass, const DrawnStep::PassRecord &record,
                                         const FrameState &state);

inline gpu::Texture create_target(gpu::Device &device, const char *name, gpu::Format format, glm::ivec2 size_px)
{
  return device.create_texture({.name = name, .format = format, .width = size_px.x, .height = size_px.y});
}

/** Binds the resources that a program with lighting reads, except the textures of the material. */
using BindLit = std::function<void(draw::ShadingGroup &)>;

/** FrameStep::reads of deferred lighting. */
[[nodiscard]] std::vector<FrameRead> deferred_reads();
/** FrameStep::reads of a step that draws and lights surfaces; \a more: what it reads besides. */
[[nodiscard]] std::vector<FrameRead> forward_reads(std::initializer_list<FrameRead> more = {});

inline constexpr const char *nothing_seen = "nothing is seen";
inline constexpr const char *no_full_material = "no material that is drawn needs more than a base colour texture";
inline constexpr std::string_view why_forward =
    "most meshes have textures or other inputs, plain objects cast no shadow, shadows are exponential, or nothing "
    "gives light";
inline constexpr std::string_view all_in_gbuffer = "all objects are in the G-buffer";

/** The reason why no lamp has a shadow: \a no_such_lamp if shadows are enabled and at least one lamp gives light. */
[[nodiscard]] std::string_view why_no_shadow(const FrameState &state, std::string_view no_such_lamp);

}  // namespace gnomon::eevee
