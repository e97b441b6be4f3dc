// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture_formats.hh"

#include <string>

/**
 * The interface of the module gnomon_oiio (source/cli/oiio_module), which reads pictures by OpenImageIO. It is loaded
 * when a picture has a format that the program does not read itself: Debian's OpenImageIO loads 268 libraries.
 * Decision 0016.
 */
namespace gnomon::cli {

/** Name of the exported function. */
inline constexpr const char *read_module_picture_name = "gnomon_read_module_picture";
/**
 * Reads \a path into \a picture.
 * \return whether it could; otherwise \a error has the reason, without the name of the file. Throws nothing.
 */
using ReadModulePicture = bool(const char *path, Picture &picture, std::string &error);

/** \throws std::runtime_error that names the reason, or that the module cannot be loaded. */
[[nodiscard]] Picture read_by_module(const std::filesystem::path &path);

}  // namespace gnomon::cli
