// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>

namespace gnomon::cli {

/**
 * Writes the rows of \a header's data window, with \a metadata, atomically. \throws std::runtime_error naming \a path
 * if it cannot be written
 */
void write_exr_file(const std::filesystem::path &path, Imf::Header header, const Imf::FrameBuffer &pixels,
                    const Metadata &metadata);

}  // namespace gnomon::cli
