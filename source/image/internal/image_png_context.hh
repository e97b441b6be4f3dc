// SPDX-License-Identifier: MIT
#pragma once

#include "image_error.hh"

#include <spng.h>

#include <memory>
#include <string>

/** Internal to source/image. */
namespace gnomon::image {

struct FreePngContext {
  void operator()(spng_ctx *context) const
  {
    spng_ctx_free(context);
  }
};
using PngContext = std::unique_ptr<spng_ctx, FreePngContext>;

/** \throws Error that \a what failed, unless \a result is that of success. */
inline void check_png(int result, const char *what)
{
  if (result != SPNG_OK) {
    throw Error(std::string(what) + ": " + spng_strerror(result));
  }
}

}  // namespace gnomon::image
