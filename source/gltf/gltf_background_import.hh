// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"

#include <atomic>
#include <exception>
#include <filesystem>
#include <optional>
#include <thread>

namespace gnomon::gltf {

/**
 * An import on a thread of its own, so that a host's window stays alive. The host asks is_done in each of its frames
 * and then takes the scene.
 *
 * Threads: all functions are called on one thread, the host's. ImportOptions::progress and read_picture are called on
 * the thread of the import. The scene belongs to the host once it is taken.
 */
class BackgroundImport {
 public:
  /** Begin to import \a path. \throws std::system_error if there can be no other thread */
  explicit BackgroundImport(std::filesystem::path path, ImportOptions options = {});
  BackgroundImport(const BackgroundImport &) = delete;
  BackgroundImport &operator=(const BackgroundImport &) = delete;
  /** Cancels, and waits until the import has ended (\see cancel). */
  ~BackgroundImport();

  [[nodiscard]] const std::filesystem::path &path() const
  {
    return path_;
  }
  /** The fraction that is done, in [0, 1]. It never decreases. */
  [[nodiscard]] float progress() const
  {
    return progress_;
  }
  /** The import has ended: take does not wait. */
  [[nodiscard]] bool is_done() const
  {
    return is_done_;
  }
  /** Let the import end where it calls ImportOptions::progress next: at most one file, mesh or image later. */
  void cancel()
  {
    is_cancelled_ = true;
  }
  /**
   * The scene. Waits for the import. \pre it was not taken before
   * \throws ImportError as import_gltf; ImportCancelled after cancel, unless the import had ended
   */
  [[nodiscard]] scene::Scene take();

 private:
  void run();

  std::filesystem::path path_;
  ImportOptions options_;
  ReportProgress host_progress_;
  std::atomic<float> progress_ = 0.0F;
  std::atomic<bool> is_cancelled_ = false;
  std::atomic<bool> is_done_ = false;
  /** The import's thread owns these until it is joined. */
  std::optional<scene::Scene> scene_;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace gnomon::gltf
