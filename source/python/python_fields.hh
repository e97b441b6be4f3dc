// SPDX-License-Identifier: MIT
#pragma once

#include "python_scene.hh"
#include "python_values.hh"

#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cctype>
#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace gnomon::python {

inline constexpr double infinite = std::numeric_limits<double>::infinity();
using scene::float_max;

/** Name of an enumeration in Python. nullptr: its values are texts there, its words. */
template <typename Enum>
inline constexpr const char *enum_name = nullptr;
template <>
inline constexpr const char *enum_name<scene::LampKind> = "LampKind";
template <>
inline constexpr const char *enum_name<scene::AreaShape> = "AreaShape";
template <>
inline constexpr const char *enum_name<scene::ShadowKind> = "ShadowKind";
template <>
inline constexpr const char *enum_name<scene::EsmFormat> = "EsmFormat";
template <>
inline constexpr const char *enum_name<scene::AlphaMode> = "AlphaMode";
template <>
inline constexpr const char *enum_name<scene::CameraKind> = "CameraKind";

/** The words of an enumeration, or of one that may be absent. */
template <typename Value>
inline constexpr auto &words_of = scene::words<Value>;
template <typename Value>
inline constexpr auto &words_of<std::optional<Value>> = scene::words<Value>;

/** Name of a type in the stub, as it is read. */
template <typename Value>
[[nodiscard]] std::string type_name()
{
  if constexpr (requires {
                  typename Value::value_type;
                  std::declval<Value>().has_value();
                }) {
    return type_name<typename Value::value_type>() + " | None";
  }
  else if constexpr (std::is_enum_v<Value>) {
    return enum_name<Value> ? enum_name<Value>
                            : fmt::format("Literal[\"{}\"]", fmt::join(scene::words<Value>, "\", \""));
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    return "bool";
  }
  else if constexpr (std::is_same_v<Value, std::string>) {
    return "str";
  }
  else if constexpr (std::is_arithmetic_v<Value>) {
    return std::is_floating_point_v<Value> ? "float" : "int";
  }
  else if constexpr (std::is_same_v<Value, glm::dmat4>) {
    return "NDArray[np.float64]";
  }
  else {
    static_assert(Value::length() == 3);
    return "Vector";
  }
}

/** A property in Python of values of type T. */
template <typename T>
struct Field {
  std::string name;
  std::string doc;
  /** In the stub, as it is read. */
  std::string type;
  std::function<py::object(const ScenePtr &scene, const T &value)> get;
  /** \throws py::type_error for a value of another type, py::value_error for one out of range, with the reason */
  std::function<void(const ScenePtr &scene, T &value, py::handle set)> set;
  /** The row that the property is made from, if there is one. */
  std::optional<scene::Description> row{};
  /** The words or enumerators of the values, or for false and true. */
  std::vector<std::string> words{};
};

template <typename T>
using Fields = std::vector<Field<T>>;

/** The form of a value in Python that can be converted to a Value. */
template <typename Value>
[[nodiscard]] std::string form_of()
{
  if constexpr (std::same_as<Value, bool>) {
    return "True or False";
  }
  else if constexpr (std::integral<Value>) {
    return "an integer";
  }
  else if constexpr (std::floating_point<Value>) {
    return "a number";
  }
  else if constexpr (std::same_as<Value, std::string>) {
    return "a text";
  }
  else if constexpr (std::same_as<Value, glm::dmat4>) {
    return "an array of 4x4 numbers";
  }
  else if constexpr (std::same_as<Value, py::array>) {
    return "a numpy array";
  }
  else if constexpr (requires { Value::length(); }) {
    return fmt::format("{} numbers", Value::length());
  }
  else if constexpr (requires(Value value) { value.has_value(); }) {
    return form_of<typename Value::value_type>() + " or None";
  }
  else if constexpr (requires(Value value) { value.front(); }) {
    return "a list, of which each is " + form_of<typename Value::value_type>();
  }
  else {
    return "a gnomon." + std::string(py::str(py::type::of<Value>().attr("__name__")));
  }
}

/** \a set as a Value. \a also: other types that the property takes, for the message. \throws py::type_error */
template <typename Value>
[[nodiscard]] Value cast_to(py::handle set, std::string_view also = "")
{
  const auto fault = [&] {
    return py::type_error(
        fmt::format("cannot be {}: it is not {}{}", std::string(py::repr(set)), form_of<Value>(), also));
  };
  try {
    return set.cast<Value>();
  }
  catch (const py::cast_error & /*error*/) {
    throw fault();
  }
  // Thrown for None, and not a cast_error.
  catch (const py::reference_cast_error & /*error*/) {
    throw fault();
  }
}

/** In the constructors below, \a access is a member of T, or a function that returns a reference to a part of a T. */
template <typename T, typename Access>
[[nodiscard]] Field<T> plain_field(std::string name, Access access, std::string doc)
{
  using Value = std::decay_t<std::invoke_result_t<Access, T &>>;
  return {
      std::move(name), std::move(doc), type_name<Value>(),
      [=](const ScenePtr & /*scene*/, const T &value) { return py::cast(std::invoke(access, value)); },
      [=](const ScenePtr & /*scene*/, T &value, py::handle set) { std::invoke(access, value) = cast_to<Value>(set); }};
}

/** A property whose numbers, if it has any, must be within the limits of \a description. */
template <typename T, typename Access>
[[nodiscard]] Field<T> limited_field(std::string name, Access access, const scene::Description &description,
                                     std::string doc)
{
  using Value = std::decay_t<std::invoke_result_t<Access, T &>>;
  Field<T> field = plain_field<T>(std::move(name), access, std::move(doc));
  field.set = [=](const ScenePtr & /*scene*/, T &value, py::handle set) {
    const auto changed = cast_to<Value>(set);
    scene::for_each_number(changed, [&](double number) {
      if (!description.allows(number)) {
        throw py::value_error(fmt::format("{:g} is not {}", number, range_text(description)));
      }
    });
    std::invoke(access, value) = changed;
  };
  return field;
}

/** A number from \a low to \a high, or a vector of such numbers. */
template <typename T, typename Access>
[[nodiscard]] Field<T> number_field(std::string name, Access access, double low, double high, std::string doc)
{
  return limited_field<T>(std::move(name), access, {.name = "", .min = low, .max = high}, std::move(doc));
}

/** A property of an enumeration whose values are texts in Python. */
template <typename T, typename Access>
[[nodiscard]] Field<T> word_field(std::string name, Access access, std::string doc)
{
  using Value = std::decay_t<std::invoke_result_t<Access, T &>>;
  static constexpr auto &words = scene::words<Value>;
  return {std::move(name), std::move(doc), type_name<Value>(),
          [=](const ScenePtr & /*scene*/, const T &value) -> py::object {
            return py::str(std::string(words[std::size_t(std::invoke(access, value))]));
          },
          [=](const ScenePtr & /*scene*/, T &value, py::handle set) {
            const auto text = cast_to<std::string>(set);
            const auto found = std::ranges::find(words, text);
            if (found == words.end()) {
              throw py::value_error(fmt::format("'{}' is none of '{}'", text, fmt::join(words, "', '")));
            }
            std::invoke(access, value) = Value(found - words.begin());
          }};
}

/** Documentation of a property: its sentence, its unit and its limits. */
template <typename Value>
[[nodiscard]] std::string doc_of(const scene::Description &description, std::string_view kinds)
{
  std::string doc = (kinds.empty() ? "" : std::string(kinds) + ": ") + std::string(description.sentence);
  Value value{};
  if constexpr (requires { value.has_value(); }) {
    value.emplace();
  }
  bool has_number = false;
  scene::for_each_number(value, [&](double /*number*/) { has_number = true; });
  if (has_number) {
    doc += fmt::format(" {}{}{}.", description.unit, description.unit.empty() ? "" : ", ", range_text(description));
  }
  return doc;
}

/** The words of the kinds that have a property: "Point and spot". Empty: all kinds. */
template <typename Kind>
[[nodiscard]] std::string kinds_text(const scene::Description &description)
{
  std::vector<std::string_view> kinds;
  for (std::size_t kind = 0; kind < scene::words<Kind>.size(); kind++) {
    if (description.kinds != 0 && description.has_kind(unsigned(kind))) {
      kinds.push_back(scene::words<Kind>[kind]);
    }
  }
  std::string text = fmt::format("{}", fmt::join(kinds, " and "));
  if (!text.empty()) {
    text[0] = char(std::toupper(text[0]));
  }
  return text;
}

/** Keeps the description and the words of \a row in its field. */
template <typename T, typename Row>
void describe(Field<T> &field, const Row &row)
{
  field.row = row;
  using Value = typename Row::Value;
  if constexpr (std::is_same_v<Value, bool>) {
    field.words.assign(row.switch_words.begin(), row.switch_words.end());
  }
  else {
    field.words.assign(words_of<Value>.begin(), words_of<Value>.end());
  }
}

/** The field of a row. \a access: returns the value of a T; \a kinds: see doc_of */
template <typename T, typename Row, typename Access>
[[nodiscard]] Field<T> row_field(const Row &row, Access access, std::string_view kinds = {})
{
  using Value = typename Row::Value;
  const std::string doc = doc_of<Value>(row, kinds);
  Field<T> field = [&] {
    if constexpr (std::is_enum_v<Value>) {
      if constexpr (enum_name<Value> == nullptr) {
        return word_field<T>(std::string(row.name), access, doc);
      }
      else {
        return plain_field<T>(std::string(row.name), access, doc);
      }
    }
    else {
      return limited_field<T>(std::string(row.name), access, row, doc);
    }
  }();
  describe(field, row);
  return field;
}

/** Adds a field for each row of \a Part. \a access: returns the part of a T that has the rows. */
template <typename Part, typename T, typename Access>
void add_property_fields(Fields<T> &fields, Access access)
{
  Part::for_each_property([&](const auto &row) {
    std::string kinds;
    if constexpr (requires(T thing) { thing.kind; } && std::is_same_v<T, Part>) {
      kinds = kinds_text<decltype(T::kind)>(row);
    }
    fields.push_back(row_field<T>(
        row, [=](auto &thing) -> auto & { return row.access(access(thing)); }, kinds));
  });
}

/** A field for each row of T. */
template <typename T>
[[nodiscard]] Fields<T> property_fields()
{
  Fields<T> fields;
  add_property_fields<T>(
      fields, [](auto &thing) -> auto & { return thing; });
  return fields;
}

template <typename T>
[[nodiscard]] std::string label_of(const T &value)
{
  return fmt::format("{} '{}'", T::kind_name, value.name);
}

/** A texture has no name of its own. */
[[nodiscard]] inline std::string label_of(const scene::Texture & /*value*/)
{
  return "texture";
}

/** The handle of \a thing. \throws scene::StaleHandle; scene::InvalidEdit if it is not one of \a scene */
template <typename U>
[[nodiscard]] scene::Handle<U> handle_of(const ScenePtr &scene, const Thing<U> &thing)
{
  const U &value = thing.value();
  if (thing.scene != scene) {
    throw scene::InvalidEdit(label_of(value) + " is of another scene");
  }
  return thing.handle;
}

/** Name of a thing's class in Python. */
template <typename T>
inline constexpr const char *thing_name = nullptr;
template <>
inline constexpr const char *thing_name<scene::Lamp> = "Lamp";
template <>
inline constexpr const char *thing_name<scene::Camera> = "Camera";
template <>
inline constexpr const char *thing_name<scene::Material> = "Material";
template <>
inline constexpr const char *thing_name<scene::Mesh> = "Mesh";
template <>
inline constexpr const char *thing_name<scene::Node> = "Node";
template <>
inline constexpr const char *thing_name<scene::SurfaceFunction> = "SurfaceFunction";

/** Another thing of the scene, or None. */
template <typename T, typename U>
[[nodiscard]] Field<T> thing_field(std::string name, scene::Handle<U> T::*member, std::string doc)
{
  return {std::move(name), std::move(doc), std::string(thing_name<U>) + " | None",
          [=](const ScenePtr &scene, const T &value) {
            const bool is_there = scene->scene.pool<U>().is_live(value.*member);
            return is_there ? py::cast(Thing<U>{scene, value.*member}) : py::object(py::none());
          },
          [=](const ScenePtr &scene, T &value, py::handle set) {
            value.*member = set.is_none() ? scene::Handle<U>() : handle_of(scene, cast_to<Thing<U>>(set, " or None"));
          }};
}

/** Gives a class the types of its properties, from which the stub is made. */
template <typename T>
void annotate(const py::object &type, const Fields<T> &fields)
{
  py::dict types;
  for (const Field<T> &field : fields) {
    types[field.name.c_str()] = field.type;
  }
  type.attr("__annotations__") = types;
}

/**
 * Gives the module the types of the arguments that a function takes by \a fields, from which the stub is made.
 * \return the text about them for the function's documentation
 */
template <typename T>
[[nodiscard]] std::string add_arguments(py::module_ &module, const char *name, const Fields<T> &fields)
{
  const py::object types = py::module_::import("types").attr("SimpleNamespace")();
  annotate(types, fields);
  module.attr(name) = types;
  std::string text = " Further arguments:";
  for (const Field<T> &field : fields) {
    text += fmt::format("\n\n`{}`: {}", field.name, field.doc);
  }
  return text;
}

/** Sets the properties of \a value that \a values names. \a label: names the value in messages */
template <typename T>
void set_fields(const Fields<T> &fields, const std::string &label, const ScenePtr &scene, T &value,
                const py::dict &values)
{
  for (const std::pair<py::handle, py::handle> &entry : values) {
    const auto name = entry.first.cast<std::string>();
    const py::handle set = entry.second;
    const auto field = std::ranges::find(fields, name, &Field<T>::name);
    if (field == fields.end()) {
      std::vector<std::string> names;
      std::ranges::transform(fields, std::back_inserter(names), &Field<T>::name);
      throw py::type_error(fmt::format("{} has no property '{}'; it has: {}", label, name, fmt::join(names, ", ")));
    }
    try {
      field->set(scene, value, set);
    }
    catch (const py::type_error &error) {
      throw py::type_error(fmt::format("{}: {} {}", label, name, error.what()));
    }
    catch (const py::value_error &error) {
      throw scene::InvalidEdit(fmt::format("{}: {} {}", label, name, error.what()));
    }
  }
}

template <typename T>
std::vector<Thing<T>> things_of(const ScenePtr &scene)
{
  std::vector<Thing<T>> things;
  for (const auto &item : scene->scene.pool<T>()) {
    things.push_back({scene, item.handle});
  }
  return things;
}

/** Adds a property that lists the things of a type, and functions that add one and remove one. */
template <typename T>
void define_pool(SceneClass &type, const char *list_name)
{
  type.def_property_readonly(list_name, &things_of<T>,
                             "All of the scene. A new one may take the place of one that was removed.");
  type.def(
      "remove", [](const ScenePtr &scene, const Thing<T> &thing) { scene->edited().remove(handle_of(scene, thing)); },
      py::arg("thing"),
      "Remove a thing; a node with its descendants. Its handles become stale, and what refers to it goes without.");
}

}  // namespace gnomon::python
