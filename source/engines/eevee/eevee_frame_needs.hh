// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_frame.hh"

/** When the steps of a frame are needed, and why. Internal to the engine. */
namespace gnomon::eevee {

inline constexpr std::string_view why_forward =
    "most meshes have textures or other inputs, shadows are exponential, or nothing gives light";
inline constexpr std::string_view all_in_gbuffer = "all objects are in the G-buffer";

/** Whether some objects are lit deferred. */
[[nodiscard]] bool has_gbuffer(const Data &data);

[[nodiscard]] Need need_lamp_points(const FrameState &state);
[[nodiscard]] Need need_light_clusters(const FrameState &state);
[[nodiscard]] Need need_shadows(const FrameState &state);
[[nodiscard]] Need need_gbuffer(const FrameState &state);
[[nodiscard]] Need need_deferred_lit(const FrameState &state);
/** Cascades are fitted to the depths of all objects. Otherwise those of forward objects follow deferred lighting. */
[[nodiscard]] Need need_depth(const FrameState &state);
[[nodiscard]] Need need_forward_depth(const FrameState &state);
[[nodiscard]] Need need_lit(const FrameState &state);
[[nodiscard]] Need need_background(const FrameState &state);
[[nodiscard]] Need need_blend(const FrameState &state);
/** A picture without visible objects and without a background is cleared once, with the first sample. */
[[nodiscard]] Need need_film(const FrameState &state);
[[nodiscard]] Need need_picture_depth(const FrameState &state);
[[nodiscard]] Need need_tonemap(const FrameState &state);

}  // namespace gnomon::eevee
