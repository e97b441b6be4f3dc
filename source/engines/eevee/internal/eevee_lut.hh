// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "draw_pass.hh"

namespace gnomon::eevee {

struct ResourceReport;

/** Tables of the specular lobe that programs look up. \see eevee_tables.hh Internal to the engine. */
class LookupTables {
 public:
  /** Create the tables that are needed, and free the others. \a features: of the frame. \a read: those of programs. */
  void make(gpu::Device &device, Feature features, Feature read);
  void bind(draw::ShadingGroup &group) const;
  void report(ResourceReport &report) const;

 private:
  /** Empty unless the scene has specular materials, and lamps with Feature::LampShape or a world. */
  gpu::Texture ltc_;
  /** Empty without Feature::Multiscatter. */
  gpu::Texture multiscatter_;
  gpu::Sampler sampler_;
};

}  // namespace gnomon::eevee
