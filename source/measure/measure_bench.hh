// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "gpu_device.hh"

#include <span>
#include <string>
#include <vector>

/** The benchmarks of `gnomon bench`, except for `edits` (measure_edits.hh). */
namespace gnomon::measure {

/** Median and quartiles of measured times, seconds. */
struct Spread {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/** \pre \a seconds is not empty */
[[nodiscard]] Spread spread_of(std::vector<double> seconds);

/** Median of the ratios of each round. A disturbance of a round affects both of its times. \pre equal sizes, not empty
 */
[[nodiscard]] double median_ratio(std::span<const double> seconds, std::span<const double> base);

enum class Clock {
  /** CPU time of the calling thread. It excludes the time of other programs, and of the driver's threads. */
  ThreadCpu,
  Wall,
};

/** Number of different meshes in measure_layer_passes() and measure_record(). */
inline constexpr int bench_mesh_count = 8;

/** A method of drawing the six layers of a point lamp's shadow. */
struct LayerPassVariant {
  const char *name;
  const char *description;
  eevee::LayerPass layer_pass;
  /** Not used by the engine: one pass for each face, whose view culls the casters one by one. */
  bool is_culled_by_view = false;
};

[[nodiscard]] std::span<const LayerPassVariant> layer_pass_variants();

/** The cost of drawing the six layers once by one variant. */
struct LayerPassCost {
  const LayerPassVariant *variant = nullptr;
  /** passes, draws and instances. */
  gpu::Counters counters;
  /** One time for each round: recording, submission, and the wait until the device is done. */
  std::vector<double> seconds;
};

/**
 * Draws the shadow layers of a point lamp in the middle of a grid of \a caster_count casters. Each round draws by each
 * variant that the device supports once, in the order of layer_pass_variants(). A first round is not measured.
 */
[[nodiscard]] std::vector<LayerPassCost> measure_layer_passes(gpu::Device &device, int caster_count, int rounds,
                                                              Clock clock);

/** The cost of one part of the engine, or of a baseline. */
struct PartCost {
  std::string what;
  /** One time for each round. */
  std::vector<double> seconds{};
};

/**
 * CPU seconds for each of \a draw_count draws that each have their own matrix and another mesh than the previous draw:
 * written to plain arrays, which is the baseline; added to a pass; and the pass recorded for a view and submitted. A
 * first round is not measured.
 */
[[nodiscard]] std::vector<PartCost> measure_record(gpu::Device &device, int draw_count, int rounds);

/**
 * CPU seconds to test \a box_count boxes against a frustum: one by one, which is the baseline, and together. Each round
 * has another view. A first round is not measured.
 */
[[nodiscard]] std::vector<PartCost> measure_cull(int box_count, int rounds);

/**
 * Seconds to import a file of \a node_count nodes of one mesh, and to parse its JSON alone, which is the baseline. A
 * first round is not measured. \throws std::runtime_error if no temporary file can be written
 */
[[nodiscard]] std::vector<PartCost> measure_import(int node_count, int rounds);

/** Size of the scene of measure_sync(). */
inline constexpr int sync_triangle_count = 80000;
inline constexpr int sync_lamp_count = 50;

/**
 * Seconds of syncs and pictures of a scene with sync_lamp_count point lamps among the sync_triangle_count triangles of
 * one mesh, each of which every lamp reaches: first, and after edits. The baseline reads the triangles once for one
 * lamp. A first round is not measured.
 */
[[nodiscard]] std::vector<PartCost> measure_sync(gpu::Device &device, int rounds);

/** Range of the lamps of measure_lamps(), metres. */
inline constexpr double bench_lamp_range_m = 12.0;

/** The cost of a frame of a hall with lamps. */
struct LampsCost {
  /** "90 m"; "growing": the area of the hall is proportional to the number of lamps, and is that of 90 m at 128. */
  std::string hall;
  int lamp_count = 0;
  /** Edge of the square hall, metres. */
  double edge_m = 0.0;
  /** Device memory of the hall's resources, bytes. */
  std::size_t memory_bytes = 0;
  /** Components of the picture that are not finite. */
  std::size_t non_finite_count = 0;
  /** One time for each round: a frame that finds all resources up to date. Pixels visit the lamps in lists. */
  std::vector<double> seconds_of_lists{};
  /** The same if each pixel visits all lamps. Empty where light_block does not hold them. */
  std::vector<double> seconds_of_all{};
  /** The same for a first frame, in which all resources but programs are created. Empty for growing halls. */
  std::vector<double> seconds_of_first{};
  /** Whether the engine makes lists for this number of lamps. */
  bool has_lists = false;

  /** The times of a frame as the engine draws it. */
  [[nodiscard]] const std::vector<double> &seconds() const
  {
    return has_lists ? seconds_of_lists : seconds_of_all;
  }
};

/** Measures halls with few and many point lamps, in turn in each round, at 320x180 with one sample. */
[[nodiscard]] std::vector<LampsCost> measure_lamps(gpu::Device &device, int rounds);

/** The slope of the line through the logarithms, by least squares. \pre positive values, at least two counts differ */
[[nodiscard]] double growth_exponent(std::span<const double> counts, std::span<const double> seconds);

/** Times that grow with a count: fixed + factor * count^exponent. */
struct Growth {
  /** Seconds, at least 0. */
  double fixed = 0.0;
  double exponent = 0.0;
};

/**
 * The growth with the least sum of squared relative errors, with an exponent from 0 to 3. \pre positive values, at
 * least three different counts
 */
[[nodiscard]] Growth growth_of(std::span<const double> counts, std::span<const double> seconds);

/** The times of one kind of work for growing counts. */
struct GrowthCost {
  /** The work, for example "first picture, objects". */
  std::string work;
  std::vector<double> counts;
  /** For each count, one time for each round, seconds. */
  std::vector<std::vector<double>> seconds{};

  [[nodiscard]] std::vector<double> medians() const;
};

/**
 * Measures objects, casters and imported nodes on the null backend, and pixels and samples on \a device, unless it is
 * nullptr. Each round measures each count of a kind of work in turn. A first round is not measured. Counts
 * above \a count_max are left out. Writes glTF files to a temporary folder. \throws std::runtime_error if that is
 * impossible
 */
[[nodiscard]] std::vector<GrowthCost> measure_growth(gpu::Device *device, int rounds, double count_max);

/** The cost of drawing one of left_out_cases(). */
struct LeftOutCost {
  std::string name;
  /** passes, draws, shaders_made, textures_made and upload_bytes of the first frame. */
  gpu::Counters counters;
  /** Device memory after the first frame, bytes. */
  std::size_t memory_bytes = 0;
  /** One time for each round: a sync and a frame in which all resources are created. */
  std::vector<double> first_seconds;
  /** One time for each round: a frame that finds all resources up to date; the fastest of five. */
  std::vector<double> warm_seconds;
};

/** Measures left_out_cases() in their order, in turn in each round. A first round is not measured. */
[[nodiscard]] std::vector<LeftOutCost> measure_left_out(gpu::Device &device, int rounds);

}  // namespace gnomon::measure
