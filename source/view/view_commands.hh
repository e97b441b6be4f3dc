// SPDX-License-Identifier: MIT
#pragma once

#include "view_app.hh"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace gnomon::view {

/** The state that a command needs before the next one is read. */
enum class Need { Nothing, Frame, Pointer, Pictures, Message };

/** The arguments of a command. */
using Words = std::span<const std::string>;

/** A script command. doc/view.md describes all commands. */
struct Command {
  std::string_view name;
  /** Syntax of the arguments, for messages. */
  std::string_view usage;
  std::size_t argument_min;
  std::size_t argument_max;
  Need need;
  /** \throws std::exception with the reason if the command fails */
  void (*run)(App &app, Words words);
  /** It first waits as for Need::Pictures, so that it shows the effects of the commands before it. */
  bool is_after_pictures = false;
};

/** nullptr: no command has that name. */
[[nodiscard]] const Command *find_command(std::string_view name);

}  // namespace gnomon::view
