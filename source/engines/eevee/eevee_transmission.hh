// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_frame.hh"

/**
 * The steps of a frame for surfaces that transmit light. They read a copy of the picture without them; so one of them
 * is not seen through another. Internal to the engine.
 */
namespace gnomon::eevee {

/** Blended objects that are behind everything that transmits light, so that they are in the copy. */
[[nodiscard]] Need need_blend_behind(const FrameState &state);
void record_blend_behind(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

/** The copy, with the means of rough surfaces. */
[[nodiscard]] Need need_behind(const FrameState &state);
void copy_behind(FrameSample &sample);

/** The surfaces and their depth. */
[[nodiscard]] Need need_transmission(const FrameState &state);
void record_transmission(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

}  // namespace gnomon::eevee
