// SPDX-License-Identifier: MIT
#include "view_commands.hh"

#include "view_keys.hh"
#include "view_words.hh"

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gnomon::view {

namespace {

Document &document(App &app)
{
  if (!app.document()) {
    throw std::runtime_error("no scene is open");
  }
  return *app.document();
}

/** The active viewport, after its picture has been drawn once. */
WindowViewport &drawn_viewport(App &app)
{
  document(app);
  if (!app.active().viewport()) {
    throw std::runtime_error("there is no picture yet: wait");
  }
  return app.active();
}

/** \throws std::runtime_error with the last message if \a is_done is false */
void require(App &app, bool is_done)
{
  if (!is_done) {
    throw std::runtime_error(app.messages().back().text);
  }
}

/** \throws std::runtime_error with the syntax of the command \a name if \a is_right is false */
void require_usage(std::string_view name, bool is_right)
{
  if (!is_right) {
    throw std::runtime_error(fmt::format("usage: {} {}", name, find_command(name)->usage));
  }
}

void open(App &app, Words words)
{
  require(app, app.open(words[0]));
}

void drop(App &app, Words words)
{
  app.drop(words[0]);
}

void cancel_open(App &app, Words /*words*/)
{
  if (!app.is_opening()) {
    throw std::runtime_error("nothing is being opened");
  }
  app.cancel_open();
}

void save(App &app, Words words)
{
  document(app);
  require(app, app.save(words[0]));
}

void resize(App &app, Words words)
{
  app.window().resize({integer(words[0], 1, 16384), integer(words[1], 1, 16384)});
}

void set_viewports(App &app, Words words)
{
  const int count = integer(words[0], 1, 4);
  if (count == 3) {
    throw std::runtime_error("'3' viewports have no layout: 1, 2 or 4");
  }
  app.set_viewport_count(count);
}

void set_active(App &app, Words words)
{
  app.set_active(integer(words[0], 1, app.viewport_count()) - 1);
}

void use_engine(App &app, Words words)
{
  const std::vector<std::string> &names = document(app).engine_names();
  if (std::ranges::find(names, words[0]) == names.end()) {
    throw std::runtime_error(fmt::format("there is no engine '{}'", words[0]));
  }
  app.active().engine = words[0];
}

void look_through(App &app, Words words)
{
  for (const scene::PlacedCamera &camera : document(app).scene().placed_cameras()) {
    if (camera.name == words[0]) {
      app.active().look_through(*app.document(), camera);
      return;
    }
  }
  throw std::runtime_error(fmt::format("{}: has no camera '{}'", app.document()->scene().path, words[0]));
}

void look_from(App &app, Words words)
{
  constexpr std::array sides = {"front", "back", "left", "right", "top", "bottom"};
  app.active().navigation.look_from(Side(choice(sides, words[0], "side")));
}

void toggle_orthographic(App &app, Words /*words*/)
{
  app.active().navigation.toggle_orthographic();
}

void orbit(App &app, Words words)
{
  app.active().navigation.orbit(glm::radians(glm::dvec2(number(words[0]), number(words[1]))));
}

void pan(App &app, Words words)
{
  app.active().navigation.pan({number(words[0]), number(words[1])});
}

void zoom(App &app, Words words)
{
  app.active().navigation.zoom(std::max(1e-6, number(words[0])));
}

void fly(App &app, Words words)
{
  app.active().navigation.move({number(words[0]), number(words[1]), -number(words[2])});
}

void turn(App &app, Words words)
{
  app.active().navigation.turn(glm::radians(glm::dvec2(number(words[0]), number(words[1]))));
}

void frame(App &app, Words words)
{
  document(app);
  app.frame(!words.empty());
}

void select(App &app, Words words)
{
  std::vector<scene::Handle<scene::Node>> nodes;
  for (const std::string &word : words) {
    nodes.push_back(document(app).find(word));
    if (!nodes.back()) {
      throw std::runtime_error(fmt::format("{}: has no node '{}'", app.document()->scene().path, word));
    }
  }
  app.document()->select(nodes);
}

void pick(App &app, Words words)
{
  drawn_viewport(app).pick(document(app), pixel(words[0], words[1]));
}

void select_box(App &app, Words words)
{
  const auto from = glm::dvec2(pixel(words[0], words[1]));
  const auto to = glm::dvec2(pixel(words[2], words[3]));
  drawn_viewport(app).select_area(document(app), overlay::rectangle(from, to), false);
}

void clip(App &app, Words words)
{
  require_usage("clip", words.empty() || words.size() == 4);
  WindowViewport &viewport = drawn_viewport(app);
  if (words.empty()) {
    viewport.unclip();
  }
  else {
    viewport.clip(pixel(words[0], words[1]), pixel(words[2], words[3]));
  }
}

void select_lasso(App &app, Words words)
{
  require_usage("lasso", words.size() % 2 == 0);
  std::vector<glm::dvec2> path;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    path.emplace_back(pixel(words[i], words[i + 1]));
  }
  drawn_viewport(app).select_area(document(app), path, false);
}

void expect_selected(App &app, Words words)
{
  std::vector<std::string> names;
  for (const scene::Handle<scene::Node> node : document(app).selection()) {
    names.push_back(document(app).scene().nodes()[node].name);
  }
  std::vector<std::string> expected(words.begin(), words.end());
  std::ranges::sort(names);
  std::ranges::sort(expected);
  if (names != expected) {
    throw std::runtime_error(fmt::format("'{}' is selected", fmt::join(names, "', '")));
  }
}

void expect_triangle(App &app, Words words)
{
  const overlay::Hit *hit = document(app).clicked();
  const std::string met = hit && hit->triangle ? fmt::format("{}", hit->triangle->index) : "";
  if (met != (words.empty() ? "" : words[0])) {
    throw std::runtime_error(fmt::format("triangle '{}' was clicked", met));
  }
}

void expect_inside(App &app, Words words)
{
  const auto node = drawn_viewport(app).dark_inside();
  const std::string name = node ? document(app).scene().nodes()[*node].name : "";
  if (name != (words.empty() ? "" : words[0])) {
    throw std::runtime_error(fmt::format("all that is seen is the dark back of '{}'", name));
  }
}

/** Set a property of \a thing; the handle may be invalid. \return whether it has the property */
template <typename T>
bool set_of(Document &document, scene::Handle<T> thing, const std::string &name, Words values)
{
  const T *value = document.scene().pool<T>().find(thing);
  if (!value) {
    return false;
  }
  T edited = *value;
  if (!set_property(edited, name, values)) {
    return false;
  }
  document.edit(thing, [&](T &one) { one = edited; });
  return true;
}

bool set_of_shadow(Document &document, scene::Handle<scene::Lamp> handle, const std::string &name, Words values)
{
  const scene::Lamp *lamp = document.scene().lamps().find(handle);
  if (!lamp) {
    return false;
  }
  ShadowOfLamp edited = document.shadow_of(*lamp);
  if (!set_property(edited, name, values)) {
    return false;
  }
  document.edit(handle, [&](scene::Lamp &one) { one.shadow = edited.shadow; });
  return true;
}

/** Set a property of the selected node: placement, flags, lamp, camera or first material. \return whether it has it */
bool set_of_selected(Document &document, const std::string &name, Words values)
{
  const scene::Scene &scene = document.scene();
  if (!scene.nodes().is_live(document.selected)) {
    throw std::runtime_error("nothing is selected");
  }
  const scene::Node node = scene.nodes()[document.selected];
  Placement placement = placement_of(node.parent_from_node);
  if (set_property(placement, name, values)) {
    document.edit(document.selected,
                  [&](scene::Node &one) { one.parent_from_node = placed(one.parent_from_node, placement); });
    return true;
  }
  const scene::Mesh *mesh = node.meshes.empty() ? nullptr : scene.meshes().find(node.meshes.front());
  return set_of(document, document.selected, name, values) || set_of(document, node.lamp, name, values) ||
         set_of_shadow(document, node.lamp, name, values) || set_of(document, node.camera, name, values) ||
         (mesh && set_of(document, mesh->material, name, values));
}

/** Argument: a file, or none. */
void set_world_picture(App &app, Words values)
{
  if (values.size() != 1) {
    throw std::runtime_error("world.picture: takes a file, or none");
  }
  if (values[0] == "none") {
    document(app).set_world_picture(nullptr);
    return;
  }
  require(app, app.set_world_picture(values[0]));
}

/** The first argument is "world.NAME", "render.NAME", or a property of the selected node. */
void set(App &app, Words words)
{
  Document &edited = document(app);
  const std::string &name = words[0];
  const Words values = words.subspan(1);
  bool is_set = false;
  if (name == "world.picture") {
    set_world_picture(app, values);
    is_set = true;
  }
  else if (name.starts_with("world.")) {
    scene::World world = edited.scene().world().value_or(scene::World{});
    is_set = set_property(world, name.substr(6), values);
    edited.set_world(world);
  }
  else if (name.starts_with("render.")) {
    WindowSettings settings = edited.settings();
    is_set = set_property(settings, name.substr(7), values);
    edited.set_settings(settings);
  }
  else {
    is_set = set_of_selected(edited, name, values);
  }
  edited.history().end_gesture();
  if (!is_set) {
    throw std::runtime_error(fmt::format("there is no property '{}'", name));
  }
}

void set_time(App &app, Words words)
{
  document(app);
  app.play(false);
  app.set_time(number(words[0]));
}

void undo(App &app, Words /*words*/)
{
  app.undo();
}

void redo(App &app, Words /*words*/)
{
  app.redo();
}

void press_keys(App &app, Words words)
{
  for (const std::string &word : words) {
    const std::optional<KeyPress> press = key_of(word);
    if (!press) {
      throw std::runtime_error(fmt::format("'{}' is no key", word));
    }
    app.take_key(*press);
  }
}

void drag_handle(App &app, Words words)
{
  if (!drawn_viewport(app).drag_handle(document(app), pixel(words[0], words[1]), pixel(words[2], words[3]))) {
    throw std::runtime_error(fmt::format("no handle of a gizmo is at {}, {}", words[0], words[1]));
  }
}

/** Click at one position in the window, or drag between two. */
void use_pointer(App &app, Words words)
{
  require_usage("pointer", words.size() != 3);
  const glm::ivec2 from = pixel(words[0], words[1]);
  app.window().drag_pointer(from, words.size() == 4 ? pixel(words[2], words[3]) : from);
}

void set_gizmo(App &app, Words words)
{
  constexpr std::array kinds = {"none", "move", "rotate", "scale"};
  const int kind = choice(kinds, words[0], "gizmo");
  document(app).gizmo = kind == 0 ? std::nullopt : std::optional(TransformKind(kind - 1));
}

void set_orientation(App &app, Words words)
{
  constexpr std::array orientations = {"world", "local"};
  document(app).orientation = Orientation(choice(orientations, words[0], "orientation"));
}

void set_overlays(App &app, Words words)
{
  constexpr std::array off_on = {"off", "on"};
  app.active().has_overlays = choice(off_on, words[0], "choice of off and on") == 1;
}

void use_shaders(App &app, Words words)
{
  app.use_shaders(words[0]);
}

void lose_context(App &app, Words words)
{
  app.window().inject_context_loss(words.empty() ? 0 : int(number(words[0])));
}

void add(App &app, Words words)
{
  document(app);
  const auto all = additions();
  const auto found = std::ranges::find(all, words[0], &Addition::name);
  if (found == all.end()) {
    throw std::runtime_error(fmt::format("'{}' cannot be added", words[0]));
  }
  app.add(*found);
}

void remove(App &app, Words /*words*/)
{
  require(app, app.remove_selected());
}

void duplicate(App &app, Words /*words*/)
{
  require(app, app.duplicate_selected());
}

void show_tab(App &app, Words words)
{
  if (!app.show_tab(words[0])) {
    throw std::runtime_error(fmt::format("there is no tab '{}'", words[0]));
  }
}

void show_layer(App &app, Words words)
{
  drawn_viewport(app);
  app.show_layer(words[0]);
}

void measure_error(App &app, Words words)
{
  constexpr std::array actions = {"cancel"};
  if (words.empty()) {
    document(app);
    app.begin_measurement();
  }
  else if (choice(actions, words[0], "thing to do with a measurement") == 0 && !app.cancel_measurement()) {
    throw std::runtime_error("nothing is being measured");
  }
}

void expect_message(App &app, Words words)
{
  const std::vector<Message> &messages = app.messages();
  if (messages.empty() || messages.back().text.find(words[0]) == std::string::npos) {
    throw std::runtime_error(fmt::format("the last message is not about '{}' but '{}'", words[0],
                                         messages.empty() ? "" : messages.back().text));
  }
}

void wait(App & /*app*/, Words /*words*/) {}

void save_screenshot(App &app, Words words)
{
  app.request_screenshot(words[0]);
}

void save_picture(App &app, Words words)
{
  app.save_picture(words[0]);
}

void stay(App &app, Words /*words*/)
{
  app.stay();
}

void close(App &app, Words /*words*/)
{
  app.close();
}

void quit(App &app, Words /*words*/)
{
  app.quit();
}

constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

constexpr std::array commands = std::to_array<Command>({
    {"open", "FILE", 1, 1, Need::Frame, open},
    // No frame: the next command runs before the file can be open, however fast it is read.
    {"drop", "FILE", 1, 1, Need::Nothing, drop},
    {"cancel", "", 0, 0, Need::Nothing, cancel_open},
    {"save", "FILE", 1, 1, Need::Frame, save},
    {"size", "WIDTH HEIGHT", 2, 2, Need::Frame, resize},
    {"viewports", "1|2|4", 1, 1, Need::Frame, set_viewports},
    {"active", "INDEX", 1, 1, Need::Nothing, set_active},
    {"engine", "NAME", 1, 1, Need::Nothing, use_engine},
    {"overlays", "on|off", 1, 1, Need::Nothing, set_overlays},
    {"camera", "NAME", 1, 1, Need::Nothing, look_through},
    {"look", "front|back|left|right|top|bottom", 1, 1, Need::Nothing, look_from},
    {"orthographic", "", 0, 0, Need::Nothing, toggle_orthographic},
    {"orbit", "DEGREES DEGREES", 2, 2, Need::Nothing, orbit},
    {"pan", "RIGHT UP", 2, 2, Need::Nothing, pan},
    {"zoom", "FACTOR", 1, 1, Need::Nothing, zoom},
    {"fly", "RIGHT UP FORWARD", 3, 3, Need::Nothing, fly},
    {"turn", "DEGREES DEGREES", 2, 2, Need::Nothing, turn},
    {"frame", "[all]", 0, 1, Need::Nothing, frame},
    {"select", "NODE...", 1, any, Need::Nothing, select},
    {"pick", "X Y", 2, 2, Need::Nothing, pick, true},
    {"box", "X Y TO_X TO_Y", 4, 4, Need::Nothing, select_box, true},
    {"clip", "[X Y TO_X TO_Y]", 0, 4, Need::Nothing, clip, true},
    {"lasso", "X Y X Y X Y...", 6, any, Need::Nothing, select_lasso, true},
    {"selected", "[NODE...]", 0, any, Need::Nothing, expect_selected},
    {"triangle", "[INDEX]", 0, 1, Need::Nothing, expect_triangle},
    {"inside", "[NODE]", 0, 1, Need::Nothing, expect_inside, true},
    {"set", "PROPERTY VALUE...", 2, 4, Need::Nothing, set},
    {"time", "SECONDS", 1, 1, Need::Nothing, set_time},
    {"undo", "", 0, 0, Need::Nothing, undo},
    {"redo", "", 0, 0, Need::Nothing, redo},
    {"key", "KEY...", 1, any, Need::Nothing, press_keys},
    {"pointer", "X Y [TO_X TO_Y]", 2, 4, Need::Pointer, use_pointer},
    {"gizmo", "none|move|rotate|scale", 1, 1, Need::Nothing, set_gizmo},
    {"orientation", "world|local", 1, 1, Need::Nothing, set_orientation},
    {"drag", "X Y TO_X TO_Y", 4, 4, Need::Nothing, drag_handle},
    {"add", "KIND", 1, 1, Need::Nothing, add},
    {"remove", "", 0, 0, Need::Nothing, remove},
    {"duplicate", "", 0, 0, Need::Nothing, duplicate},
    {"shaders", "FOLDER", 1, 1, Need::Nothing, use_shaders},
    {"lose_context", "[FAILURES]", 0, 1, Need::Frame, lose_context},
    {"tab", "NAME", 1, 1, Need::Frame, show_tab},
    {"layer", "NAME|INDEX|all", 1, 1, Need::Frame, show_layer},
    {"measure", "[cancel]", 0, 1, Need::Nothing, measure_error},
    {"message", "TEXT", 1, 1, Need::Nothing, expect_message},
    {"wait", "", 0, 0, Need::Pictures, wait},
    {"until", "TEXT", 1, 1, Need::Message, wait},
    {"screenshot", "FILE", 1, 1, Need::Frame, save_screenshot},
    {"picture", "FILE", 1, 1, Need::Nothing, save_picture, true},
    {"stay", "", 0, 0, Need::Nothing, stay},
    {"close", "", 0, 0, Need::Frame, close},
    {"quit", "", 0, 0, Need::Frame, quit},
});

}  // namespace

const Command *find_command(std::string_view name)
{
  const auto found = std::ranges::find(commands, name, &Command::name);
  return found == commands.end() ? nullptr : &*found;
}

}  // namespace gnomon::view
