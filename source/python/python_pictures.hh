// SPDX-License-Identifier: MIT
#pragma once

#include "python_fields.hh"

/** Textures, and the picture of a scene's world. */
namespace gnomon::python {

/** \a fields, and one for each of a material's textures. */
[[nodiscard]] Fields<scene::Material> with_textures(Fields<scene::Material> fields);

/**
 * Mesh::tangents for its uvs, as a material that needs them may come later. None without uvs, or while its arrays do
 * not fit to each other.
 */
void add_tangents(scene::Mesh &mesh);

/** Adds Texture, and the members of Scene for textures and the world. */
void define_pictures(py::module_ &module, SceneClass &type);

}  // namespace gnomon::python
