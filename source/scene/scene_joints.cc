// SPDX-License-Identifier: MIT
#include "scene_joints.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <type_traits>
#include <unordered_map>
#include <utility>

namespace gnomon::scene {

namespace {

constexpr std::size_t open_edges_max = std::size_t(1) << 15U;
constexpr std::size_t compared_vertices_max = std::size_t(1) << 20U;
/** Pairs of a vertex and an edge in a cell of the grid. */
constexpr std::size_t pairs_max = std::size_t(1) << 22U;
/** Two units in the last place of a coordinate of 1: vertices that are meant to be equal differ by less. */
constexpr double coordinate_rounding = 0x1p-22;

/** An edge of a triangle: the place in Mesh::indices of its first corner. */
using EdgePlace = std::uint32_t;

EdgePlace next_corner(EdgePlace place)
{
  return place % 3 == 2 ? place - 2 : place + 1;
}

/** \see weld_steps */
std::uint64_t position_key(const glm::vec3 &position, float steps)
{
  std::uint64_t key = 0;
  for (int i = 0; i < 3; i++) {
    key = (key ^ std::uint64_t(std::int64_t(std::rint(position[i] * steps)))) * 0x9e3779b97f4a7c15U;
    key ^= key >> 29U;
  }
  return key;
}

/**
 * Steps in a unit of the coordinates of \a mesh: vertices whose coordinates are in the same steps are one. Twice the
 * rounding of the largest one, because the ends of a seam may differ by that.
 */
float weld_steps(const Mesh &mesh)
{
  const glm::vec3 reach = glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max));
  return float(0.5 / (coordinate_rounding * std::max({double(reach.x), double(reach.y), double(reach.z), 1e-30})));
}

/** Numbers by keys of 64 bits. */
class Numbers {
 public:
  explicit Numbers(std::size_t count) : slots_(std::bit_ceil(2 * count + 1)) {}

  /** The number of \a key; 0 if it is new. */
  std::uint64_t &operator[](std::uint64_t key)
  {
    Slot &slot = slots_[place_of(key)];
    slot.key = used(key);
    return slot.number;
  }
  /** 0 if there is none. */
  [[nodiscard]] std::uint64_t find(std::uint64_t key) const
  {
    return slots_[place_of(key)].number;
  }

 private:
  struct Slot {
    /** 0: free. */
    std::uint64_t key = 0;
    std::uint64_t number = 0;
  };
  static std::uint64_t used(std::uint64_t key)
  {
    return std::max<std::uint64_t>(key, 1);
  }
  [[nodiscard]] std::size_t place_of(std::uint64_t key) const
  {
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = (used(key) * 0x9e3779b97f4a7c15U >> 32U) & mask;
    while (slots_[place].key != used(key) && slots_[place].key != 0) {
      place = (place + 1) & mask;
    }
    return place;
  }

  std::vector<Slot> slots_;
};

/**
 * The edges of \a mesh that only one triangle has, where vertices at the same position are one. \a vertices_left: how
 * many vertices may still be compared. \return nothing where they do not suffice.
 */
std::optional<std::vector<EdgePlace>> open_edges(const Mesh &mesh, std::size_t &vertices_left)
{
  std::vector<std::uint64_t> keys(mesh.positions.size());
  std::ranges::transform(mesh.positions, keys.begin(), [steps = weld_steps(mesh)](const glm::vec3 &position) {
    return position_key(position, steps);
  });
  // The vertices that follow around a vertex, less those that precede: 0 where the triangles around it are closed.
  std::vector<std::uint64_t> sums(keys.size(), 0);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t *corner = &mesh.indices[i];
    for (int k = 0; k < 3; k++) {
      sums[corner[k]] += keys[corner[(k + 1) % 3]] - keys[corner[(k + 2) % 3]];
    }
  }
  const std::size_t open_count = sums.size() - std::size_t(std::ranges::count(sums, 0U));
  if (open_count > vertices_left) {
    return std::nullopt;
  }
  vertices_left -= open_count;
  if (open_count == 0) {
    return std::vector<EdgePlace>();
  }
  Numbers sum_at(open_count);
  for (std::size_t i = 0; i < sums.size(); i++) {
    if (sums[i] != 0) {
      sum_at[keys[i]] += sums[i];
    }
  }
  for (std::size_t i = 0; i < sums.size(); i++) {
    if (sums[i] != 0) {
      sums[i] = sum_at[keys[i]];
    }
  }
  std::vector<EdgePlace> places;
  for (EdgePlace place = 0; place < mesh.indices.size(); place++) {
    if (sums[mesh.indices[place]] != 0 && sums[mesh.indices[next_corner(place)]] != 0) {
      places.push_back(place);
    }
  }
  Numbers count_of(places.size());
  const auto count = [&](EdgePlace place) -> std::uint64_t & {
    return count_of[keys[mesh.indices[place]] + keys[mesh.indices[next_corner(place)]]];
  };
  for (const EdgePlace place : places) {
    count(place)++;
  }
  std::erase_if(places, [&](EdgePlace place) { return count(place) != 1; });
  return places;
}

/** A mesh at a place in the world. */
struct Body {
  Handle<Mesh> handle;
  const Mesh *mesh = nullptr;
  glm::dmat4 world_from_object{1.0};
  glm::dmat4 object_from_world{1.0};
  /** Error of a coordinate of the mesh in world space, metres. */
  double rounding = 0.0;

  [[nodiscard]] glm::dvec3 world(const glm::vec3 &position) const
  {
    return glm::dvec3(world_from_object * glm::dvec4(position, 1.0));
  }
};

std::vector<Body> bodies_of(const Scene &scene)
{
  std::vector<Body> bodies;
  for (const Object &object : scene.objects()) {
    const Mesh &mesh = scene.meshes()[object.mesh];
    const Material &material = scene.material_of(mesh);
    if (mesh.topology != Topology::Triangles || mesh.positions.empty() || material.alpha_mode != AlphaMode::Opaque ||
        material.has_transmission() || glm::determinant(object.world_from_object) == 0.0 ||
        std::ranges::find(scene.deformed_meshes, object.mesh, &DeformedMesh::mesh) != scene.deformed_meshes.end()) {
      continue;
    }
    const glm::dvec3 scale = scale_of(object.world_from_object);
    const glm::vec3 reach = glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max));
    bodies.push_back(
        {object.mesh, &mesh, object.world_from_object, glm::inverse(object.world_from_object),
         coordinate_rounding * std::max({scale.x, scale.y, scale.z}) * double(std::max({reach.x, reach.y, reach.z}))});
  }
  return bodies;
}

/** In world space. */
struct OpenEdge {
  std::array<glm::dvec3, 2> ends{};
  const Body *body = nullptr;
  EdgePlace place = 0;
};

/** The open edges by cells of a grid around them. */
class EdgeGrid {
 public:
  /** \a rounding: the largest one of all bodies. */
  EdgeGrid(const std::vector<OpenEdge> &edges, double rounding) : rounding_(2.0 * rounding)
  {
    for (const OpenEdge &edge : edges) {
      for (const glm::dvec3 &end : edge.ends) {
        min_ = glm::min(min_, end);
        max_ = glm::max(max_, end);
      }
    }
    min_ -= rounding_;
    max_ += rounding_;
    double length = 0.0;
    for (const OpenEdge &edge : edges) {
      length += glm::distance(edge.ends[0], edge.ends[1]) / double(edges.size());
    }
    const glm::dvec3 size = max_ - min_;
    const double extent = std::max({size.x, size.y, size.z, 1e-30});
    // A cell is about as large as an edge, so that it has few of them.
    cells_ = 1.0 / std::clamp(length, extent / double(cell_count), extent / 64.0);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < edges.size(); i++) {
      visit(edges[i].ends[0], edges[i].ends[1], rounding_, [&](std::uint64_t cell) { pairs.emplace_back(cell, i); });
    }
    std::ranges::sort(pairs);
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    first_ = Numbers(pairs.size());
    for (const auto &[cell, edge] : pairs) {
      std::uint64_t &first = first_[cell];
      if (first == 0) {
        items_.push_back(items_end);
        first = items_.size();
      }
      items_.push_back(edge);
    }
    items_.push_back(items_end);
  }

  /** Calls \a use with the index of each edge that may touch the line from \a a to \a b; some twice. */
  template <typename Use>
  void near(const glm::dvec3 &a, const glm::dvec3 &b, const Use &use) const
  {
    visit(a, b, 0.0, [&](std::uint64_t cell) {
      const std::uint64_t first = first_.find(cell);
      for (std::uint64_t i = first; first != 0 && items_[i] != items_end; i++) {
        use(items_[i]);
      }
    });
  }

  /** Whether a cell that a box touches has an edge. True where these are more than \a looked_up_max. */
  [[nodiscard]] bool is_near(const glm::dvec3 &min, const glm::dvec3 &max, int looked_up_max) const
  {
    if (!touches(min, max)) {
      return false;
    }
    const glm::ivec3 first = coordinates(glm::max(min, min_));
    const glm::ivec3 size = coordinates(max) - first + 1;
    if (std::int64_t(size.x) * size.y * size.z > looked_up_max) {
      return true;
    }
    const std::uint64_t start = index_of(first);
    for (int z = 0; z < size.z; z++) {
      for (int y = 0; y < size.y; y++) {
        for (int x = 0; x < size.x; x++) {
          if (first_.find(start + index_of({x, y, z}) - index_of({0, 0, 0})) != 0) {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  /** The largest number along an axis. */
  static constexpr int cell_count = 512;
  /** Follows the edges of a cell in `items_`. */
  static constexpr std::uint32_t items_end = std::uint32_t(-1);

  [[nodiscard]] glm::ivec3 coordinates(const glm::dvec3 &point) const
  {
    return {(glm::min(point, max_) - min_) * cells_};
  }
  static std::uint64_t index_of(const glm::ivec3 &cell)
  {
    constexpr std::uint64_t stride = cell_count + 1;
    return (std::uint64_t(cell.z) * stride + std::uint64_t(cell.y)) * stride + std::uint64_t(cell.x) + 1;
  }

  [[nodiscard]] bool touches(const glm::dvec3 &min, const glm::dvec3 &max) const
  {
    return min.x <= max_.x && min.y <= max_.y && min.z <= max_.z && max.x >= min_.x && max.y >= min_.y &&
           max.z >= min_.z;
  }

  template <typename Use>
  void for_cells(const glm::dvec3 &min, const glm::dvec3 &max, const Use &use) const
  {
    if (!touches(min, max)) {
      return;
    }
    const glm::ivec3 first = coordinates(glm::max(min, min_));
    const glm::ivec3 last = coordinates(max);
    for (int z = first.z; z <= last.z; z++) {
      for (int y = first.y; y <= last.y; y++) {
        for (int x = first.x; x <= last.x; x++) {
          use(index_of({x, y, z}));
        }
      }
    }
  }

  template <typename Use>
  void visit(const glm::dvec3 &a, const glm::dvec3 &b, double reach, const Use &use) const
  {
    // The line is divided into parts of at most two cells, because the box of a long diagonal has many cells.
    const glm::dvec3 size = glm::abs(b - a);
    const int parts = 1 + int(std::min(0.5 * cells_ * std::max({size.x, size.y, size.z}), 2.0 * cell_count));
    for (int i = 0; i < parts; i++) {
      const glm::dvec3 from = i == 0 ? a : glm::mix(a, b, double(i) / parts);
      const glm::dvec3 to = i + 1 == parts ? b : glm::mix(a, b, double(i + 1) / parts);
      for_cells(glm::min(from, to) - reach, glm::max(from, to) + reach, use);
    }
  }

  glm::dvec3 min_{1e300};
  glm::dvec3 max_{-1e300};
  /** Edges are in all cells within this distance. */
  double rounding_ = 0.0;
  /** Number of cells in a metre. */
  double cells_ = 1.0;
  /** The place in `items_` of the first edge of each cell; 0: the cell has none. */
  Numbers first_{0};
  std::vector<std::uint32_t> items_;
};

/** A new vertex on an edge of a triangle. */
struct Cut {
  EdgePlace place = 0;
  /** Place of the vertex along the edge: 0 at the first corner, 1 at the second. */
  double along = 0.0;
  /** Position of the vertex in the space of the mesh. */
  glm::vec3 position{0.0F};
};

using CutsOf = std::unordered_map<Handle<Mesh>, std::vector<Cut>>;

/** Cut the edge of \a body from \a a to \a b at \a point, a vertex of \a other, if it is there. */
void cut_at(const Body &body, EdgePlace place, const glm::dvec3 &a, const glm::dvec3 &b, const Body &other,
            const glm::vec3 &vertex, const glm::dvec3 &point, CutsOf &cuts_of)
{
  const double rounding = std::max(body.rounding, other.rounding);
  for (int i = 0; i < 3; i++) {
    // Most points are beside the box of the edge.
    if (point[i] < std::min(a[i], b[i]) - rounding || point[i] > std::max(a[i], b[i]) + rounding) {
      return;
    }
  }
  const glm::dvec3 edge = b - a;
  const double along = glm::dot(point - a, edge) / glm::dot(edge, edge);
  // False for NaN too.
  if (along > 0.0 && along < 1.0 && glm::distance(point, a + along * edge) <= rounding &&
      glm::distance(point, a) > rounding && glm::distance(point, b) > rounding) {
    const bool is_same = body.world_from_object == other.world_from_object;
    cuts_of[body.handle].push_back(
        {place, along, is_same ? vertex : glm::vec3(body.object_from_world * glm::dvec4(point, 1.0))});
  }
}

/** \see EdgeGrid::is_near. Larger bodies and triangles are likely to be near an edge. */
constexpr int body_cells_max = 512;
constexpr int triangle_cells_max = 27;

/**
 * Finds the vertices of \a body on \a edges, and those of \a edges on edges of \a body. \a pairs_left: how many pairs
 * may still be compared. 0 afterwards: some were not.
 */
void find_cuts(const Body &body, const std::vector<OpenEdge> &edges, const EdgeGrid &grid, std::size_t &pairs_left,
               CutsOf &cuts_of)
{
  const Mesh &mesh = *body.mesh;
  glm::dvec3 min(1e300);
  glm::dvec3 max(-1e300);
  for (unsigned i = 0; i < 8; i++) {
    const glm::dvec3 corner = body.world({(i & 1U) != 0 ? mesh.bounds.max.x : mesh.bounds.min.x,
                                          (i & 2U) != 0 ? mesh.bounds.max.y : mesh.bounds.min.y,
                                          (i & 4U) != 0 ? mesh.bounds.max.z : mesh.bounds.min.z});
    min = glm::min(min, corner);
    max = glm::max(max, corner);
  }
  if (!grid.is_near(min, max, body_cells_max)) {
    return;
  }
  std::vector<glm::dvec3> points(mesh.positions.size());
  for (std::size_t i = 0; i < points.size(); i++) {
    points[i] = body.world(mesh.positions[i]);
    grid.near(points[i], points[i], [&](std::uint32_t index) {
      if (pairs_left == 0) {
        return;
      }
      pairs_left--;
      const OpenEdge &edge = edges[index];
      cut_at(*edge.body, edge.place, edge.ends[0], edge.ends[1], body, mesh.positions[i], points[i], cuts_of);
    });
  }
  for (EdgePlace first = 0; first < mesh.indices.size(); first += 3) {
    const auto corner = [&](EdgePlace place) -> const glm::dvec3 & { return points[mesh.indices[place]]; };
    const glm::dvec3 low = glm::min(glm::min(corner(first), corner(first + 1)), corner(first + 2));
    const glm::dvec3 high = glm::max(glm::max(corner(first), corner(first + 1)), corner(first + 2));
    if (!grid.is_near(low, high, triangle_cells_max)) {
      continue;
    }
    for (EdgePlace place = first; place < first + 3; place++) {
      const glm::dvec3 &a = corner(place);
      const glm::dvec3 &b = corner(next_corner(place));
      grid.near(a, b, [&](std::uint32_t index) {
        if (pairs_left == 0) {
          return;
        }
        pairs_left--;
        const OpenEdge &edge = edges[index];
        const Mesh &other = *edge.body->mesh;
        for (const unsigned i : {0U, 1U}) {
          const std::uint32_t vertex = other.indices[i == 0 ? edge.place : next_corner(edge.place)];
          cut_at(body, place, a, b, *edge.body, other.positions[vertex], edge.ends[i], cuts_of);
        }
      });
    }
  }
}

/** Appends triangles with cut edges to a mesh. */
class Splitter {
 public:
  /** \a cuts: by place, and then along. */
  Splitter(Mesh &mesh, std::vector<Cut> cuts) : mesh_(mesh), cuts_(std::move(cuts)) {}

  void split()
  {
    const std::vector<std::uint32_t> indices = std::exchange(mesh_.indices, {});
    mesh_.indices.reserve(indices.size() + 3 * cuts_.size());
    auto cut = cuts_.begin();
    for (EdgePlace first = 0; first < indices.size(); first += 3) {
      std::array<Side, 3> sides;
      for (EdgePlace k = 0; k < 3; k++) {
        const EdgePlace place = first + k;
        sides[k].start = indices[place];
        for (; cut != cuts_.end() && cut->place == place; ++cut) {
          sides[k].cuts.push_back(vertex_at(indices[place], indices[next_corner(place)], *cut));
        }
      }
      add(std::move(sides));
    }
  }

 private:
  /** A side of a triangle: its first corner and the vertices on it. */
  struct Side {
    std::uint32_t start = 0;
    std::vector<std::uint32_t> cuts;
  };

  void add(std::array<Side, 3> sides)
  {
    const auto cut = std::ranges::find_if(sides, [](const Side &side) { return !side.cuts.empty(); });
    if (cut == sides.end()) {
      for (const Side &side : sides) {
        mesh_.indices.push_back(side.start);
      }
      return;
    }
    // Divide it by lines from all vertices on one side to the opposite corner. Only the first and the last triangle
    // have another side of the whole, whose vertices divide them again.
    std::rotate(sides.begin(), cut, sides.end());
    const std::vector<std::uint32_t> vertices = std::move(sides[0].cuts);
    const std::uint32_t opposite = sides[2].start;
    add({Side{sides[0].start, {}}, Side{vertices.front(), {}}, std::move(sides[2])});
    for (std::size_t i = 1; i < vertices.size(); i++) {
      mesh_.indices.insert(mesh_.indices.end(), {vertices[i - 1], vertices[i], opposite});
    }
    add({Side{vertices.back(), {}}, std::move(sides[1]), Side{opposite, {}}});
  }

  std::uint32_t vertex_at(std::uint32_t a, std::uint32_t b, const Cut &cut)
  {
    for_each_stream(mesh_, [&](auto &stream) {
      using Value = typename std::remove_reference_t<decltype(stream)>::value_type;
      const Value value = stream[a] == stream[b] ? stream[a] : glm::mix(stream[a], stream[b], float(cut.along));
      stream.push_back(value);
    });
    mesh_.positions.back() = cut.position;
    if (!mesh_.normals.empty() && mesh_.normals[a] != mesh_.normals[b]) {
      mesh_.normals.back() = unit_or(mesh_.normals.back(), mesh_.normals[a]);
    }
    if (!mesh_.tangents.empty() && mesh_.tangents[a] != mesh_.tangents[b]) {
      mesh_.tangents.back() =
          glm::vec4(unit_or(glm::vec3(mesh_.tangents.back()), glm::vec3(mesh_.tangents[a])), mesh_.tangents[a].w);
    }
    return std::uint32_t(mesh_.positions.size() - 1);
  }

  static glm::vec3 unit_or(const glm::vec3 &vector, const glm::vec3 &other)
  {
    const float length = glm::length(vector);
    return length > 0.0F ? vector / length : other;
  }

  Mesh &mesh_;
  std::vector<Cut> cuts_;
};

}  // namespace

void close_joints(Scene &scene)
{
  const std::vector<Body> bodies = bodies_of(scene);
  std::unordered_map<Handle<Mesh>, std::vector<EdgePlace>> edges_of;
  std::size_t vertices_left = compared_vertices_max;
  std::vector<OpenEdge> edges;
  for (const Body &body : bodies) {
    const auto [found, is_new] = edges_of.try_emplace(body.handle);
    if (is_new) {
      std::optional<std::vector<EdgePlace>> places = open_edges(*body.mesh, vertices_left);
      if (!places) {
        return;
      }
      found->second = std::move(*places);
    }
    if (edges.size() + found->second.size() > open_edges_max) {
      return;
    }
    for (const EdgePlace place : found->second) {
      const auto end = [&](EdgePlace corner) { return body.world(body.mesh->positions[body.mesh->indices[corner]]); };
      edges.push_back({{end(place), end(next_corner(place))}, &body, place});
    }
  }
  if (edges.empty()) {
    return;
  }
  const EdgeGrid grid(edges, std::ranges::max(bodies, {}, &Body::rounding).rounding);
  CutsOf cuts_of;
  std::size_t pairs_left = pairs_max;
  for (const Body &body : bodies) {
    find_cuts(body, edges, grid, pairs_left, cuts_of);
    if (pairs_left == 0) {
      return;
    }
  }
  for (auto &[handle, cuts] : cuts_of) {
    Mesh mesh = scene.meshes()[handle];
    std::ranges::sort(cuts, {}, [](const Cut &cut) { return std::pair(cut.place, cut.along); });
    // Vertices of two triangles at the same place, up to rounding.
    const double rounding =
        coordinate_rounding * glm::length(glm::dvec3(glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max))));
    const auto is_same = [&](const Cut &a, const Cut &b) {
      return a.place == b.place && double(glm::distance(a.position, b.position)) <= rounding;
    };
    // clang 14 does not compile std::ranges::unique.
    cuts.erase(std::unique(cuts.begin(), cuts.end(), is_same), cuts.end());
    Splitter(mesh, std::move(cuts)).split();
    scene.replace(handle, std::move(mesh));
  }
}

}  // namespace gnomon::scene
