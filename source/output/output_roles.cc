// SPDX-License-Identifier: MIT
#include "output_roles.hh"

#include <utility>

namespace gnomon::output {

static std::string text_of(const std::filesystem::path &path, const std::string &use)
{
  return use + " '" + path.string() + "'";
}

void Roles::add_input(const std::filesystem::path &path, const std::string &use)
{
  const std::optional<FileId> id = file_id(path);
  if (!id || !id->name.empty()) {
    return;
  }
  const auto [role, is_new] = roles_.try_emplace(*id, Role{text_of(path, use), false});
  if (!is_new && role->second.is_output) {
    throw Conflict(role->second.text + " would replace " + text_of(path, use) + ", which is read");
  }
}

void Roles::add_output(const std::filesystem::path &path, const std::string &use)
{
  if (path.empty()) {
    return;
  }
  check_writable(path);
  const std::optional<FileId> id = file_id(path);
  if (!id) {
    return;
  }
  const auto [role, is_new] = roles_.try_emplace(*id, Role{text_of(path, use), true});
  if (!is_new) {
    throw Conflict(role->second.is_output
                       ? text_of(path, use) + " is the same file as " + role->second.text
                       : text_of(path, use) + " would replace " + role->second.text + ", which is read");
  }
}

bool Roles::has_output(const std::filesystem::path &path) const
{
  const std::optional<FileId> id = file_id(path);
  const auto role = id ? roles_.find(*id) : roles_.end();
  return role != roles_.end() && role->second.is_output;
}

}  // namespace gnomon::output
