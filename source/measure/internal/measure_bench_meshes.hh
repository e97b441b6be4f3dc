// SPDX-License-Identifier: MIT
#pragma once

#include "measure_bench.hh"

/** Helpers of the benchmarks. Internal to source/measure. */
namespace gnomon::measure {

/** Seconds since an arbitrary start. */
[[nodiscard]] double now(Clock clock);

/** Closed columns of bench_mesh_count different numbers of sides; radius and half height 0.3 m. */
[[nodiscard]] std::vector<gpu::Batch> column_batches(gpu::Device &device);

}  // namespace gnomon::measure
