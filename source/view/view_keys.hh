// SPDX-License-Identifier: MIT
#pragma once

#include "view_window.hh"

#include <optional>
#include <string_view>

namespace gnomon::view {

class App;

/**
 * The key with a name as in menus: a letter, a digit, '.', '/', '-', '`', or enter, escape, delete, backspace, home,
 * with the optional prefixes "ctrl+", "shift+" and "alt+". Empty: no such key.
 */
[[nodiscard]] std::optional<KeyPress> key_of(std::string_view name);

/** Run the action of a key outside of transforms and fly mode. */
void run_key(App &app, const KeyPress &press);
/** Run the action of a key during a transform. */
void run_transform_key(App &app, const KeyPress &press);

}  // namespace gnomon::view
