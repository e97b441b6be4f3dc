// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_write_json.hh"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/** Extras of other programs, which are kept as JSON text. Internal to source/gltf. */
namespace gnomon::gltf {

/** Most bytes of the extras of all things of a scene: things may share extras of the file. */
inline constexpr std::size_t foreign_extras_bytes_max = std::size_t(1) << 26U;

/**
 * Fills Model::foreign_extras from the text, because a parsed number may have lost digits. Those that are beyond
 * foreign_extras_bytes_max, and those of other scenes, are counted as lost. \a json: valid, followed by
 * document_padding() bytes. \pre the rest of \a model is read
 */
void read_foreign_extras(std::string_view json, Warnings &warnings, Model &model);

/** Gives the extras of the file to things of the scene, up to foreign_extras_bytes_max. */
class ForeignExtras {
 public:
  /** Both must outlive this object. */
  ForeignExtras(const Model &model, Warnings &warnings) : model_(model), warnings_(warnings) {}
  [[nodiscard]] bool has(std::string_view array, int index) const
  {
    return model_.foreign_extras.contains({array, index});
  }
  /** The extras of the element \a index of \a array of the document; empty: there are none, or too many before them. */
  [[nodiscard]] std::string of(std::string_view array, int index);

 private:
  const Model &model_;
  Warnings &warnings_;
  std::size_t size_ = 0;
};

/**
 * Adds the member "extras" to \a json, unless it would be empty: \a own members, and those of \a foreign objects. Keys
 * of Gnomon, and those that an object before has, are left out. \a what: the thing. \throws Fault if one of \a foreign
 * is neither empty nor a JSON object
 */
void add_extras(JsonText own, const std::vector<std::string_view> &foreign, const std::string &what, JsonText &json);

}  // namespace gnomon::gltf
