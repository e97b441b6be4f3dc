// SPDX-License-Identifier: MIT
#include "view_transform_operation.hh"

#include "view_properties.hh"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gnomon::view {

namespace {

using std::numbers::pi;
/** Smallest distance of the pointer from the node, pixels, that is used to compute a factor. */
constexpr double distance_min_px = 4.0;

int index_of(TransformAxis axis)
{
  return std::max(0, int(axis) - 1);
}

/** Point of the line through \a position_ws that is nearest to \a ray, in metres along \a axis_ws. */
double nearest_on_axis(const Ray &ray, const glm::dvec3 &position_ws, const glm::dvec3 &axis_ws)
{
  const glm::dvec3 to_eye = ray.origin_ws - position_ws;
  const double cosine = glm::dot(axis_ws, ray.direction_ws);
  const double across = 1.0 - cosine * cosine;
  // For an axis along the line of sight, the pointer gives no position.
  if (across < 1e-4) {
    return 0.0;
  }
  return (glm::dot(axis_ws, to_eye) - cosine * glm::dot(ray.direction_ws, to_eye)) / across;
}

/** Intersection of \a ray with a plane. */
glm::dvec3 on_plane(const Ray &ray, const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  const double along = glm::dot(ray.direction_ws, normal_ws);
  const double distance = std::abs(along) > 1e-9 ? glm::dot(position_ws - ray.origin_ws, normal_ws) / along : 0.0;
  return ray.origin_ws + distance * ray.direction_ws;
}

/** The same angle in (-pi, pi]. */
double wrapped(double angle)
{
  return std::remainder(angle, 2.0 * pi);
}

}  // namespace

glm::dmat4 affine(glm::dmat4 matrix)
{
  for (int column = 0; column < 4; column++) {
    matrix[column][3] = column == 3 ? 1.0 : 0.0;
  }
  return matrix;
}

bool has_inverse(const glm::dmat4 &matrix)
{
  const glm::dmat3 axes(matrix);
  const double edges = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  // The determinant of a singular matrix may be slightly above 0 because of rounding.
  return std::abs(glm::determinant(axes)) > 1e-12 * edges;
}

glm::dvec3 axis_ws(const glm::dmat4 &world_from_node, TransformAxis axis, Orientation orientation)
{
  const int index = index_of(axis);
  glm::dvec3 unit(0.0);
  unit[index] = 1.0;
  if (orientation == Orientation::World) {
    return unit;
  }
  const glm::dvec3 own(world_from_node[index]);
  const double length = glm::length(own);
  return length > 0.0 && std::isfinite(length) ? own / length : unit;
}

glm::dmat4 rotated(const glm::dmat4 &world_from_node, const glm::dvec3 &axis_ws, double angle)
{
  glm::dmat4 result = glm::rotate(glm::dmat4(1.0), angle, axis_ws) * world_from_node;
  result[3] = world_from_node[3];
  return result;
}

glm::dmat4 scaled(const glm::dmat4 &world_from_node, const Transform &transform, double factor)
{
  glm::dmat4 result = world_from_node;
  const int index = index_of(transform.axis);
  for (int column = 0; column < 3; column++) {
    if (transform.axis == TransformAxis::All) {
      result[column] *= factor;
    }
    else if (transform.orientation == Orientation::World) {
      result[column][index] *= factor;
    }
    else if (column == index) {
      result[column] *= factor;
    }
  }
  return result;
}

TransformOperation::TransformOperation(const scene::Scene &scene, scene::Handle<scene::Node> node,
                                       const Transform &transform, const PictureMap &map, const glm::dvec2 &pointer)
    : node_(node),
      transform_(transform),
      first_orientation_(transform.orientation),
      map_(map),
      start_ws_(scene.world_from_node(node)),
      start_pointer_(pointer),
      pointer_(pointer)
{
  if (const scene::Handle<scene::Node> parent = scene.parent(node)) {
    const glm::dmat4 &world_from_parent = scene.world_from_node(parent);
    if (!has_inverse(world_from_parent)) {
      throw std::runtime_error(fmt::format("node '{}': cannot be moved, as the matrix of its parent has no inverse",
                                           scene.nodes()[node].name));
    }
    parent_from_world_ = glm::inverse(world_from_parent);
  }
}

void TransformOperation::toggle_axis(TransformAxis axis)
{
  if (transform_.axis != axis) {
    transform_.axis = axis;
    transform_.orientation = first_orientation_;
  }
  else if (transform_.orientation == first_orientation_) {
    transform_.orientation = first_orientation_ == Orientation::World ? Orientation::Local : Orientation::World;
  }
  else {
    transform_.axis = TransformAxis::All;
    transform_.orientation = first_orientation_;
  }
}

void TransformOperation::point(const glm::dvec2 &pointer)
{
  if (const std::optional<glm::dvec2> middle = map_.pixel_of(position_ws())) {
    const glm::dvec2 before = pointer_ - *middle;
    const glm::dvec2 now = pointer - *middle;
    // Pixels count downwards.
    pointer_angle_ -= wrapped(std::atan2(now.y, now.x) - std::atan2(before.y, before.x));
  }
  pointer_ = pointer;
}

bool TransformOperation::type(char character)
{
  if ((character >= '0' && character <= '9') || (character == '.' && typed_.find('.') == std::string::npos)) {
    typed_ += character;
  }
  else if (character == '-') {
    typed_ = typed_.starts_with('-') ? typed_.substr(1) : "-" + typed_;
  }
  else if (character == '\b') {
    typed_ = typed_.substr(0, typed_.size() - std::min<std::size_t>(typed_.size(), 1));
  }
  else {
    return false;
  }
  return true;
}

std::optional<double> TransformOperation::typed() const
{
  if (typed_.empty()) {
    return std::nullopt;
  }
  // An incomplete number such as "-" is 0. The text has only characters that type() accepts.
  double value = 0.0;
  double place = 0.0;
  for (const char character : typed_) {
    if (character == '.') {
      place = 1.0;
    }
    else if (character != '-' && place == 0.0) {
      value = 10.0 * value + (character - '0');
    }
    else if (character != '-') {
      place *= 0.1;
      value += place * (character - '0');
    }
  }
  value = std::min(value, scene::number_max);
  return typed_.starts_with('-') ? -value : value;
}

glm::dvec3 TransformOperation::way_ws() const
{
  const glm::dvec3 axis = view::axis_ws(start_ws_, transform_.axis, transform_.orientation);
  if (const std::optional<double> metres = typed()) {
    return *metres * axis;
  }
  const Ray from = map_.ray_through(start_pointer_);
  const Ray to = map_.ray_through(pointer_);
  if (transform_.axis == TransformAxis::All) {
    const glm::dvec3 normal = map_.axis_ws(2);
    return on_plane(to, position_ws(), normal) - on_plane(from, position_ws(), normal);
  }
  const double to_eye = glm::dot(axis, map_.towards_eye(position_ws()));
  if (std::abs(to_eye) > along_sight) {
    // The nearest point of the axis to the pointer's ray is the eye. Therefore moving the pointer up moves the node
    // away from the eye.
    const double up_m = (start_pointer_.y - pointer_.y) * map_.metres_per_pixel(position_ws());
    return (to_eye > 0.0 ? -up_m : up_m) * axis;
  }
  return (nearest_on_axis(to, position_ws(), axis) - nearest_on_axis(from, position_ws(), axis)) * axis;
}

glm::dvec3 TransformOperation::rotation_axis_ws() const
{
  return transform_.axis == TransformAxis::All ? map_.towards_eye(position_ws())
                                               : view::axis_ws(start_ws_, transform_.axis, transform_.orientation);
}

double TransformOperation::angle() const
{
  if (const std::optional<double> degrees = typed()) {
    return *degrees * pi / 180.0;
  }
  // A positive rotation around an axis that points away from the eye is clockwise on the screen.
  return glm::dot(rotation_axis_ws(), map_.towards_eye(position_ws())) >= 0.0 ? pointer_angle_ : -pointer_angle_;
}

double TransformOperation::factor() const
{
  if (const std::optional<double> value = typed()) {
    return *value;
  }
  const std::optional<glm::dvec2> middle = map_.pixel_of(position_ws());
  if (!middle) {
    return 1.0;
  }
  return glm::distance(pointer_, *middle) / std::max(glm::distance(start_pointer_, *middle), distance_min_px);
}

glm::dmat4 TransformOperation::parent_from_node() const
{
  glm::dmat4 world = start_ws_;
  switch (transform_.kind) {
    case TransformKind::Move: world[3] += glm::dvec4(way_ws(), 0.0); break;
    case TransformKind::Rotate: world = rotated(start_ws_, rotation_axis_ws(), angle()); break;
    case TransformKind::Scale: world = scaled(start_ws_, transform_, factor()); break;
  }
  return affine(parent_from_world_ * world);
}

glm::dmat4 TransformOperation::change_ws() const
{
  const glm::dmat4 from_position = glm::translate(glm::dmat4(1.0), position_ws());
  const glm::dmat4 to_position = glm::translate(glm::dmat4(1.0), -position_ws());
  switch (transform_.kind) {
    case TransformKind::Move: return glm::translate(glm::dmat4(1.0), way_ws());
    case TransformKind::Rotate:
      return from_position * glm::rotate(glm::dmat4(1.0), angle(), rotation_axis_ws()) * to_position;
    case TransformKind::Scale: break;
  }
  const glm::dmat4 scale = scaled(glm::dmat4(1.0), transform_, factor());
  if (transform_.axis == TransformAxis::All || transform_.orientation == Orientation::World) {
    return from_position * scale * to_position;
  }
  return has_inverse(start_ws_) ? affine(start_ws_ * scale * glm::inverse(start_ws_)) : glm::dmat4(1.0);
}

std::string TransformOperation::text() const
{
  std::string where;
  if (transform_.axis != TransformAxis::All) {
    where = fmt::format("{}{}{}", transform_.kind == TransformKind::Rotate ? " around " : " along ",
                        transform_.orientation == Orientation::Local ? "its " : "", "XYZ"[index_of(transform_.axis)]);
  }
  const std::string cursor = typed_.empty() ? "" : fmt::format("  [{}]", typed_);
  switch (transform_.kind) {
    case TransformKind::Move: {
      const glm::dvec3 way = way_ws();
      return fmt::format("Move{}: {:.4g}, {:.4g}, {:.4g} m{}", where, way.x, way.y, way.z, cursor);
    }
    case TransformKind::Rotate:
      return fmt::format("Rotate{}: {:.4g}°{}", where, shown_number(angle() * 180.0 / pi, "°"), cursor);
    case TransformKind::Scale: break;
  }
  return fmt::format("Scale{}: {:.4g}{}", where, factor(), cursor);
}

}  // namespace gnomon::view
