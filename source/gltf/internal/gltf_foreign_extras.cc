// SPDX-License-Identifier: MIT
#include "internal/gltf_foreign_extras.hh"

#include "internal/gltf_document.hh"
#include "internal/gltf_json.hh"

#include <algorithm>
#include <functional>
#include <limits>
#include <new>
#include <set>
#include <utility>

namespace gnomon::gltf {

namespace {

namespace ondemand = simdjson::ondemand;

using Keys = std::set<std::string, std::less<>>;

/** The text without white space between its tokens. */
std::string minified(std::string_view json)
{
  std::string result(json.size(), '\0');
  std::size_t size = 0;
  if (const auto error = simdjson::minify(json.data(), json.size(), result.data(), size)) {
    throw simdjson::simdjson_error(error);
  }
  result.resize(size);
  return result;
}

/**
 * In simdjson 3.6, field::unescaped_key needs an argument that version 3.0 does not have. That of a result has a
 * default.
 */
std::string_view key_of(const ondemand::field &field)
{
  return simdjson::simdjson_result<ondemand::field>(ondemand::field(field)).unescaped_key();
}

/** The members of \a object as they are written, but those of Gnomon and of \a taken, to which the keys are added. */
JsonText members_of(ondemand::object object, Keys &taken)
{
  JsonText members;
  Keys keys;
  for (ondemand::field field : object) {
    const char *const start = field.key().raw() - 1;
    const std::string key(key_of(field));
    ondemand::value value = field.value();
    const std::string_view text = simdjson::to_json_string(value);
    if (!key.starts_with(own_extra_prefix) && !taken.contains(key)) {
      members.add(minified({start, text.data() + text.size()}));
      keys.insert(key);
    }
  }
  taken.merge(keys);
  return members;
}

/** \throws std::bad_alloc, or Fault if anything but memory is missing. \a what: the thing */
[[noreturn]] void fail_for(const simdjson::simdjson_error &error, const std::string &what)
{
  if (error.error() == simdjson::MEMALLOC) {
    throw std::bad_alloc();
  }
  throw Fault(what, error.what());
}

class Reader {
 public:
  Reader(Warnings &warnings, Model &model) : warnings_(warnings), model_(model) {}

  void read(std::string_view json)
  {
    ondemand::parser parser;
    ondemand::document document = parser.iterate(json.data(), json.size(), json.size() + document_padding());
    for (ondemand::field member : document.get_object()) {
      const std::string_view key = key_of(member);
      const auto *const array = std::ranges::find(arrays_with_kept_extras, key);
      if (key == extras_key) {
        keep(document_extras, 0, member.value());
      }
      else if (key == extensions_key) {
        read_lights(member.value());
      }
      else if (array != arrays_with_kept_extras.end()) {
        read_array(*array, member.value());
      }
    }
  }

 private:
  Warnings &warnings_;
  Model &model_;
  std::size_t size_ = 0;

  /** Calls \a read(key, value) for each member. Values of other types only stand before a member of the same key. */
  template <typename Read>
  static void for_members(ondemand::value value, const Read &read)
  {
    if (value.type() != ondemand::json_type::object) {
      return;
    }
    for (ondemand::field member : value.get_object()) {
      const std::string_view key = key_of(member);
      read(key, member.value());
    }
  }

  void read_lights(ondemand::value extensions)
  {
    for_members(extensions, [&](std::string_view extension, ondemand::value punctual) {
      if (extension != punctual_key) {
        return;
      }
      for_members(punctual, [&](std::string_view key, ondemand::value lights) {
        if (key == lights_key) {
          read_array(lights_key, lights);
        }
      });
    });
  }

  void read_array(std::string_view name, ondemand::value elements)
  {
    // The last of several arrays of the same name counts.
    forget(name, 0, std::numeric_limits<int>::max());
    if (elements.type() != ondemand::json_type::array) {
      return;
    }
    int index = 0;
    for (ondemand::value element : elements.get_array()) {
      for_members(element, [&](std::string_view key, ondemand::value extras) {
        if (key == extras_key) {
          keep(name, index, extras);
        }
      });
      index++;
    }
  }

  /** Removes what is kept of the elements of \a array from \a begin to before \a end. */
  void forget(std::string_view array, int begin, int end)
  {
    auto &kept = model_.foreign_extras;
    auto place = kept.lower_bound({array, begin});
    while (place != kept.end() && place->first < std::pair(array, end)) {
      size_ -= place->second.size();
      place = kept.erase(place);
    }
  }

  void keep(std::string_view array, int index, ondemand::value extras)
  {
    forget(array, index, index + 1);
    if (extras.type() != ondemand::json_type::object) {
      // Counted as lost.
      return;
    }
    Keys keys;
    const JsonText members = members_of(extras.get_object(), keys);
    if (members.empty()) {
      return;
    }
    std::string text = members.object();
    const bool is_of_other_scene = array == "scenes" && index != std::max(model_.scene, 0);
    if (is_of_other_scene || text.size() > foreign_extras_bytes_max - size_) {
      warnings_.add_foreign_extra([&] {
        const std::string_view kind = array.substr(0, array.size() - (array == "meshes" ? 2 : 1));
        return "'" + printable(*keys.begin()) + "' of " +
               (array == document_extras ? "the document" : label(kind, "", std::size_t(index)));
      });
      return;
    }
    size_ += text.size();
    model_.foreign_extras.insert_or_assign({array, index}, std::move(text));
  }
};

}  // namespace

void read_foreign_extras(std::string_view json, Warnings &warnings, Model &model)
{
  try {
    Reader(warnings, model).read(json);
  }
  catch (const simdjson::simdjson_error &error) {
    fail_for(error, "extras");
  }
}

std::string ForeignExtras::of(std::string_view array, int index)
{
  const auto found = model_.foreign_extras.find({array, index});
  if (found == model_.foreign_extras.end()) {
    return "";
  }
  if (found->second.size() > foreign_extras_bytes_max - size_) {
    warnings_.add_counted("extras", 1, "left out: those of all things have more than 64 MiB");
    return "";
  }
  size_ += found->second.size();
  return found->second;
}

/** The members of a text of a host, which may be no JSON. */
static JsonText members_of_text(std::string_view json, const std::string &what, Keys &taken)
{
  std::string text(json);
  text.append(document_padding(), '\0');
  const std::string_view unpadded(text.data(), json.size());
  simdjson::dom::parser parser;
  std::string changed;
  JsonValue value;
  const simdjson::error_code error = parse_json(parser, unpadded, changed, value);
  if (error == simdjson::MEMALLOC) {
    throw std::bad_alloc();
  }
  if (error != simdjson::SUCCESS || !value.is_object()) {
    throw Fault(what, "its extras are not a JSON object");
  }
  try {
    ondemand::parser again;
    ondemand::document document = again.iterate(text.data(), unpadded.size(), text.size());
    return members_of(document.get_object(), taken);
  }
  catch (const simdjson::simdjson_error &failure) {
    fail_for(failure, what + ": extras");
  }
}

void add_extras(JsonText own, const std::vector<std::string_view> &foreign, const std::string &what, JsonText &json)
{
  Keys taken;
  for (const std::string_view text : foreign) {
    if (!text.empty()) {
      own.add_all(members_of_text(text, what, taken));
    }
  }
  if (!own.empty()) {
    json.add(extras_key, own.object());
  }
}

}  // namespace gnomon::gltf
