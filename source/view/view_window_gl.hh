// SPDX-License-Identifier: MIT
#pragma once

#include "view_window_device.hh"

#include <string>

namespace gnomon::view {

/** A window that OpenGL draws into. \see open_window */
[[nodiscard]] std::unique_ptr<WindowDevice> open_gl_window(glm::ivec2 size_px, bool is_scripted,
                                                           const DriverMessages &messages);

/** The reason of GLFW's last failure. */
[[nodiscard]] std::string glfw_reason();

}  // namespace gnomon::view
