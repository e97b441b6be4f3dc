// SPDX-License-Identifier: MIT
#include "cli_output.hh"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace gnomon::cli {

NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> values, std::size_t channel_count)
{
  NonFinite found;
  const std::size_t row_size = std::size_t(size_px.x) * channel_count;
  // From the upper row down, the order in which a viewer reads the picture.
  for (int y = 0; y < size_px.y; y++) {
    const std::span<const float> row = values.subspan(std::size_t(size_px.y - 1 - y) * row_size, row_size);
    for (std::size_t i = 0; i < row.size(); i++) {
      if (!std::isfinite(row[i]) && found.count++ == 0) {
        found.first_px = {int(i / channel_count), y};
      }
    }
  }
  return found;
}

void write_json(const std::filesystem::path &path, const nlohmann::json &json, int indent)
{
  if (!path.empty()) {
    output::write_file(path, json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
  }
}

void keep_text_from(const output::Roles &files)
{
  if (files.has_output("/dev/stdout")) {
    // The GNU C Library documents that it can be set.
    stdout = stderr;
  }
}

}  // namespace gnomon::cli
