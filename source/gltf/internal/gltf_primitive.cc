// SPDX-License-Identifier: MIT
#include "internal/gltf_primitive.hh"

#include "internal/gltf_units.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>

namespace gnomon::gltf {

using scene::Mesh;
using scene::Topology;

namespace {

/** Largest texture coordinate. Beyond it floats do not distinguish texels. */
constexpr float uv_max = 1e6F;

bool is_uv(const glm::vec2 &uv)
{
  // False for NaN too.
  return std::abs(uv.x) <= uv_max && std::abs(uv.y) <= uv_max;
}

/** Clamps each component to [0, 1]; NaN becomes 0. */
glm::vec4 limited_color(const glm::vec4 &color)
{
  glm::vec4 limited;
  for (int i = 0; i < 4; i++) {
    limited[i] = color[i] >= 0.0F ? std::min(color[i], 1.0F) : 0.0F;
  }
  return limited;
}

bool is_position(const glm::vec3 &position)
{
  const glm::vec3 size = glm::abs(position);
  // False for NaN too.
  return size.x <= coordinate_max && size.y <= coordinate_max && size.z <= coordinate_max;
}

/** Twice the area times the unit normal, in double, so that no product of floats underflows or overflows. */
glm::dvec3 area_vector(const glm::vec3 &a, const glm::vec3 &b, const glm::vec3 &c)
{
  const glm::dvec3 origin(a);
  return glm::cross(glm::dvec3(b) - origin, glm::dvec3(c) - origin);
}

/** +Z for a vector of length 0. The squared length may leave double's range. */
glm::vec3 unit(const glm::dvec3 &vector)
{
  if (vector == glm::dvec3(0.0)) {
    return {0.0F, 0.0F, 1.0F};
  }
  const glm::dvec3 size = glm::abs(vector);
  return glm::vec3(glm::normalize(vector / std::max({size.x, size.y, size.z})));
}

std::uint32_t vertex_count(std::size_t count)
{
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    throw Fault("count", "is too large");
  }
  return static_cast<std::uint32_t>(count);
}

}  // namespace

PrimitiveReader::PrimitiveReader(const File &file, const Model::Primitive &primitive, std::string what,
                                 Warnings &warnings, bool is_deformed)
    : file_(file),
      primitive_(primitive),
      what_(std::move(what)),
      warnings_(warnings),
      is_deformed_(is_deformed),
      positions_(file, position_accessor(), vec3_type)
{
  const std::optional<Topology> topology = topology_of(primitive.mode);
  if (!topology) {
    throw Fault("mode", std::to_string(primitive.mode) + " is unknown");
  }
  topology_ = *topology;
  if (positions_.is_all_zero() && !primitive_.compression.empty()) {
    throw Fault("POSITION", "is compressed by " + printable(primitive_.compression));
  }
  if (primitive.indices >= 0) {
    indices_.emplace(file, primitive.indices, Model::ElementType::Scalar);
    if (!indices_->is_unsigned()) {
      throw Fault("indices", "are not unsigned integers");
    }
    if (indices_->is_all_zero() && !primitive_.compression.empty()) {
      throw Fault("indices", "are compressed by " + printable(primitive_.compression));
    }
  }
  open_normals(file);
}

std::uint64_t PrimitiveReader::element_count() const
{
  return positions_.count() + (indices_ ? indices_->count() : 0);
}

Mesh PrimitiveReader::read()
{
  Mesh mesh;
  mesh.topology = topology_;
  const std::uint32_t count = corner_count();
  switch (topology_) {
    case Topology::Triangles: add_elements(triangles_of(primitive_.mode, count, losses_), mesh); break;
    case Topology::Lines: add_elements(lines_of(primitive_.mode, count, losses_), mesh); break;
    case Topology::Points: {
      std::vector<Point> points(count);
      for (std::uint32_t i = 0; i < count; i++) {
        points[i] = {i};
      }
      add_elements(std::move(points), mesh);
    }
  }
  for (const glm::vec3 &position : mesh.positions) {
    mesh.bounds.extend(position);
  }
  if (mesh.indices.empty() && losses_ == Losses{}) {
    throw Fault("POSITION", topology_ == Topology::Triangles ? "makes no triangle" : "makes no line or point");
  }
  losses_.report(warnings_, what_, topology_);
  return mesh;
}

std::vector<glm::vec2> PrimitiveReader::read_uvs(int set)
{
  std::vector<glm::vec2> uvs(file_vertices_.size(), glm::vec2(0.0F));
  const std::string attribute = "TEXCOORD_" + std::to_string(set);
  try {
    const auto found = primitive_.attributes.find(attribute);
    if (found == primitive_.attributes.end()) {
      throw Fault(attribute, "is missing");
    }
    const AccessorReader reader(file_, found->second, Model::ElementType::Vec2);
    if (reader.count() != positions_.count()) {
      throw Fault(attribute, "count differs from that of POSITION");
    }
    Losses losses;
    for (std::size_t i = 0; i < uvs.size(); i++) {
      const glm::vec2 uv = reader.vec2(file_vertices_[i]);
      losses.bad_uvs += is_uv(uv) ? 0 : 1;
      uvs[i] = is_uv(uv) ? uv : glm::vec2(0.0F);
    }
    losses.report(warnings_, what_, topology_);
  }
  catch (const Fault &fault) {
    warnings_.add(what_, std::string("its texture is drawn as the colour of one corner: ") + fault.what());
  }
  return uvs;
}

std::vector<glm::vec4> PrimitiveReader::read_tangents()
{
  const auto found = primitive_.attributes.find("TANGENT");
  // glTF ignores the tangents of a primitive without normals.
  if (found == primitive_.attributes.end() || !normals_) {
    return {};
  }
  std::vector<glm::vec4> tangents;
  try {
    const AccessorReader reader(file_, found->second, Model::ElementType::Vec4);
    if (reader.count() != positions_.count()) {
      throw Fault("TANGENT", "count differs from that of POSITION");
    }
    for (const std::uint32_t vertex : file_vertices_) {
      const glm::vec4 tangent = reader.vec4(vertex);
      const glm::vec3 direction = unit_or_zero(glm::vec3(tangent));
      if (direction == glm::vec3(0.0F)) {
        throw Fault("TANGENT", "one is zero or not finite");
      }
      tangents.emplace_back(direction, tangent.w < 0.0F ? -1.0F : 1.0F);
    }
  }
  catch (const Fault &fault) {
    tangents.clear();
    warnings_.add(what_, std::string("tangents made instead: ") + fault.what());
  }
  return tangents;
}

std::vector<glm::vec4> PrimitiveReader::read_colors()
{
  const auto found = primitive_.attributes.find("COLOR_0");
  if (found == primitive_.attributes.end()) {
    return {};
  }
  std::vector<glm::vec4> colors;
  try {
    const bool is_vec3 = file_.model.accessors[found->second].type == vec3_type;
    const AccessorReader reader(file_, found->second, is_vec3 ? vec3_type : Model::ElementType::Vec4);
    if (reader.count() != positions_.count()) {
      throw Fault("COLOR_0", "count differs from that of POSITION");
    }
    if (!reader.is_color()) {
      throw Fault("COLOR_0", "holds neither floats nor normalized unsigned integers of 8 or 16 bits");
    }
    Losses losses;
    for (const std::uint32_t vertex : file_vertices_) {
      const glm::vec4 color = reader.color(vertex);
      colors.push_back(limited_color(color));
      losses.bad_colors += colors.back() == color ? 0 : 1;
    }
    losses.report(warnings_, what_, topology_);
    // Converters write zeros where the source had no colours.
    if (!colors.empty() &&
        std::ranges::all_of(colors, [](const glm::vec4 &color) { return glm::vec3(color) == glm::vec3(0.0F); })) {
      warnings_.add(what_, "its vertex colours are all black, which makes its base colour black");
    }
  }
  catch (const Fault &fault) {
    warnings_.add(what_, std::string("its vertex colours are left out: ") + fault.what());
  }
  return colors;
}

int PrimitiveReader::position_accessor() const
{
  const auto found = primitive_.attributes.find("POSITION");
  if (found == primitive_.attributes.end()) {
    throw Fault("POSITION", "is missing");
  }
  return found->second;
}

void PrimitiveReader::open_normals(const File &file)
{
  const auto found = primitive_.attributes.find("NORMAL");
  if (found == primitive_.attributes.end()) {
    return;
  }
  try {
    normals_.emplace(file, found->second, vec3_type);
    if (normals_->count() != positions_.count()) {
      throw Fault("NORMAL", "count differs from that of POSITION");
    }
  }
  catch (const Fault &fault) {
    normals_.reset();
    warnings_.add(what_, std::string("flat normals made instead: ") + fault.what());
  }
}

std::uint32_t PrimitiveReader::corner_count() const
{
  return vertex_count(indices_ ? indices_->count() : positions_.count());
}

template <typename Element>
void PrimitiveReader::add_elements(std::vector<Element> elements, Mesh &mesh)
{
  keep_drawable(elements);
  if constexpr (std::is_same_v<Element, Triangle>) {
    if (!normals_) {
      unshare_vertices(elements, mesh);
      return;
    }
  }
  share_vertices(elements, mesh);
  replace_zero_normals(mesh);
}

template <typename Element>
void PrimitiveReader::keep_drawable(std::vector<Element> &elements)
{
  const auto is_lost = [this](Element &element) {
    if (indices_) {
      std::transform(element.begin(), element.end(), element.begin(),
                     [this](std::uint32_t place) { return indices_->integer(place); });
    }
    return is_left_out(element);
  };
  // The order matters, and is_lost modifies its argument, so std::remove_if cannot be used.
  std::size_t kept = 0;
  for (Element &element : elements) {
    if (!is_lost(element)) {
      elements[kept++] = element;
    }
  }
  elements.resize(kept);
}

template <typename Element>
bool PrimitiveReader::is_left_out(const Element &element)
{
  if (std::any_of(element.begin(), element.end(), [this](std::uint32_t v) { return v >= positions_.count(); })) {
    losses_.out_of_range++;
    return true;
  }
  if constexpr (std::is_same_v<Element, Triangle>) {
    const auto [a, b, c] = element;
    if (primitive_.mode != Model::Triangles && (a == b || b == c || c == a)) {
      // Degenerate triangles join strips. They are not counted as lost.
      return true;
    }
  }
  std::array<glm::vec3, std::tuple_size_v<Element>> corners;
  std::transform(element.begin(), element.end(), corners.begin(),
                 [this](std::uint32_t vertex) { return positions_.vec3(vertex); });
  if (!std::all_of(corners.begin(), corners.end(), is_position)) {
    losses_.non_finite++;
    return true;
  }
  bool is_flat = false;
  if constexpr (std::is_same_v<Element, Triangle>) {
    const auto [a, b, c] = element;
    if (is_deformed_ && a != b && b != c && c != a) {
      return false;
    }
    is_flat = area_vector(corners[0], corners[1], corners[2]) == glm::dvec3(0.0);
  }
  else if constexpr (std::is_same_v<Element, Line>) {
    is_flat = corners[0] == corners[1] && (!is_deformed_ || element[0] == element[1]);
  }
  losses_.flat += is_flat ? 1 : 0;
  return is_flat;
}

template <typename Element>
void PrimitiveReader::share_vertices(const std::vector<Element> &elements, Mesh &mesh)
{
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> new_index(positions_.count(), unused);
  for (const Element &element : elements) {
    for (const std::uint32_t vertex : element) {
      new_index[vertex] = 0;
    }
  }
  for (std::size_t vertex = 0; vertex < new_index.size(); vertex++) {
    if (new_index[vertex] != unused) {
      new_index[vertex] = static_cast<std::uint32_t>(mesh.positions.size());
      file_vertices_.push_back(static_cast<std::uint32_t>(vertex));
      mesh.positions.push_back(positions_.vec3(vertex));
      mesh.normals.push_back(normals_ ? unit_or_zero(normals_->vec3(vertex)) : glm::vec3(0.0F, 0.0F, 1.0F));
    }
  }
  mesh.indices.reserve(std::tuple_size_v<Element> * elements.size());
  for (const Element &element : elements) {
    for (const std::uint32_t vertex : element) {
      mesh.indices.push_back(new_index[vertex]);
    }
  }
}

void PrimitiveReader::unshare_vertices(const std::vector<Triangle> &triangles, Mesh &mesh)
{
  const std::size_t count = 3 * triangles.size();
  mesh.positions.reserve(count);
  mesh.normals.reserve(count);
  mesh.indices.reserve(count);
  for (const Triangle &triangle : triangles) {
    for (const std::uint32_t vertex : triangle) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      file_vertices_.push_back(vertex);
      mesh.positions.push_back(positions_.vec3(vertex));
    }
    const glm::vec3 *corners = mesh.positions.data() + mesh.positions.size() - 3;
    mesh.normals.insert(mesh.normals.end(), 3, unit(area_vector(corners[0], corners[1], corners[2])));
  }
}

glm::vec3 PrimitiveReader::unit_or_zero(const glm::vec3 &normal)
{
  const bool is_usable =
      std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z) && normal != glm::vec3(0.0F);
  if (!is_usable) {
    return glm::vec3(0.0F);
  }
  // Vectors of unit length within rounding are kept unchanged, so that an exported scene is imported exactly.
  constexpr double rounding = 1e-6;
  const glm::dvec3 vector(normal);
  return std::abs(glm::dot(vector, vector) - 1.0) <= rounding ? normal : unit(vector);
}

void PrimitiveReader::replace_zero_normals(Mesh &mesh)
{
  for (std::size_t i = 0; i < mesh.indices.size(); i++) {
    glm::vec3 &normal = mesh.normals[mesh.indices[i]];
    if (normal != glm::vec3(0.0F)) {
      continue;
    }
    normal = glm::vec3(0.0F, 0.0F, 1.0F);
    if (topology_ == Topology::Triangles) {
      const std::uint32_t *corners = mesh.indices.data() + i / 3 * 3;
      normal = unit(area_vector(mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]));
    }
    losses_.bad_normals++;
  }
}

}  // namespace gnomon::gltf
