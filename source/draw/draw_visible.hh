// SPDX-License-Identifier: MIT
#pragma once

#include "draw_objects.hh"
#include "draw_view.hh"

#include <cstdint>
#include <vector>

namespace gnomon::draw {

/** Write whether each volume touches the frustum of \a planes, as View::touches: 1 or 0. Resizes \a is_touching. */
void test_volumes(const CullingPlanes &planes, const CullingArrays &volumes, std::vector<std::uint8_t> &is_touching);

/**
 * The objects of an ObjectBuffer whose culling volumes touch the frustum of a view. Several passes that are recorded
 * for one view share one set, so that each object is tested once.
 */
class VisibleObjects {
 public:
  /** Test all objects, unless the view and the objects are those of the last update. */
  void update(const View &view, const ObjectBuffer &objects);

  /**
   * Whether View::touches the volume of the object, and View::hidden lacks it. True for indices that did not exist
   * at the last update.
   */
  [[nodiscard]] bool contains(ObjectIndex object) const
  {
    return object >= is_visible_.size() || is_visible_[object] != 0;
  }

 private:
  View view_;
  /** The objects of the last update and their revision. nullptr: there was none. */
  const ObjectBuffer *objects_ = nullptr;
  std::uint64_t objects_revision_ = 0;
  /** By object index: 1 or 0. Bytes, because the compiler writes several results at once. */
  std::vector<std::uint8_t> is_visible_;
};

}  // namespace gnomon::draw
