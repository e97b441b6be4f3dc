// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/**
 * \file Division of pictures into parts that are rendered by different processes, for schedulers (`doc/farm.md`). A
 * plan is a JSON file. All functions are deterministic.
 */
namespace gnomon::cli {

/** Metadata of a picture or of a part of one: WorkPlan::id, and its name in the plan, which no other file of it has. */
inline constexpr const char *plan_metadata = "gnomon:plan";
inline constexpr const char *planned_file_metadata = "gnomon:plan_file";

/** These metadata of the file \a name of the plan \a id. */
[[nodiscard]] Metadata planned_metadata(const std::string &id, const std::string &name);
/** The reason, with the name, why the file \a name is not that of the plan \a id, or not complete; empty: it is. */
[[nodiscard]] std::string planned_fault(const std::string &name, const std::string &id);

/** One process's share: frames of a scene, or a part of one picture. */
struct WorkPart {
  /** Index of WorkPlan::scenes. */
  std::size_t scene = 0;
  /** The values of `--frames` and `--step`; empty: one picture without animation. Several frames are whole pictures. */
  std::string frames{};
  /** The value of `--tile`; empty: all rows. */
  std::string tile{};
  /** The value of `--sample-range`; empty: all samples. */
  std::string samples{};
  /** The value of `--output`. */
  std::string output{};

  /** Whether its file is a part of a picture, for `gnomon merge --plan`. */
  [[nodiscard]] bool is_of_picture() const
  {
    return !tile.empty() || !samples.empty();
  }
};

struct PlannedScene {
  std::string path{};
  /** scene_fingerprint of the scene as it is imported, and the fingerprint of the file of --world. */
  std::string fingerprint{};
  /** The pictures, with # for the number of the frame. */
  std::string pictures{};
};

/** Parts and the options that they have in common. */
struct WorkPlan {
  /** Version and commit of the program. */
  std::string program{};
  /** The folder to which all paths are relative, relative to that of the plan's file. */
  std::string folder{};
  std::vector<PlannedScene> scenes{};
  /** Arguments of `gnomon render` beside those of the parts. */
  std::vector<std::string> arguments{};
  /** From one frame of a part to the next. */
  int frame_step = 1;
  /** Estimated time of the longest part, s, and its memory, bytes. 0: not known. */
  double part_seconds = 0.0;
  std::uint64_t memory_bytes = 0;
  std::vector<WorkPart> parts{};

  /** Hash of all of the above, which changes with any of it. */
  [[nodiscard]] std::string id() const;
};

/** Times of a scene's pictures. */
struct PictureCost {
  /** Time of a process before its first picture, s. */
  double start_seconds = 0.0;
  /** Time of one sample of a whole picture, s; more than 0. */
  double sample_seconds = 0.0;
};

/** The pictures of one scene, to be divided. */
struct WorkOfScene {
  std::size_t scene = 0;
  /** Frames; without an animation, first and last are 0 and the names of pictures have no number. */
  bool is_animated = false;
  int first_frame = 0;
  int last_frame = 0;
  int sample_count = 1;
  /** Strips of each picture. */
  int tile_count = 1;
  /** Whether the options allow parts of pictures. */
  bool can_divide_pictures = true;
  std::string pictures{};
  PictureCost cost{};
};

/**
 * Appends parts of about \a target_seconds to \a plan: several frames a part where they are short, strips as
 * WorkOfScene::tile_count says, and ranges of samples where a strip takes longer.
 * \return the estimated time of the longest part, s
 */
double add_parts(WorkPlan &plan, const WorkOfScene &work, double target_seconds);

/**
 * \a program: program_name() of the caller. \throws std::runtime_error naming the file and the reason: unreadable,
 * edited since it was written, or of another program
 */
[[nodiscard]] WorkPlan read_plan(const std::filesystem::path &path, const std::string &program);
/** \throws std::runtime_error naming the file, also if a text is not UTF-8 */
void write_plan(const std::filesystem::path &path, const WorkPlan &plan);

/** The files that \a part writes. */
[[nodiscard]] std::vector<std::string> files_of(const WorkPlan &plan, const WorkPart &part);
/** The picture of which \a part is a part. \pre is_of_picture() */
[[nodiscard]] std::string picture_of(const WorkPlan &plan, const WorkPart &part);

/** "PLAN:K". \throws UsageError */
struct PartName {
  explicit PartName(const std::string &text);

  std::filesystem::path plan;
  std::size_t index = 0;
};

/**
 * \a pattern with the last run of # replaced by \a frame, padded with zeros. Without a #, the pattern.
 */
[[nodiscard]] std::string frame_name(const std::string &pattern, int frame);
/**
 * \a pattern with each `{scene}` replaced by the name of \a scene's file without its folder and extension. A # in that
 * name becomes _, because a # in the result stands for the number of a frame.
 */
[[nodiscard]] std::string scene_name(std::string pattern, const std::filesystem::path &scene);

}  // namespace gnomon::cli
