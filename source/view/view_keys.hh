// SPDX-License-Identifier: MIT
#pragma once

#include "view_window.hh"

#include <optional>
#include <string_view>

namespace gnomon::view {

class App;

/**
 * A key by its name, as menus show it: a letter, a digit, '.', '-', '`', or enter, escape, delete, backspace, home;
 * with "ctrl+" and "shift+" before it. Nothing: there is no such key.
 */
[[nodiscard]] std::optional<KeyPress> key_of(std::string_view name);

/** Do what a key does while nothing is transformed and nobody flies. */
void run_key(App &app, const KeyPress &press);
/** The key for a transform that has begun. */
void run_transform_key(App &app, const KeyPress &press);

}  // namespace gnomon::view
