// SPDX-License-Identifier: MIT
#pragma once

#include "view_app.hh"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace gnomon::view {

/** What a command needs before the next one. */
enum class Need { Nothing, Frame, Pointer, Pictures, Message };

/** The arguments of a command. */
using Words = std::span<const std::string>;

/** A command of scripts. doc/view.md describes all. */
struct Command {
  std::string_view name;
  /** The arguments, for messages. */
  std::string_view usage;
  std::size_t argument_min;
  std::size_t argument_max;
  Need need;
  /** \throws std::exception with the reason where it fails */
  void (*run)(App &app, Words words);
};

/** nullptr: there is none of that name. */
[[nodiscard]] const Command *find_command(std::string_view name);

}  // namespace gnomon::view
