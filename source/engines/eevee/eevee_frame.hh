// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include "draw_view_shared.h"

#include <algorithm>
#include <span>

/**
 * The frame as an ordered list of steps. Drawing, timings, `--explain`, `--json` and serialize_passes all read this
 * list: a new pass is one entry here, and a member of PassList. For the engine's own files.
 */
namespace gnomon::eevee {

struct Data;
struct FramebufferList;
struct PassList;

/** What the needs of steps and passes depend on. */
struct FrameState {
  const Settings &settings;
  const Data &data;
};

/** Whether something is drawn, and the reason either way. */
struct Need {
  bool is_needed = false;
  std::string_view reason;
};

/** One sample being drawn. */
struct FrameSample {
  Data &data;
  const Settings &settings;
  draw::Viewport &viewport;
  /** Of the picture. */
  const draw::View &view;
  /** Moved within the pixels. */
  const draw::View &sample_view;
  /** Only the steps whose results are read back are drawn. */
  bool is_for_feedback = false;
};

/** Passes of one step share its target and its timing. */
struct FramePass {
  draw::Pass PassList::*pass;
  /** Why it draws. */
  std::string_view purpose;
  /** Why nothing was recorded into it. */
  std::string (*why_empty)(const FrameState &);
};

struct FrameStep {
  std::string_view name;
  /** Whether it is drawn for samples of the picture, or for draws that have a target. */
  enum class When { EachSample, EachTarget } when;
  /** Decided before each sample in which it may be drawn. */
  Need (*need)(const FrameState &);
  /** Names of the targets that it reads and writes, as reports have them. */
  std::span<const std::string_view> reads;
  std::span<const std::string_view> writes;
  /** Drawn in this order. */
  std::span<const FramePass> passes;
  /** Appends the step's render passes to \a list. */
  void (*record)(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);
  /** Called once the list is submitted, for steps whose results are relied on later; nullptr: nothing to do. */
  void (*submitted)(FrameSample &sample) = nullptr;
  /** The device reports its result back. */
  bool is_read_back = false;
};

/** In the order in which they are drawn. */
[[nodiscard]] std::span<const FrameStep> frame_steps();

/** Results of a step in the picture at hand, over its samples. */
struct StepRecord {
  Need need;
  struct PassRecord {
    /** Samples in which it drew anything. */
    std::uint64_t runs = 0;
    draw::RecordCounts counts;
  };
  /** One for each of the step's passes. */
  std::vector<PassRecord> passes;

  void reset()
  {
    need = {};
    std::ranges::fill(passes, PassRecord());
  }
};

/** Draw the steps of \a when that are needed, and store each one's need and counts in \a sample's data. */
void draw_steps(FrameSample &sample, FrameStep::When when);

/** The reason for a pass, from its record. */
[[nodiscard]] std::string reason_of(const FramePass &pass, const StepRecord::PassRecord &record,
                                    const FrameState &state);

/** Edge of a pixel at distance 1, or, orthographic, anywhere, metres. */
[[nodiscard]] float pixel_size(const draw::View &view, const draw::Viewport &viewport);

/** Content of view_block. */
[[nodiscard]] shared::ViewData view_data(const draw::View &view, int sample_count);

inline constexpr const char *nothing_seen = "nothing is seen";

/** Append a write of the entries of `light_block` for the lamp points at hand. */
void write_lamp_points(Data &data, gpu::CommandList &list);

/** Why no lamp has a shadow; \a no_such_lamp where shadows are on and some lamp gives light. */
[[nodiscard]] std::string_view why_no_shadow(const FrameState &state, std::string_view no_such_lamp);

/** Whether suns are fitted to depths, and the device has not reported those of \a view yet. */
[[nodiscard]] bool awaits_depths(const Data &data, const draw::View &view);

}  // namespace gnomon::eevee
