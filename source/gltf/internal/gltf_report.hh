// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/** How the glTF import says what is wrong. Internal to source/gltf. */
namespace gnomon::gltf {

/** Something in the file cannot be used: "what: reason", without the file, which the door puts in front. */
struct Fault : std::runtime_error {
  Fault(std::string_view what, std::string_view reason);
};

/** A name from a file, fit for a one-line message: no control characters, not endless. */
[[nodiscard]] std::string printable(std::string_view name);

/** `kind 'name'`, or `kind index` for what has no name. */
[[nodiscard]] std::string label(std::string_view kind, std::string_view name, std::size_t index);

/** A number as a person would write it. */
[[nodiscard]] std::string text(double value);

/** What was left out or mended: every message once, with the number of elements it is about. */
class Warnings {
 public:
  /** A message of its own. The same one again only counts. */
  void add(std::string_view element, std::string_view reason);

  /**
   * \a count things of one \a element. Elements with the same \a reason share one message:
   * "mesh 'a' and 2 others: triangle left out: it has no area (7 times)".
   */
  void add_counted(std::string_view element, std::uint64_t count, std::string_view reason);

  [[nodiscard]] std::vector<std::string> messages() const;

  [[nodiscard]] bool empty() const
  {
    return entries_.empty();
  }

 private:
  struct Entry {
    /** The first that it was said of. */
    std::string element;
    std::string reason;
    std::string last_element;
    std::uint64_t element_count = 0;
    std::uint64_t count = 0;
    bool is_counted = false;
  };
  /** In the order of first appearance. */
  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, std::size_t> index_of_;

  Entry &entry(std::string_view element, std::string_view reason, bool is_counted);
};

}  // namespace gnomon::gltf
