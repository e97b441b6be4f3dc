// SPDX-License-Identifier: MIT
#include "view_script.hh"

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>

namespace gnomon::view {

namespace {

/** What a command needs before the next one. */
enum class Need { Nothing, Frame, Pictures };

using Words = std::span<const std::string>;

struct Command {
  /** After the name, for messages. */
  const char *usage;
  std::size_t argument_min;
  std::size_t argument_max;
  Need (*run)(App &app, Words words);
};

double number(const std::string &word)
{
  double value = 0.0;
  const char *end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || after != end || !(std::abs(value) < 1e12)) {
    throw std::runtime_error(fmt::format("'{}' is not a number", word));
  }
  return value;
}

int integer(const std::string &word, int min, int max)
{
  const double value = number(word);
  if (value != double(int(value)) || value < min || value > max) {
    throw std::runtime_error(fmt::format("'{}' is not an integer from {} to {}", word, min, max));
  }
  return int(value);
}

Document &document(App &app)
{
  if (!app.document()) {
    throw std::runtime_error("no scene is open");
  }
  return *app.document();
}

scene::Handle<scene::Node> find_node(App &app, const std::string &name)
{
  const scene::Handle<scene::Node> node = document(app).find(name);
  if (!node) {
    throw std::runtime_error(fmt::format("{}: has no node '{}'", app.document()->scene().path, name));
  }
  return node;
}

/** Of the selected node: its placement, flags, lamp or first material. \return whether it has the property */
bool set_of_selected(Document &document, const std::string &name, Words values)
{
  const scene::Scene &scene = document.scene();
  if (!scene.nodes().is_live(document.selected)) {
    throw std::runtime_error("nothing is selected");
  }
  scene::Node node = scene.nodes()[document.selected];
  Placement placement = placement_of(node.parent_from_node);
  if (set_property(placement, name, values)) {
    node.parent_from_node = placed(node.parent_from_node, placement);
  }
  else if (!set_property(node, name, values)) {
    if (const scene::Lamp *lamp = scene.lamps().find(node.lamp)) {
      scene::Lamp edited = *lamp;
      const bool is_set = set_property(edited, name, values);
      document.edit(node.lamp, [&](scene::Lamp &one) { one = edited; });
      return is_set;
    }
    const scene::Mesh *mesh = node.meshes.empty() ? nullptr : scene.meshes().find(node.meshes.front());
    const scene::Material *material = mesh ? scene.materials().find(mesh->material) : nullptr;
    if (!material) {
      return false;
    }
    scene::Material edited = *material;
    const bool is_set = set_property(edited, name, values);
    document.edit(mesh->material, [&](scene::Material &one) { one = edited; });
    return is_set;
  }
  document.edit(document.selected, [&](scene::Node &one) { one = node; });
  return true;
}

/** "world.NAME", "render.NAME", or a property of the selected node. */
Need set(App &app, Words words)
{
  Document &open = document(app);
  const std::string &name = words[0];
  const Words values = words.subspan(1);
  bool is_set = false;
  if (name.starts_with("world.")) {
    scene::World world = open.scene().world().value_or(scene::World{});
    is_set = set_property(world, name.substr(6), values);
    open.set_world(world);
  }
  else if (name.starts_with("render.")) {
    Settings settings = open.settings();
    is_set = set_property(settings, name.substr(7), values);
    open.set_settings(settings);
  }
  else {
    is_set = set_of_selected(open, name, values);
  }
  open.history().end_gesture();
  if (!is_set) {
    throw std::runtime_error(fmt::format("there is no property '{}'", name));
  }
  return Need::Nothing;
}

Need look_from(App &app, Words words)
{
  static const std::map<std::string, Side> sides = {{"front", Side::Front}, {"back", Side::Back},
                                                    {"left", Side::Left},   {"right", Side::Right},
                                                    {"top", Side::Top},     {"bottom", Side::Bottom}};
  const auto side = sides.find(words[0]);
  if (side == sides.end()) {
    throw std::runtime_error(fmt::format("'{}' is no side", words[0]));
  }
  app.active().navigation.look_from(side->second);
  return Need::Nothing;
}

Need look_through(App &app, Words words)
{
  for (const scene::PlacedCamera &camera : document(app).scene().placed_cameras()) {
    if (camera.name == words[0]) {
      app.active().navigation.look_through(camera, app.document()->scene().bounds());
      return Need::Nothing;
    }
  }
  throw std::runtime_error(fmt::format("{}: has no camera '{}'", app.document()->scene().path, words[0]));
}

Need use_engine(App &app, Words words)
{
  const std::vector<std::string> &names = document(app).engine_names();
  if (std::ranges::find(names, words[0]) == names.end()) {
    throw std::runtime_error(fmt::format("there is no engine '{}'", words[0]));
  }
  app.active().engine = words[0];
  return Need::Nothing;
}

Need viewports(App &app, Words words)
{
  const int count = integer(words[0], 1, 4);
  if (count == 3) {
    throw std::runtime_error("'3' viewports have no layout: 1, 2 or 4");
  }
  app.set_viewport_count(count);
  return Need::Frame;
}

Need expect(App &app, Words words)
{
  const std::vector<Message> &messages = app.messages();
  if (messages.empty() || messages.back().text.find(words[0]) == std::string::npos) {
    throw std::runtime_error(fmt::format("the last message is not about '{}' but '{}'", words[0],
                                         messages.empty() ? "" : messages.back().text));
  }
  return Need::Nothing;
}

/** \throws where it failed: the message of it */
Need check(App &app, bool is_done)
{
  if (!is_done) {
    throw std::runtime_error(app.messages().back().text);
  }
  return Need::Frame;
}

const std::map<std::string, Command> commands = {
    {"open", {"FILE", 1, 1, [](App &app, Words words) { return check(app, app.open(words[0])); }}},
    {"drop",
     {"FILE", 1, 1,
      [](App &app, Words words) {
        app.open(words[0]);
        return Need::Frame;
      }}},
    {"save",
     {"FILE", 1, 1,
      [](App &app, Words words) { return check(app, document(app).scene().path.size() > 0 && app.save(words[0])); }}},
    {"size",
     {"WIDTH HEIGHT", 2, 2,
      [](App &app, Words words) {
        app.window().resize({integer(words[0], 1, 16384), integer(words[1], 1, 16384)});
        return Need::Frame;
      }}},
    {"viewports", {"1|2|4", 1, 1, viewports}},
    {"active",
     {"INDEX", 1, 1,
      [](App &app, Words words) {
        app.set_active(integer(words[0], 1, app.viewport_count()) - 1);
        return Need::Nothing;
      }}},
    {"engine", {"NAME", 1, 1, use_engine}},
    {"camera", {"NAME", 1, 1, look_through}},
    {"look", {"front|back|left|right|top|bottom", 1, 1, look_from}},
    {"orthographic",
     {"", 0, 0,
      [](App &app, Words) {
        app.active().navigation.toggle_orthographic();
        return Need::Nothing;
      }}},
    {"orbit",
     {"DEGREES DEGREES", 2, 2,
      [](App &app, Words words) {
        app.active().navigation.orbit(glm::radians(glm::dvec2(number(words[0]), number(words[1]))));
        return Need::Nothing;
      }}},
    {"pan",
     {"RIGHT UP", 2, 2,
      [](App &app, Words words) {
        app.active().navigation.pan({number(words[0]), number(words[1])});
        return Need::Nothing;
      }}},
    {"zoom",
     {"FACTOR", 1, 1,
      [](App &app, Words words) {
        app.active().navigation.zoom(std::max(1e-6, number(words[0])));
        return Need::Nothing;
      }}},
    {"frame",
     {"[all]", 0, 1,
      [](App &app, Words words) {
        document(app);
        app.frame(!words.empty());
        return Need::Nothing;
      }}},
    {"select",
     {"NODE", 1, 1,
      [](App &app, Words words) {
        document(app).selected = find_node(app, words[0]);
        return Need::Nothing;
      }}},
    {"pick",
     {"X Y", 2, 2,
      [](App &app, Words words) {
        if (!app.active().viewport()) {
          throw std::runtime_error("there is no picture yet: wait");
        }
        app.active().pick(document(app), {integer(words[0], 0, 16384), integer(words[1], 0, 16384)});
        return Need::Nothing;
      }}},
    {"selected",
     {"[NODE]", 0, 1,
      [](App &app, Words words) {
        const scene::Node *node = document(app).scene().nodes().find(app.document()->selected);
        const std::string name = node ? node->name : "";
        if (name != (words.empty() ? "" : words[0])) {
          throw std::runtime_error(fmt::format("'{}' is selected", name));
        }
        return Need::Nothing;
      }}},
    {"set", {"PROPERTY VALUE...", 2, 4, set}},
    {"undo",
     {"", 0, 0,
      [](App &app, Words) {
        app.undo();
        return Need::Nothing;
      }}},
    {"redo",
     {"", 0, 0,
      [](App &app, Words) {
        app.redo();
        return Need::Nothing;
      }}},
    {"tab",
     {"NAME", 1, 1,
      [](App &app, Words words) {
        if (!app.show_tab(words[0])) {
          throw std::runtime_error(fmt::format("there is no tab '{}'", words[0]));
        }
        return Need::Frame;
      }}},
    {"message", {"TEXT", 1, 1, expect}},
    {"wait", {"", 0, 0, [](App &, Words) { return Need::Pictures; }}},
    {"screenshot",
     {"FILE", 1, 1,
      [](App &app, Words words) {
        app.request_screenshot(words[0]);
        return Need::Frame;
      }}},
    {"picture",
     {"FILE", 1, 1,
      [](App &app, Words words) {
        app.save_picture(words[0]);
        return Need::Nothing;
      }}},
    {"stay",
     {"", 0, 0,
      [](App &app, Words) {
        app.stay();
        return Need::Nothing;
      }}},
    {"quit",
     {"", 0, 0,
      [](App &app, Words) {
        app.quit();
        return Need::Frame;
      }}},
};

[[noreturn]] void fail(const std::filesystem::path &path, int line, const std::string &reason)
{
  throw std::runtime_error(fmt::format("{}:{}: {}", path.string(), line, reason));
}

}  // namespace

std::vector<ScriptLine> parse_script(std::string_view text)
{
  std::vector<ScriptLine> lines;
  std::istringstream input{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(input, line); number++) {
    std::vector<std::string> words;
    for (std::size_t i = 0; i < line.size() && line[i] != '#';) {
      if (line[i] == ' ' || line[i] == '\t' || line[i] == '\r') {
        i++;
        continue;
      }
      const bool is_quoted = line[i] == '"';
      const std::size_t first = is_quoted ? i + 1 : i;
      const std::size_t end = line.find_first_of(is_quoted ? "\"" : " \t\r", first);
      if (is_quoted && end == std::string::npos) {
        throw std::runtime_error(fmt::format("{}: a quote is not closed", number));
      }
      words.push_back(line.substr(first, end - first));
      i = end == std::string::npos ? line.size() : end + 1;
    }
    if (!words.empty()) {
      lines.push_back({number, std::move(words)});
    }
  }
  return lines;
}

Script::Script(const std::filesystem::path &path) : path_(path)
{
  std::ifstream file(path);
  std::ostringstream text;
  if (!(text << file.rdbuf())) {
    throw std::runtime_error(fmt::format("{}: cannot be read", path.string()));
  }
  try {
    lines_ = parse_script(text.str());
  }
  catch (const std::runtime_error &error) {
    throw std::runtime_error(fmt::format("{}:{}", path.string(), error.what()));
  }
  for (const ScriptLine &line : lines_) {
    const auto command = commands.find(line.words[0]);
    if (command == commands.end()) {
      fail(path, line.number, fmt::format("'{}' is no command", line.words[0]));
    }
    const std::size_t argument_count = line.words.size() - 1;
    if (argument_count < command->second.argument_min || argument_count > command->second.argument_max) {
      fail(path, line.number, fmt::format("usage: {} {}", line.words[0], command->second.usage));
    }
  }
}

void Script::step(App &app)
{
  // One frame to lay out what changed, then until nothing is left to draw.
  if (frames_ > 0) {
    frames_--;
  }
  else if (waits_) {
    waits_ = !app.is_complete();
  }
  while (frames_ == 0 && !waits_ && next_ < lines_.size()) {
    const ScriptLine &line = lines_[next_++];
    try {
      switch (commands.at(line.words[0]).run(app, Words(line.words).subspan(1))) {
        case Need::Nothing: break;
        case Need::Frame: frames_ = 1; break;
        case Need::Pictures:
          frames_ = 2;
          waits_ = true;
          break;
      }
    }
    catch (const std::exception &error) {
      fail(path_, line.number, error.what());
    }
  }
}

}  // namespace gnomon::view
