// SPDX-License-Identifier: MIT
#include "internal/gltf_report.hh"

#include "output_text.hh"

#include <array>
#include <cstdio>

namespace gnomon::gltf {

namespace {

std::string joined(std::string_view what, std::string_view reason)
{
  std::string result(what);
  result += ": ";
  result += reason;
  return result;
}

bool is_utf8_continuation(char character)
{
  return (static_cast<unsigned char>(character) & 0xC0U) == 0x80U;
}

}  // namespace

Fault::Fault(std::string_view what, std::string_view reason) : std::runtime_error(joined(what, reason)) {}

std::string printable(std::string_view name, std::size_t size_max)
{
  std::string result(name.substr(0, size_max));
  if (result.size() < name.size()) {
    // Do not split a character.
    while (!result.empty() && is_utf8_continuation(name[result.size()])) {
      result.pop_back();
    }
    result += "...";
  }
  return output::printable(result);
}

std::string label(std::string_view kind, std::string_view name, std::size_t index)
{
  std::string result(kind);
  result += name.empty() ? ' ' + std::to_string(index) : " '" + printable(name) + "'";
  return result;
}

std::string text(double value)
{
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%g", value);
  return buffer.data();
}

Warnings::Entry &Warnings::entry(std::string_view element, std::string_view reason, bool is_counted)
{
  // Counted entries are shared by elements, so their key has no element.
  std::pair<std::string, std::string> key(is_counted ? std::string_view() : element, reason);
  const auto [place, is_new] = index_of_.try_emplace(std::move(key), entries_.size());
  if (is_new) {
    entries_.push_back({std::string(element), std::string(reason), {}, 0, 0, is_counted});
  }
  Entry &result = entries_[place->second];
  // All messages about an element are consecutive.
  if (result.last_element != element) {
    result.last_element = element;
    result.element_count++;
  }
  return result;
}

void Warnings::add(std::string_view element, std::string_view reason)
{
  entry(element, reason, false).count++;
}

void Warnings::add_counted(std::string_view element, std::uint64_t count, std::string_view reason)
{
  entry(element, reason, true).count += count;
}

/** " and 2 others"; empty if \a count is 0. */
static std::string and_others(std::uint64_t count)
{
  return count == 0 ? "" : " and " + std::to_string(count) + (count == 1 ? " other" : " others");
}

std::string Warnings::foreign_extras() const
{
  return foreign_extra_count_ == 0 ? "" : "extra " + first_foreign_extra_ + and_others(foreign_extra_count_ - 1);
}

std::vector<std::string> Warnings::messages() const
{
  std::vector<std::string> result;
  for (const Entry &entry : entries_) {
    std::string message = entry.element;
    message += entry.is_counted ? and_others(entry.element_count - 1) : "";
    message += ": " + entry.reason;
    if (entry.count > 1) {
      message += " (" + std::to_string(entry.count) + " times)";
    }
    result.push_back(std::move(message));
  }
  return result;
}

}  // namespace gnomon::gltf
