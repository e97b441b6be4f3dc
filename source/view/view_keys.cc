// SPDX-License-Identifier: MIT
#include "view_keys.hh"

#include "view_app.hh"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <utility>

namespace gnomon::view {

namespace {

constexpr int ctrl = GLFW_MOD_CONTROL;
constexpr int shift = GLFW_MOD_SHIFT;
constexpr int alt = GLFW_MOD_ALT;

struct NamedKey {
  std::string_view name;
  int key;
};

/** Names of keys other than letters and digits. */
constexpr std::array named_keys = std::to_array<NamedKey>({{".", GLFW_KEY_PERIOD},
                                                           {"/", GLFW_KEY_SLASH},
                                                           {"-", GLFW_KEY_MINUS},
                                                           {"`", GLFW_KEY_GRAVE_ACCENT},
                                                           {"enter", GLFW_KEY_ENTER},
                                                           {"escape", GLFW_KEY_ESCAPE},
                                                           {"delete", GLFW_KEY_DELETE},
                                                           {"backspace", GLFW_KEY_BACKSPACE},
                                                           {"home", GLFW_KEY_HOME},
                                                           {"space", GLFW_KEY_SPACE}});

/** Keys of the number block, and their equivalents. */
constexpr std::array block_keys = std::to_array<std::pair<int, int>>({{GLFW_KEY_KP_DECIMAL, GLFW_KEY_PERIOD},
                                                                      {GLFW_KEY_KP_DIVIDE, GLFW_KEY_SLASH},
                                                                      {GLFW_KEY_KP_SUBTRACT, GLFW_KEY_MINUS},
                                                                      {GLFW_KEY_KP_ENTER, GLFW_KEY_ENTER}});

int without_block(int key)
{
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) {
    return GLFW_KEY_0 + key - GLFW_KEY_KP_0;
  }
  const auto *const found = std::ranges::find(block_keys, key, &std::pair<int, int>::first);
  return found == block_keys.end() ? key : found->second;
}

struct Binding {
  KeyPress press;
  void (*run)(App &app);
};

template <Side side>
void look(App &app)
{
  app.active().navigation.look_from(side);
}

template <TransformKind kind>
void transform(App &app)
{
  app.begin_transform(kind);
}

void toggle_visibility(App &app)
{
  if (Document *document = app.document()) {
    document->toggle_visibility();
  }
}

const std::array bindings = std::to_array<Binding>({
    {{GLFW_KEY_Z, ctrl}, [](App &app) { app.undo(); }},
    {{GLFW_KEY_Z, ctrl | shift}, [](App &app) { app.redo(); }},
    {{GLFW_KEY_Y, ctrl}, [](App &app) { app.redo(); }},
    {{GLFW_KEY_S, ctrl}, [](App &app) { app.ask_save(); }},
    {{GLFW_KEY_O, ctrl}, [](App &app) { app.ask_open(); }},
    {{GLFW_KEY_1, 0}, look<Side::Front>},
    {{GLFW_KEY_1, ctrl}, look<Side::Back>},
    {{GLFW_KEY_3, 0}, look<Side::Right>},
    {{GLFW_KEY_3, ctrl}, look<Side::Left>},
    {{GLFW_KEY_7, 0}, look<Side::Top>},
    {{GLFW_KEY_7, ctrl}, look<Side::Bottom>},
    {{GLFW_KEY_5, 0}, [](App &app) { app.active().navigation.toggle_orthographic(); }},
    {{GLFW_KEY_0, 0}, [](App &app) { app.look_through_camera(); }},
    {{GLFW_KEY_PERIOD, 0}, [](App &app) { app.frame(false); }},
    {{GLFW_KEY_HOME, 0}, [](App &app) { app.frame(true); }},
    {{GLFW_KEY_H, 0}, toggle_visibility},
    {{GLFW_KEY_H, shift}, [](App &app) { app.hide_selected(); }},
    {{GLFW_KEY_H, alt}, [](App &app) { app.active().show_all(); }},
    {{GLFW_KEY_SLASH, 0}, [](App &app) { app.isolate_selected(); }},
    {{GLFW_KEY_Z, alt}, [](App &app) { app.toggle_reach(); }},
    {{GLFW_KEY_W, alt}, [](App &app) { app.toggle_extent(); }},
    {{GLFW_KEY_Z, shift}, [](App &app) { app.active().has_wireframe = !app.active().has_wireframe; }},
    {{GLFW_KEY_B, alt}, [](App &app) { app.active().toggle_clip(); }},
    {{GLFW_KEY_G, 0}, transform<TransformKind::Move>},
    {{GLFW_KEY_R, 0}, transform<TransformKind::Rotate>},
    {{GLFW_KEY_S, 0}, transform<TransformKind::Scale>},
    {{GLFW_KEY_A, shift}, [](App &app) { app.ask_addition(); }},
    {{GLFW_KEY_X, 0}, [](App &app) { app.remove_selected(); }},
    {{GLFW_KEY_DELETE, 0}, [](App &app) { app.remove_selected(); }},
    {{GLFW_KEY_D, shift},
     [](App &app) {
       if (app.duplicate_selected()) {
         app.begin_transform(TransformKind::Move);
       }
     }},
    {{GLFW_KEY_SPACE, 0}, [](App &app) { app.play(!app.is_playing()); }},
    {{GLFW_KEY_F, 0}, [](App &app) { app.begin_fly(); }},
    {{GLFW_KEY_GRAVE_ACCENT, shift}, [](App &app) { app.begin_fly(); }},
});

}  // namespace

std::optional<KeyPress> key_of(std::string_view name)
{
  KeyPress press;
  for (bool has_prefix = true; has_prefix;) {
    has_prefix = false;
    for (const auto &[prefix, mod] :
         {std::pair<std::string_view, int>{"ctrl+", ctrl}, {"shift+", shift}, {"alt+", alt}}) {
      if (name.starts_with(prefix)) {
        press.mods |= mod;
        name.remove_prefix(prefix.size());
        has_prefix = true;
      }
    }
  }
  if (name.size() == 1 && name[0] >= 'a' && name[0] <= 'z') {
    press.key = GLFW_KEY_A + (name[0] - 'a');
    return press;
  }
  if (name.size() == 1 && name[0] >= '0' && name[0] <= '9') {
    press.key = GLFW_KEY_0 + (name[0] - '0');
    return press;
  }
  const auto *const found = std::ranges::find(named_keys, name, &NamedKey::name);
  if (found == named_keys.end()) {
    return std::nullopt;
  }
  press.key = found->key;
  return press;
}

void run_key(App &app, const KeyPress &press)
{
  const KeyPress wanted{without_block(press.key), press.mods & (ctrl | shift | alt)};
  const auto found = std::ranges::find(bindings, wanted, &Binding::press);
  if (found != bindings.end()) {
    found->run(app);
  }
}

void run_transform_key(App &app, const KeyPress &press)
{
  const int key = without_block(press.key);
  switch (key) {
    case GLFW_KEY_ENTER: app.end_transform(true); return;
    case GLFW_KEY_ESCAPE: app.end_transform(false); return;
    case GLFW_KEY_X:
    case GLFW_KEY_Y:
    case GLFW_KEY_Z:
      app.change_transform([&](TransformOperation &operation) {
        operation.toggle_axis(TransformAxis(int(TransformAxis::X) + key - GLFW_KEY_X));
        return true;
      });
      return;
    default: break;
  }
  // GLFW names printable keys by their characters.
  const bool is_printable = key > GLFW_KEY_SPACE && key <= GLFW_KEY_GRAVE_ACCENT;
  const char character = key == GLFW_KEY_BACKSPACE ? '\b' : is_printable ? char(key) : '\0';
  app.change_transform([&](TransformOperation &operation) { return operation.type(character); });
}

}  // namespace gnomon::view
