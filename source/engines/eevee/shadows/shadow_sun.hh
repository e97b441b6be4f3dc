// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_technique.hh"

namespace gnomon::eevee {

/** One to four maps of depths that follow what is seen: suns. \see fit_sun */
[[nodiscard]] const ShadowTechnique &shadow_sun_technique();

}  // namespace gnomon::eevee
