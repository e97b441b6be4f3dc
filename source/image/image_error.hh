// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>

namespace gnomon::image {

/** A file cannot be decoded or encoded. what() is the reason, without a name of the file. */
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace gnomon::image
