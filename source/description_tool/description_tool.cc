// SPDX-License-Identifier: MIT
// Prints doc/properties.md, the rows of all properties and settings, or doc/frame.md, the steps of a frame.
// scripts/describe writes the files.
#include "view_settings.hh"

#include "eevee_scene_renderer.hh"
#include "eevee_settings.hh"
#include "gltf_import.hh"

#include "scene.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace gnomon {

namespace {

/** Words for values of an enumeration, or limits of a number. */
template <typename Value>
std::string values_text(const scene::Description &row)
{
  if constexpr (requires(Value value) { value.has_value(); }) {
    return values_text<typename scene::PresentValue<Value>::Type>(row) + ", or absent";
  }
  else if constexpr (std::is_enum_v<Value>) {
    return fmt::format("{}", fmt::join(scene::words<Value>, ", "));
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    return fmt::format("{}", fmt::join(row.switch_words, ", "));
  }
  else {
    bool has_number = false;
    scene::for_each_number(Value(), [&](double) { has_number = true; });
    return !has_number ? "" : range_text(row) + (row.zero.empty() ? "" : ", or 0");
  }
}

/** The kinds that \a bits stand for. */
template <typename Kind>
std::string kinds_text(unsigned bits)
{
  std::vector<std::string_view> kinds;
  for (std::size_t kind = 0; kind < scene::words<Kind>.size(); kind++) {
    if ((bits >> kind & 1U) != 0) {
      kinds.push_back(scene::words<Kind>[kind]);
    }
  }
  return fmt::format("{}", fmt::join(kinds, ", "));
}

void print_row(const std::vector<std::string> &cells)
{
  fmt::print("| {} |\n", fmt::join(cells, " | "));
}

void print_header(std::string_view title, const std::vector<std::string> &columns)
{
  fmt::print("\n## {}\n\n", title);
  print_row(columns);
  print_row(std::vector<std::string>(columns.size(), "---"));
}

std::string code(std::string_view text)
{
  return text.empty() ? "" : fmt::format("`{}`", text);
}

/** The place of a property in files: in glTF, and as an extra. */
std::string file_text(const scene::Description &row)
{
  std::string text = code(row.path);
  if (row.extra_kinds != 0) {
    text += fmt::format("{}`gnomon_{}`{}", text.empty() ? "" : ", ", row.key_or_name(),
                        row.is_extra_in_degrees ? " in degrees" : "");
  }
  return text + (row.is_animated ? ", animated" : "");
}

template <typename Part, typename Kind = void>
void print_properties(std::string_view title)
{
  print_header(title, {"Python", "script", "unit", "values", "kinds", "file", "meaning"});
  Part::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    std::string kinds;
    if constexpr (!std::is_void_v<Kind>) {
      kinds = row.kinds == 0 ? "" : kinds_text<Kind>(row.kinds);
    }
    const std::string script = row.label.empty() ? "" : code(row.key_or_name());
    print_row({code(row.name), script, std::string(row.unit), values_text<Value>(row), kinds, file_text(row),
               std::string(row.sentence)});
  });
}

template <typename Part>
void print_settings(std::string_view title, std::string_view script_prefix)
{
  print_header(title, {"name", "option", "script", "unit", "values", "meaning"});
  Part::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    const bool is_in_window = !row.label.empty() && !script_prefix.empty();
    print_row({code(row.name), row.option.empty() ? "" : fmt::format("`--{}`", row.option),
               is_in_window ? fmt::format("`{}{}`", script_prefix, row.key_or_name()) : "", std::string(row.unit),
               values_text<Value>(row), std::string(row.sentence)});
  });
}

void print_properties_page()
{
  fmt::print(
      "# Properties and settings\n\n"
      "`scripts/describe` writes this page from the rows that the importer, the exporter, checks of edits, options, "
      "Python "
      "and the window read. A test compares both. Numbers are in the units of C++ and Python; options and the window "
      "have "
      "degrees for rad and MiB for bytes. Scripts are those of [the window](view.md); files are glTF with "
      "[extras](conventions.md).\n");
  print_properties<scene::Lamp, scene::LampKind>("Lamp");
  print_properties<scene::LampShadow, scene::LampKind>("Shadow of a lamp");
  print_properties<scene::Camera, scene::CameraKind>("Camera");
  print_properties<scene::Material>("Material");
  print_header("Textures of a material", {"Python", "colours", "file"});
  for (const scene::TextureInput &input : scene::texture_inputs) {
    print_row({code(input.name), input.is_color ? "sRGB" : "linear", code(input.path)});
  }
  print_properties<scene::TextureSlot>("Texture slot");
  print_properties<scene::Node>("Node");
  print_properties<scene::World>("World");
  print_settings<eevee::Settings>("Pictures", "render.");
  print_settings<eevee::ShadowSettings>("Shadows of all lamps", "render.");
  print_settings<render_scene::Display>("Display", "render.");
  print_settings<gltf::ImportOptions>("Import", "");
  print_settings<view::WindowSettings>("The window alone", "render.");
}

std::string list_text(const std::vector<std::string> &names)
{
  std::vector<std::string> items;
  for (const std::string &name : names) {
    items.push_back(code(name));
  }
  return fmt::format("{}", fmt::join(items, ", "));
}

/** A graph of Mermaid: an arrow goes from each step to those that read its output. */
void print_graph(const std::vector<eevee::StepDescription> &steps)
{
  // The names that each arrow has. An arrow is dotted if its second step draws over what the first wrote.
  std::map<std::tuple<std::size_t, std::size_t, bool>, std::vector<std::string>> arrows;
  for (std::size_t i = 0; i < steps.size(); i++) {
    const auto add = [&](const std::string &name, bool is_dotted) {
      for (std::size_t k = 1; k < steps.size(); k++) {
        const std::size_t writer = (i + steps.size() - k) % steps.size();
        // Steps may read what the sample before them wrote.
        const bool is_possible = writer < i || (!is_dotted && !steps[writer].is_of_target);
        if (is_possible && std::ranges::count(steps[writer].writes, name) > 0) {
          arrows[{writer, i, is_dotted}].push_back(name);
          return;
        }
      }
    };
    for (const std::string &name : steps[i].reads) {
      add(name, false);
    }
    for (const std::string &name : steps[i].writes) {
      if (std::ranges::count(steps[i].reads, name) == 0) {
        add(name, true);
      }
    }
  }
  fmt::print(
      "\n## Graph\n\n"
      "An arrow goes from the last step that writes textures or buffers to each step that reads them; a dotted one to "
      "the step that draws over them. An arrow back is for the next sample. For steps that a scene does not need, "
      "follow the dotted arrow back.\n\n"
      "```mermaid\nflowchart TD\n");
  for (const auto &[arrow, names] : arrows) {
    const auto &[from, to, is_dotted] = arrow;
    fmt::print("  {} {}|{}| {}\n", steps[from].name, is_dotted ? "-.->" : "-->", fmt::join(names, ", "),
               steps[to].name);
  }
  fmt::print("```\n");
}

void print_frame_page()
{
  fmt::print(
      "# Steps of a frame\n\n"
      "`scripts/describe` writes this page from the steps of the engine's [modules](decisions/0037-modules.md). A test "
      "compares both. The steps are in the order in which they are drawn, and each is one command list. Builds with "
      "assertions check the textures and buffers that it reads and writes; those that no step writes are not listed. "
      "`target` stands for the attachments of a draw's target. `gnomon render --explain` prints the steps that a scene "
      "needs, and the step that wrote what each of them reads.\n");
  print_header("Steps", {"step", "", "passes", "reads", "writes"});
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  const scene::Scene scene;
  eevee::SceneRenderer renderer(*device, scene, {1, 1});
  const std::vector<eevee::StepDescription> steps = renderer.inspect().steps();
  for (const eevee::StepDescription &step : steps) {
    print_row({code(step.name), step.summary, list_text(step.passes), list_text(step.reads), list_text(step.writes)});
  }
  print_graph(steps);
}

}  // namespace

}  // namespace gnomon

int main(int argument_count, char **arguments)
{
  const std::string_view page = argument_count == 2 ? arguments[1] : "";
  if (page == "properties") {
    gnomon::print_properties_page();
  }
  else if (page == "frame") {
    gnomon::print_frame_page();
  }
  else {
    fmt::print(stderr, "usage: {} properties|frame\n", arguments[0]);
    return 2;
  }
  return 0;
}
