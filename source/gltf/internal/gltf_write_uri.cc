// SPDX-License-Identifier: MIT
#include "internal/gltf_write_uri.hh"

#include <fmt/format.h>

#include <string_view>
#include <system_error>

namespace gnomon::gltf {

namespace fs = std::filesystem;

/** Unreserved characters of RFC 3986 and slashes stay, others become % and two digits. */
static std::string percent_encoded(std::string_view path)
{
  constexpr std::string_view kept = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  std::string uri;
  for (const char character : path) {
    if (kept.find(character) != kept.npos) {
      uri += character;
    }
    else {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(character));
    }
  }
  return uri;
}

std::string uri_of_file(const std::string &path, const fs::path &folder)
{
  std::error_code error;
  if (path.empty() || !fs::is_regular_file(path, error)) {
    return {};
  }
  const fs::path relative = fs::relative(path, folder.empty() ? fs::path(".") : folder, error);
  return error ? std::string() : percent_encoded(relative.generic_string());
}

}  // namespace gnomon::gltf
