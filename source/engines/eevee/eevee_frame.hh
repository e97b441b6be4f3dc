// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "eevee_lamp_points.hh"

#include "draw_view_shared.h"

#include <algorithm>
#include <span>

/**
 * The frame as an ordered list of steps. Drawing, timings, `--explain`, `--json` and serialize_passes all read this
 * list. A new pass needs one entry in the list and one member of PassList. Internal to the engine.
 */
namespace gnomon::eevee {

struct Data;
struct FramebufferList;
struct PassList;

/** The state from which the needs of steps and passes are decided. */
struct FrameState {
  const Settings &settings;
  const Data &data;
};

/** Whether a step is needed, and the reason why it is or is not. */
struct Need {
  bool is_needed = false;
  std::string_view reason;
};

/** The sample that is being drawn. */
struct FrameSample {
  Data &data;
  const Settings &settings;
  draw::Viewport &viewport;
  /** The view of the picture and its guard band, without the sample's offset. */
  const draw::View &view;
  /** The view with the sample's offset within the pixel. */
  const draw::View &sample_view;
  /** If true, only the steps with `is_read_back` are drawn. */
  bool is_for_feedback = false;
  /** Set by the step lamp_points. Empty where no lamp has a point of its own. */
  SampledLampPoints lamp_points{};
};

/** A pass of a step. The passes of one step share a target and a timer. */
struct FramePass {
  draw::Pass PassList::*pass;
  /** The reason to draw the pass, for reports. */
  std::string_view purpose;
  /** Returns the reason why the pass has no calls, for reports. */
  std::string (*why_empty)(const FrameState &);
};

struct FrameStep {
  std::string_view name;
  /** EachSample: drawn with each sample of the picture. EachTarget: drawn with each draw that has a target. */
  enum class When { EachSample, EachTarget } when;
  /**
   * The time of a step in a sample that is drawn in parts. First: with its first part. Rows: with each part, the rows
   * of which it draws, if any. Each: with each part, because another viewport may have drawn between two parts. Last:
   * after all rows.
   */
  enum class Part { First, Rows, Each, Last } part;
  /** Decides whether the step is drawn. Called before each sample or target. */
  Need (*need)(const FrameState &);
  /** Names of the resources that the step reads and writes, as in reports. */
  std::span<const std::string_view> reads;
  std::span<const std::string_view> writes;
  /** In the order in which they are drawn. */
  std::span<const FramePass> passes;
  /** Appends the step's render passes to \a list. */
  void (*record)(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);
  /** Called after the submission of the list; may be nullptr. */
  void (*submitted)(FrameSample &sample) = nullptr;
  /** The result of the step is read back to the host. */
  bool is_read_back = false;
  /** Work on the device that command lists cannot hold, after the list; may be nullptr. */
  void (*work)(FrameSample &sample) = nullptr;
};

/** All steps, in the order in which they are drawn. */
[[nodiscard]] std::span<const FrameStep> frame_steps();

/** Whether \a part of a sample draws a step with \a step. */
[[nodiscard]] bool is_in_part(FrameStep::Part step, const draw::SamplePart &part);

/** Record of a step over the samples of the current picture. */
struct StepRecord {
  Need need;
  struct PassRecord {
    /** Number of samples, or parts of samples, in which the pass drew at least one call. */
    std::uint64_t runs = 0;
    draw::RecordCounts counts;
  };
  /** One entry for each of FrameStep::passes. */
  std::vector<PassRecord> passes;

  void reset()
  {
    need = {};
    std::ranges::fill(passes, PassRecord());
  }
};

/** Draw the needed steps of \a when, and store the need and the counts of each step in Data::frame. */
void draw_steps(FrameSample &sample, FrameStep::When when);

/** Append a render pass that draws the calls of the step's passes that are visible in the sample's view. */
void record_pass(const FrameStep &step, FrameSample &sample, gpu::CommandList &list,
                 const gpu::Framebuffer &framebuffer, const gpu::PassActions &actions);

/** Set the filter weights of the sample, which the passes of the film read. */
void update_film_weights(FrameSample &sample);

/** The reason why \a pass was drawn or not, for reports. */
[[nodiscard]] std::string reason_of(const FramePass &pass, const StepRecord::PassRecord &record,
                                    const FrameState &state);

/** Edge of a pixel, metres: at a distance of 1 m for perspective views, at any distance for orthographic views. */
[[nodiscard]] float pixel_size(const draw::View &view, const draw::Viewport &viewport);

/** The view of the \a index-th sample of the picture. \a drawn_view: of the picture and its guard band. */
[[nodiscard]] draw::View view_of_sample(const draw::View &drawn_view, const draw::Viewport &viewport,
                                        const Settings &settings, int index);

/** The content of `view_block`. \a bounds_ws: of the scene. */
[[nodiscard]] shared::ViewData view_data(const draw::View &view, const Settings &settings, int sample_index,
                                         const scene::Bounds &bounds_ws);

inline constexpr const char *nothing_seen = "nothing is seen";

/** The reason why no lamp has a shadow: \a no_such_lamp if shadows are enabled and at least one lamp gives light. */
[[nodiscard]] std::string_view why_no_shadow(const FrameState &state, std::string_view no_such_lamp);

/** Whether suns are fitted to depths and the host does not have the depths of \a view yet. */
[[nodiscard]] bool awaits_depths(const Data &data, const draw::View &view);

}  // namespace gnomon::eevee
