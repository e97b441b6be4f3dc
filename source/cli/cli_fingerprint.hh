// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <string>

namespace gnomon::cli {

/**
 * Hash of everything in a scene that a picture depends on, and of the names of its lamps and cameras. Scenes that were
 * imported from the same files have the same; where the files are, and how they are encoded, makes no difference.
 */
[[nodiscard]] std::string scene_fingerprint(const scene::Scene &scene);

/** Hash of the program that runs, or "" where the system does not show it. */
[[nodiscard]] std::string program_fingerprint();

}  // namespace gnomon::cli
