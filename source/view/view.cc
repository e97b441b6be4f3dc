// SPDX-License-Identifier: MIT
#include "view.hh"

#include "view_script.hh"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

namespace gnomon::view {

void run(const Options &options)
{
  // Read the script first: no window opens if it is invalid.
  std::optional<Script> script;
  if (!options.script.empty()) {
    script.emplace(options.script);
  }
  App app(options);
  if (!options.scene.empty()) {
    app.begin_open(options.scene);
  }
  bool is_screenshot_asked = false;
  bool is_laid_out = false;
  bool has_begun_script = false;
  while (!app.is_closed()) {
    // Wait for the scene: the first command may need it.
    if (script && (has_begun_script || !app.is_opening())) {
      has_begun_script = true;
      script->step(app);
    }
    const bool is_scripted = script && !script->is_done();
    const bool is_automatic = is_scripted || (script && !app.is_staying()) || !options.screenshot.empty();
    app.draw_frame(!is_automatic);
    if (!is_automatic || (script && !script->is_done())) {
      continue;
    }
    if (options.screenshot.empty() || is_screenshot_asked) {
      break;
    }
    // The first frame lays out the window.
    if (app.is_complete() && is_laid_out) {
      app.request_screenshot(options.screenshot);
      is_screenshot_asked = true;
    }
    is_laid_out = true;
  }
  if (script && app.driver_error_count() > 0) {
    throw std::runtime_error(fmt::format("view: the driver reported {} errors; the last message: {}",
                                         app.driver_error_count(), app.messages().back().text));
  }
}

}  // namespace gnomon::view
