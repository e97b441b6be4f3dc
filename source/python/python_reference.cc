// SPDX-License-Identifier: MIT
#include "python_scene.hh"
#include "python_values.hh"

#include "measure_image_error.hh"
#include "measure_reference.hh"

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace gnomon::python {

static py::tuple trace(const ScenePtr &scene, const glm::ivec2 &size_px,
                       const std::optional<Thing<scene::Node>> &camera, int sample_count, bool has_multiscatter)
{
  constexpr int edge_max = 1 << 14;
  if (size_px.x < 1 || size_px.y < 1 || size_px.x > edge_max || size_px.y > edge_max) {
    throw py::value_error(
        fmt::format("trace: size {}x{} is not from 1x1 to {}x{}", size_px.x, size_px.y, edge_max, edge_max));
  }
  if (sample_count < 2 || sample_count % 2 != 0) {
    throw py::value_error(fmt::format("trace: sample_count {} is not even and at least 2", sample_count));
  }
  const scene::PlacedCamera placed = camera_at(scene, camera);
  measure::ReferencePicture traced;
  {
    const Reading reading(scene);
    const py::gil_scoped_release unlocked;
    traced =
        measure::reference_picture(reference::Tracer(scene->scene), placed, size_px, sample_count, has_multiscatter);
  }
  return py::make_tuple(picture_array(std::move(traced.picture.pixels), size_px), traced.noise);
}

/** The inverse of picture_array, in the order of the array. \throws py::type_error or py::value_error, naming \a what
 */
static std::vector<glm::vec4> pixels_of(const py::array &picture, const std::string &what)
{
  if (picture.ndim() != 3 || picture.shape(2) != 4) {
    throw py::value_error(what + ": is not an array of height, width and four channels");
  }
  return rows_of<glm::vec4>(py::array(picture.attr("reshape")(-1, 4)), what);
}

static measure::ImageError image_error(const py::array &picture, const py::array &reference)
{
  const std::vector<glm::vec4> pixels = pixels_of(picture, "picture");
  const std::vector<glm::vec4> expected = pixels_of(reference, "reference");
  const auto size_of = [](const py::array &array) { return glm::ivec2(array.shape(1), array.shape(0)); };
  const glm::ivec2 size_px = size_of(picture);
  if (size_px != size_of(reference)) {
    throw py::value_error(fmt::format("reference: is {}x{} pixels, and the picture {}x{}", reference.shape(1),
                                      reference.shape(0), size_px.x, size_px.y));
  }
  const py::gil_scoped_release unlocked;
  return measure::image_error(size_px, pixels, expected);
}

void define_reference(py::module_ &module)
{
  using measure::ImageError;
  py::class_<ImageError>(module, "ImageError", "How a picture differs from its reference, over red, green and blue.")
      .def_readonly("rmse", &ImageError::rmse, "Root of the mean square difference.")
      .def_readonly("relative_mse", &ImageError::relative_mse,
                    "Mean of the square difference over the reference's square plus 0.01.")
      .def_readonly("p99", &ImageError::p99, "Difference that 99 % of the pixels do not exceed.")
      .def_readonly("flip", &ImageError::flip, "Mean visible difference on a display, 0 to 1.")
      .def_readonly("non_finite_count", &ImageError::non_finite_count,
                    "Values of either picture that are not finite. If there are any, the errors are NaN.");
  module.def(
      "trace", &trace, py::arg("scene").none(false), py::arg("size"), py::arg("camera") = py::none(),
      py::arg("sample_count") = 64, py::arg("has_multiscatter") = false,
      "The exact picture by ray tracing, of the direct light that Renderer draws: an array as render() gives it, "
      "with alpha 1, and the RMSE of its own noise. `size`: width and height, pixels. `sample_count`: rays for "
      "each pixel, even; more where there is noise. `has_multiscatter`: as of Renderer. The background is black.");
  module.def("image_error", &image_error, py::arg("picture"), py::arg("reference"),
             "Compare two arrays of the same size, as render() and trace() give them.");
}

}  // namespace gnomon::python
