// SPDX-License-Identifier: MIT
#include "gltf_background_import.hh"

#include <utility>

namespace gnomon::gltf {

BackgroundImport::BackgroundImport(std::filesystem::path path, ImportOptions options)
    : path_(std::move(path)), options_(std::move(options)), host_progress_(std::move(options_.progress))
{
  options_.progress = [this](float part) {
    progress_ = part;
    return !is_cancelled_ && (!host_progress_ || host_progress_(part));
  };
  thread_ = std::thread([this] { run(); });
}

BackgroundImport::~BackgroundImport()
{
  cancel();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void BackgroundImport::run()
{
  try {
    scene_ = import_gltf(path_, options_);
  }
  catch (...) {
    error_ = std::current_exception();
  }
  is_done_ = true;
}

scene::Scene BackgroundImport::take()
{
  if (!thread_.joinable()) {
    throw ImportError(path_.string() + ": was taken before");
  }
  thread_.join();
  if (error_) {
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
  return std::move(*scene_);
}

}  // namespace gnomon::gltf
