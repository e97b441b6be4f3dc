// SPDX-License-Identifier: MIT
#pragma once

#include "view_picture_map.hh"

#include "overlay.hh"
#include "scene.hh"

#include <functional>
#include <span>
#include <vector>

namespace gnomon::view {

/**
 * Lines that show the visible lamps and cameras of \a scene in the picture of \a map: the size of point lamps, the
 * direction of suns, the cone of spots, the surface of area lamps, the frame of cameras. The \a selected nodes are
 * highlighted. Parts without a size in the scene have a constant size on the screen. A camera at the picture's eye is
 * left out, and so are nodes that \a is_shown refuses.
 */
[[nodiscard]] std::vector<overlay::Line> icon_lines(const scene::Scene &scene, const PictureMap &map,
                                                    std::span<const scene::Handle<scene::Node>> selected,
                                                    const std::function<bool(scene::Handle<scene::Node>)> &is_shown);

}  // namespace gnomon::view
