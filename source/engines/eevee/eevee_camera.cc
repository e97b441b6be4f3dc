// SPDX-License-Identifier: MIT
#include "eevee_camera.hh"

namespace gnomon::eevee {

draw::View with_sample_offset(const draw::View &view, glm::vec2 offset_px, glm::ivec2 size_px)
{
  // To move the samples, the image moves by the opposite offset. The offset in clip space is proportional to w.
  const glm::vec2 offset_clip = -2.0F * offset_px / glm::vec2(size_px);
  glm::mat4 clip_from_view = view.clip_from_view();
  for (int column = 0; column < 4; column++) {
    clip_from_view[column][0] += offset_clip.x * clip_from_view[column][3];
    clip_from_view[column][1] += offset_clip.y * clip_from_view[column][3];
  }
  return {view.view_from_world(), clip_from_view};
}

}  // namespace gnomon::eevee
