// SPDX-License-Identifier: MIT
#include "draw_visible.hh"

#include <algorithm>

namespace gnomon::draw {

// It calculates as View::touches, without branches and with all planes in local variables, so that the compiler tests
// several volumes at once.
void test_volumes(const CullingPlanes &planes, const CullingArrays &volumes, std::vector<std::uint8_t> &is_touching)
{
  const auto [a, b, c, d, e, f] = planes;
  const float *const xs = volumes.x.data();
  const float *const ys = volumes.y.data();
  const float *const zs = volumes.z.data();
  const float *const reaches = volumes.reach.data();
  const std::size_t count = volumes.size();
  is_touching.resize(count);
  std::uint8_t *const results = is_touching.data();
  for (std::size_t i = 0; i < count; i++) {
    const float x = xs[i];
    const float y = ys[i];
    const float z = zs[i];
    const float lowest = -reaches[i];
    const auto below = [&](const glm::vec4 &plane) {
      return int(plane.x * x + plane.y * y + plane.z * z + plane.w < lowest);
    };
    results[i] = std::uint8_t(1 - (below(a) | below(b) | below(c) | below(d) | below(e) | below(f)));
  }
}

void VisibleObjects::update(const View &view, const ObjectBuffer &objects)
{
  if (objects_ == &objects && objects_revision_ == objects.revision() && view_ == view) {
    return;
  }
  test_volumes(view.culling_planes(), objects.culling_arrays(), is_visible_);
  const ObjectIndex hidden_end = std::min(view.hidden().index_end(), objects.index_end());
  for (ObjectIndex object = 0; object < hidden_end; object++) {
    is_visible_[object] = view.hidden().contains(object) ? 0 : is_visible_[object];
  }
  view_ = view;
  objects_ = &objects;
  objects_revision_ = objects.revision();
}

}  // namespace gnomon::draw
