// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/** Error and warning messages of the glTF import. Internal to source/gltf. */
namespace gnomon::gltf {

/** An element of the file cannot be used: "what: reason". The importer's entry point adds the file's name. */
struct Fault : std::runtime_error {
  Fault(std::string_view what, std::string_view reason);

  /** It would be used if a limit of the import were higher. */
  bool is_limit = false;
};

/** An element is beyond a limit of the import. */
struct LimitFault : Fault {
  LimitFault(std::string_view what, std::string_view reason) : Fault(what, reason)
  {
    is_limit = true;
  }
};

/** A name from a file for a one-line message: shortened to \a size_max bytes. \see output::printable */
[[nodiscard]] std::string printable(std::string_view name, std::size_t size_max = 80);

/** `kind 'name'`, or `kind index` if the name is empty. */
[[nodiscard]] std::string label(std::string_view kind, std::string_view name, std::size_t index);

/** The text of a number for messages. */
[[nodiscard]] std::string text(double value);

/** Warnings about elements that were left out or replaced. Equal messages are counted. */
class Warnings {
 public:
  /** Adds a message. An identical message is only counted. */
  void add(std::string_view element, std::string_view reason);

  /**
   * Adds a message about \a count items of one \a element. Elements with the same \a reason share one message:
   * "mesh 'a' and 2 others: triangle left out: it has no area (7 times)".
   */
  void add_counted(std::string_view element, std::uint64_t count, std::string_view reason);

  [[nodiscard]] std::vector<std::string> messages() const;

  [[nodiscard]] bool empty() const
  {
    return entries_.empty();
  }

  /**
   * Counts an extra of another program, which export_gltf() does not write. No message. \a text: called for the first,
   * returns "'key' of node 'a'".
   */
  template <typename Text>
  void add_foreign_extra(Text &&text)
  {
    if (foreign_extra_count_++ == 0) {
      first_foreign_extra_ = text();
    }
  }
  /** "extra 'key' of node 'a' and 2 others"; empty: none. */
  [[nodiscard]] std::string foreign_extras() const;
  /** Notes that the document has extras of other programs that are kept. No message. */
  void note_kept_extras()
  {
    has_kept_extras_ = true;
  }
  [[nodiscard]] bool has_kept_extras() const
  {
    return has_kept_extras_;
  }

 private:
  struct Entry {
    /** The first element with this message. */
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
  std::string first_foreign_extra_;
  std::uint64_t foreign_extra_count_ = 0;
  bool has_kept_extras_ = false;

  Entry &entry(std::string_view element, std::string_view reason, bool is_counted);
};

}  // namespace gnomon::gltf
