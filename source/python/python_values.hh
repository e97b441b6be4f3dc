// SPDX-License-Identifier: MIT
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <pybind11/numpy.h>

#include <span>
#include <string>
#include <vector>

/** Values in Python: vectors are tuples, matrices and pictures are numpy arrays. */
namespace pybind11::detail {

/** Any sequence of as many numbers; a tuple in Python. */
template <glm::length_t L, typename T>
struct type_caster<glm::vec<L, T>> {
  using Vector = glm::vec<L, T>;
  PYBIND11_TYPE_CASTER(Vector, const_name("tuple"));

  bool load(handle source, bool convert)
  {
    if (!isinstance<sequence>(source) || len(source) != std::size_t(L)) {
      return false;
    }
    const auto numbers = reinterpret_borrow<sequence>(source);
    for (glm::length_t i = 0; i < L; i++) {
      make_caster<T> number;
      if (!number.load(numbers[std::size_t(i)], convert)) {
        return false;
      }
      value[i] = cast_op<T>(number);
    }
    return true;
  }
  static handle cast(const Vector &vector, return_value_policy /*policy*/, handle /*parent*/)
  {
    tuple result{std::size_t(L)};
    for (glm::length_t i = 0; i < L; i++) {
      result[std::size_t(i)] = vector[i];
    }
    return result.release();
  }
};

/** A 4x4 array, [row, column]. Read-only in Python, because changes of it would not reach the scene. */
template <>
struct type_caster<glm::dmat4> {
  PYBIND11_TYPE_CASTER(glm::dmat4, const_name("numpy.ndarray"));

  bool load(handle source, bool /*convert*/)
  {
    const auto matrix = array_t<double, array::c_style | array::forcecast>::ensure(source);
    if (!matrix || matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4) {
      PyErr_Clear();
      return false;
    }
    for (glm::length_t row = 0; row < 4; row++) {
      for (glm::length_t column = 0; column < 4; column++) {
        value[column][row] = matrix.at(row, column);
      }
    }
    return true;
  }
  static handle cast(const glm::dmat4 &matrix, return_value_policy /*policy*/, handle /*parent*/)
  {
    array_t<double> result({4, 4});
    for (glm::length_t row = 0; row < 4; row++) {
      for (glm::length_t column = 0; column < 4; column++) {
        result.mutable_at(row, column) = matrix[column][row];
      }
    }
    result.attr("setflags")(arg("write") = false);
    return result.release();
  }
};

}  // namespace pybind11::detail

namespace gnomon::python {

namespace py = pybind11;

/**
 * The rows of \a array as vectors. \a what: names it in messages; empty: the caller does
 * \throws py::type_error for another type of numbers, as a hidden conversion would copy it; py::value_error for another
 * shape
 */
template <typename Vector, typename Number = typename Vector::value_type>
[[nodiscard]] std::vector<Vector> rows_of(const py::array &array, const std::string &what)
{
  constexpr py::ssize_t width = Vector::length();
  const std::string subject = what.empty() ? "" : what + ": ";
  if (!array.dtype().equal(py::dtype::of<Number>())) {
    throw py::type_error(subject + "is an array of " + std::string(py::str(array.dtype())) + ", not of " +
                         std::string(py::str(py::dtype::of<Number>())));
  }
  if (array.ndim() != 2 || array.shape(1) != width) {
    throw py::value_error(subject + "is not an array of rows of " + std::to_string(width) + " numbers");
  }
  const auto numbers = py::array_t<Number>(array).template unchecked<2>();
  std::vector<Vector> rows(std::size_t(array.shape(0)));
  for (py::ssize_t row = 0; row < array.shape(0); row++) {
    for (py::ssize_t i = 0; i < width; i++) {
      rows[std::size_t(row)][glm::length_t(i)] = numbers(row, i);
    }
  }
  return rows;
}

/** \a numbers as rows of \a width numbers, in a new array that is read-only. */
template <typename Number>
[[nodiscard]] py::array_t<Number> array_of_rows(std::span<const Number> numbers, int width)
{
  py::array_t<Number> array({py::ssize_t(numbers.size()) / width, py::ssize_t(width)}, numbers.data());
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/**
 * A picture as an array of height, width and four channels, with the top row first. The array owns \a pixels: rows from
 * the bottom, so that its strides from row to row are negative.
 */
[[nodiscard]] py::array_t<float> picture_array(std::vector<glm::vec4> pixels, glm::ivec2 size_px);

}  // namespace gnomon::python
