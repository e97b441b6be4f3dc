// SPDX-License-Identifier: MIT
#include "internal/cli_picture_module.hh"

#include "cli_system.hh"

#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

/** Beside the program in a build, and in the folder of libraries where the program is installed. */
static fs::path module_path()
{
  const fs::path program_folder = program_file().parent_path();
  const fs::path beside = program_folder / GNOMON_OIIO_MODULE;
  return fs::exists(beside) ? beside : (program_folder / GNOMON_MODULE_FOLDER / GNOMON_OIIO_MODULE).lexically_normal();
}

/** \throws std::runtime_error with the reason of the dynamic loader. */
static ReadModulePicture *load_reader()
{
  const fs::path path = module_path();
  // It stays loaded until the program ends.
  void *module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void *function = module ? dlsym(module, read_module_picture_name) : nullptr;
  if (!function) {
    throw std::runtime_error(fmt::format(
        "is none of EXR, PNG, JPEG and WebP, and the module for other formats cannot be loaded: {}", dlerror()));
  }
  return reinterpret_cast<ReadModulePicture *>(function);
}

Picture read_by_module(const fs::path &path)
{
  static ReadModulePicture *const read = load_reader();
  Picture picture;
  std::string error;
  if (!read(path.c_str(), picture, error)) {
    throw std::runtime_error(error);
  }
  return picture;
}

}  // namespace gnomon::cli
