// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_technique.hh"

namespace gnomon::eevee {

/** Cascaded shadow maps of suns: one to four maps that are fitted to the visible range. \see fit_sun */
[[nodiscard]] const ShadowTechnique &shadow_sun_technique();

}  // namespace gnomon::eevee
