// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "draw_target.hh"
#include "render_scene.hh"

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/** Additions of an editor to a picture: the object under a pixel, an outline of selected objects, and lines. */
namespace gnomon::overlay {

enum class ShaderId;
enum class Feature : std::uint32_t;

/** A point on a triangle of a mesh. */
struct TrianglePoint {
  /** The corners are the vertices that Mesh::indices names at 3 · index, 3 · index + 1 and 3 · index + 2. */
  std::uint32_t index = 0;
  /** Weights of these corners: at least 0, with the sum 1. They interpolate every stream of the mesh. */
  glm::dvec3 barycentric{1.0, 0.0, 0.0};
  /** Interpolated Mesh::uvs; (0, 0) if the mesh has none. */
  glm::vec2 uv{0.0F};
  /**
   * Interpolated Mesh::normals, a unit vector in world space; the triangle's normal where they add up to zero. It is on
   * the front side, also where the back is seen.
   */
  glm::vec3 normal_ws{0.0F, 0.0F, 1.0F};
};

/** The surface at the middle of a pixel. */
struct Hit {
  scene::Handle<scene::Node> node;
  scene::Handle<scene::Mesh> mesh;
  /** World space of the scene, metres. On the triangle, if there is one; otherwise from the depth of the pixel. */
  glm::dvec3 position_ws{0.0};
  /**
   * The triangle of the mesh in its present pose. Empty for points, lines and meshes in buffers of a host, and where
   * rounding leaves no triangle at the drawn depth.
   */
  std::optional<TrianglePoint> triangle{};
};

/** Which of the objects in an area of a picture Overlay::select finds. */
enum class Reach {
  /** Objects that are seen there. */
  Visible,
  /** All, also where other objects cover them. */
  Through
};

/** How much of a node must be in an area, so that Overlay::select finds it. */
enum class Extent {
  /** At least one pixel. */
  Part,
  /**
   * All that the picture would show if nothing covered it. A node that reaches beyond the edge of the picture, or
   * behind the eye, is not found.
   */
  Whole
};

/**
 * The corners of a rectangle in a picture, for Overlay::select. \a from_px and \a to_px: any two opposite corners, in
 * pixels from the lower left corner of the picture.
 */
[[nodiscard]] std::array<glm::dvec2, 4> rectangle(const glm::dvec2 &from_px, const glm::dvec2 &to_px);

/**
 * Whether \a point is within the closed polygon \a corners, of at least 3. Where the outline crosses itself, a point is
 * inside if a line from it to infinity crosses the outline an odd number of times.
 */
[[nodiscard]] bool is_inside(std::span<const glm::dvec2> corners, const glm::dvec2 &point);

/** A straight line between two points. */
struct Line {
  /** Ends in world space of the scene, metres; absolute values below 1e18. */
  glm::dvec3 from_ws{0.0};
  glm::dvec3 to_ws{0.0};
  /** Not premultiplied, and stored as Target::encoding stores; the view transform does not change it. */
  glm::vec4 color{1.0F};
  /** Width in the picture at every distance, pixels; above 0. */
  float width_px = 1.5F;
  /** Whether the line is also drawn where objects hide it. */
  bool is_on_top = false;
};

/**
 * Picks, selects and outlines the objects of a render scene, in pictures of any engine and viewport: a picture is given
 * by its view (SceneRenderer::view_of, draw::Viewport::view) and its size. The first call of each function creates the
 * resources that it needs. A host with several viewports may use one overlay for all; with one for each, lines of
 * pictures that refine at the same time need fewer passes.
 *
 * Objects are as render_scene::RenderScene::update found them. Each function throws gpu::Error where the scene was
 * edited since. Device's thread, and not while the device is recording.
 */
class Overlay {
 public:
  /** \a scene must outlive the overlay. */
  explicit Overlay(render_scene::RenderScene &scene) : scene_(scene) {}

  /**
   * The nearest surface at the middle of \a pixel_px, from the lower left corner; nothing: there is none, or the pixel
   * is not in the picture. Parts that an alpha mask cuts out, back faces of one-sided materials and invisible nodes are
   * no surface. Draws the objects that the pixel can see into one pixel, and waits for it. The CPU then searches all
   * triangles of the mesh for the one that was drawn.
   */
  [[nodiscard]] std::optional<Hit> pick(const draw::View &view, glm::ivec2 size_px, glm::ivec2 pixel_px);
  /**
   * The nodes with a surface, as pick() defines it, at the middle of at least one pixel within the closed polygon
   * \a polygon_px: a rectangle() or the path of a lasso. Corners are in pixels from the lower left corner of the
   * picture, whose lowest left pixel has its middle at (0.5, 0.5); they may be outside of the picture, and fewer than 3
   * enclose nothing. \see is_inside. Each node is there once, in the order of the objects.
   *
   * Draws the objects in the rectangle around the outline once for Reach::Visible, and reads that back. Reach::Through
   * repeats it without the objects that were found until there are no more, as often as objects lie behind each other.
   * Extent::Whole also draws the nodes that were found, alone and into the whole picture, until none of those that are
   * left has a pixel outside, and the CPU looks for their vertices beyond the edges or before the near plane.
   * \throws gpu::Error if a corner is not finite
   */
  [[nodiscard]] std::vector<scene::Handle<scene::Node>> select(const draw::View &view, glm::ivec2 size_px,
                                                               std::span<const glm::dvec2> polygon_px, Reach reach,
                                                               Extent extent = Extent::Part);
  /**
   * The four planes through the sides of a rectangle of the picture, for SceneRenderer::set_clip_planes: they leave
   * what the rectangle shows, near and far. \a from_px and \a to_px: as of rectangle(). The rectangle is rounded to
   * whole pixels, at least one, and those outside of the picture are left out.
   */
  [[nodiscard]] std::vector<glm::dvec4> planes_around(const draw::View &view, glm::ivec2 size_px,
                                                      const glm::dvec2 &from_px, const glm::dvec2 &to_px) const;
  /**
   * Draw a line around each object of \a nodes over the content of \a target, also where other objects hide it. Nodes
   * that are not visible (Node::is_visible, or hidden in the view) have none. An empty target stays as it is.
   * \a color: not premultiplied, and stored as Target::encoding stores; the view transform does not change it.
   * Target::composition and depth have no effect. \throws gpu::Error as draw::check
   */
  void draw_outline(const draw::View &view, glm::ivec2 size_px, std::span<const scene::Handle<scene::Node>> nodes,
                    const glm::vec4 &color, const draw::Target &target);

  /**
   * Draw \a lines over the content of \a target, in order. Parts beyond the near plane or the picture's edge are left
   * out. Lines that are not on top are hidden by the scene's objects, as pick() sees them, whatever depth the target
   * has; for them the objects are drawn once more when the view, the size or the scene changes. Target::composition and
   * depth have no effect. \throws gpu::Error as draw::check, and for a line that is not finite or has no width
   */
  void draw_lines(const draw::View &view, glm::ivec2 size_px, std::span<const Line> lines, const draw::Target &target);

 private:
  /** Textures with the object and the depth at each pixel. */
  struct ObjectsTarget {
    gpu::Texture objects;
    gpu::Texture depth;
    gpu::Framebuffer framebuffer;
  };
  /** Key of a target with all objects. */
  struct ObjectsKey {
    draw::View view;
    /** `view` is relative to it. */
    glm::dvec3 origin_ws{0.0};
    glm::ivec2 size_px{0};
    scene::Revision scene = 0;
    std::uint64_t content = 0;
    std::uint64_t loss_count = 0;

    bool operator==(const ObjectsKey &) const = default;
  };
  using IsDrawn = std::function<bool(draw::ObjectIndex object)>;

  void check_up_to_date() const;
  const gpu::Shader &shader(ShaderId id, Feature features);
  void make(ObjectsTarget &target, glm::ivec2 size_px);
  /** Write the blocks of passes that draw objects. \a picture: the viewport of the pass. */
  void write_view(const draw::View &view, const gpu::Rectangle &picture);
  /**
   * Append a pass that draws the objects that \a view sees and \a is_drawn accepts into \a target.
   * \return whether there is anything
   */
  bool record_objects(const draw::View &view, glm::ivec2 size_px, const IsDrawn &is_drawn, ObjectsTarget &target,
                      gpu::CommandList &list);

  /**
   * By object, whether it is drawn at one of the pixels of \a region whose \a mask, row by row, is not 0.
   * \a reach: Through looks behind the objects that were found until there are no more
   */
  [[nodiscard]] std::vector<bool> objects_at(const draw::View &view, glm::ivec2 size_px, const gpu::Rectangle &region,
                                             std::span<const std::uint8_t> mask, Reach reach, const IsDrawn &is_drawn);
  /** Whether all vertices of an object are in the picture and before the eye. */
  [[nodiscard]] bool is_in_picture(const draw::View &view, draw::ObjectIndex object) const;
  /** Draw all objects into hiding_, unless they are there. \return whether there is one */
  bool update_hiding(const draw::View &view, glm::ivec2 size_px);
  void upload(std::span<const Line> lines);
  const gpu::Sampler &nearest();

  render_scene::RenderScene &scene_;
  std::map<std::pair<ShaderId, Feature>, std::shared_ptr<gpu::SharedShader>> shaders_;
  gpu::Buffer view_block_;
  gpu::Sampler nearest_;
  ObjectsTarget pixel_;
  /** The objects of an outline. */
  ObjectsTarget mask_;
  /** All objects, for lines that they hide. */
  ObjectsTarget hiding_;
  ObjectsKey hiding_key_;
  bool has_hiding_ = false;
  /** Content of line_block. */
  gpu::Buffer line_block_;
};

/** \a view, restricted to some pixels of a picture of \a size_px, from the lower left corner. */
[[nodiscard]] draw::View view_of_region(const draw::View &view, glm::ivec2 size_px, const gpu::Rectangle &region);

}  // namespace gnomon::overlay
