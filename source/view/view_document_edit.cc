// SPDX-License-Identifier: MIT
// Edits of the selected nodes.
#include "view_document.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gnomon::view {

static bool is_below(const scene::Scene &scene, scene::Handle<scene::Node> node, scene::Handle<scene::Node> ancestor)
{
  while (node && node != ancestor) {
    node = scene.parent(node);
  }
  return bool(node);
}

std::vector<scene::Handle<scene::Node>> Document::selected_roots() const
{
  const std::vector<scene::Handle<scene::Node>> nodes = selection();
  std::vector<scene::Handle<scene::Node>> roots;
  std::ranges::copy_if(nodes, std::back_inserter(roots), [&](scene::Handle<scene::Node> node) {
    scene::Handle<scene::Node> above = scene_.parent(node);
    while (above && !is_selected(above)) {
      above = scene_.parent(above);
    }
    return !above;
  });
  return roots;
}

void Document::set_world_picture(std::shared_ptr<const scene::WorldPicture> picture)
{
  if (!picture && !scene_.world()) {
    return;
  }
  // The colour of a world without a picture would tint the new picture.
  const bool is_kept = scene_.world() && (scene_.world()->picture || !picture);
  scene::World world = is_kept ? *scene_.world() : scene::World();
  world.picture = std::move(picture);
  set_world(std::move(world));
}

void Document::deform()
{
  try {
    scene::deform_meshes(scene_);
  }
  catch (const scene::InvalidEdit & /*fault*/) {
    // If joints are scaled beyond the range of float, the mesh keeps its last shape until an edit or undo scales them
    // back. The edit of the joints stays valid.
  }
}

void Document::follow_history()
{
  deform();
  if (!history_.restored().empty()) {
    select(history_.restored());
  }
  else if (!scene_.nodes().is_live(selected)) {
    // The nodes beside an addition that was undone.
    select(selection());
  }
}

bool Document::undo()
{
  const bool is_undone = history_.undo(scene_);
  follow_history();
  return is_undone;
}

bool Document::redo()
{
  const bool is_redone = history_.redo(scene_);
  follow_history();
  return is_redone;
}

void Document::pose(const scene::Animation &animation, double seconds)
{
  end_transform(true);
  const auto keep_saved = [this, was_saved = is_saved()] {
    saved_revision_ = was_saved ? scene_.revision() : saved_revision_;
  };
  try {
    scene::pose(scene_, animation, seconds);
  }
  catch (...) {
    // A part of the scene may be posed.
    keep_saved();
    throw;
  }
  keep_saved();
}

void Document::toggle_visibility()
{
  const std::vector<scene::Handle<scene::Node>> nodes = selection();
  if (nodes.empty()) {
    return;
  }
  const bool is_visible = !scene_.nodes()[nodes.front()].is_visible;
  history_.join([&] {
    for (const scene::Handle<scene::Node> node : nodes) {
      edit(node, [&](scene::Node &edited) { edited.is_visible = is_visible; });
    }
  });
}

void Document::add(const Addition &addition, const glm::dvec3 &position_ws, const glm::dmat4 &world_from_view)
{
  select(view::add(scene_, addition, position_ws, world_from_view));
  history_.note_added(scene_, selected);
}

bool Document::remove_selected()
{
  const std::vector<scene::Handle<scene::Node>> nodes = selection();
  history_.join([&] {
    for (const scene::Handle<scene::Node> node : nodes) {
      // It may be gone with an ancestor.
      if (scene_.nodes().is_live(node)) {
        history_.remove(scene_, node);
      }
    }
  });
  deform();
  select(scene::Handle<scene::Node>());
  return !nodes.empty();
}

bool Document::duplicate_selected()
{
  end_transform(true);
  std::vector<scene::Handle<scene::Node>> copies;
  NodeNames names(scene_);
  history_.join([&] {
    for (const scene::Handle<scene::Node> node : selected_roots()) {
      copies.push_back(duplicate(scene_, node, names));
      history_.note_added(scene_, copies.back());
    }
  });
  if (!copies.empty()) {
    select(copies);
  }
  return !copies.empty();
}

void Document::begin_transform(const Transform &transform, const PictureMap &map, const glm::dvec2 &pointer)
{
  operation_.emplace(scene_, selected, transform, map, pointer);
  history_.end_gesture();
  moved_.clear();
  const auto add = [&](scene::Handle<scene::Node> node) {
    moved_.push_back({node, scene_.nodes()[node].parent_from_node, scene_.world_from_node(node)});
  };
  add(selected);
  for (const scene::Handle<scene::Node> node : selected_roots()) {
    // An ancestor would move the operation's node a second time.
    if (node != selected && !is_below(scene_, selected, node)) {
      add(node);
    }
  }
}

void Document::update_transform()
{
  if (operation_ && !scene_.nodes().is_live(operation_->node())) {
    operation_.reset();
  }
  if (!operation_) {
    return;
  }
  scene_.set_transform(operation_->node(), operation_->parent_from_node());
  const glm::dmat4 &start_ws = operation_->start_ws();
  if (std::abs(glm::determinant(start_ws)) > 0.0) {
    const glm::dmat4 change = scene_.world_from_node(operation_->node()) * glm::inverse(start_ws);
    for (const Moved &moved : std::span(moved_).subspan(1)) {
      if (scene_.nodes().is_live(moved.node)) {
        // In the space of the parent, which the operation does not move.
        const scene::Handle<scene::Node> parent = scene_.parent(moved.node);
        const glm::dmat4 world_from_parent = parent ? scene_.world_from_node(parent) : glm::dmat4(1.0);
        if (std::abs(glm::determinant(world_from_parent)) > 0.0) {
          scene_.set_transform(moved.node, glm::inverse(world_from_parent) * change * moved.world_from_node);
        }
      }
    }
  }
  deform();
}

void Document::end_transform(bool is_kept)
{
  if (!operation_) {
    return;
  }
  operation_.reset();
  // The edits begin at the start of the operation.
  std::vector<glm::dmat4> ends;
  std::erase_if(moved_, [&](const Moved &moved) { return !scene_.nodes().is_live(moved.node); });
  for (const Moved &moved : moved_) {
    ends.push_back(scene_.nodes()[moved.node].parent_from_node);
    scene_.set_transform(moved.node, moved.parent_from_node);
  }
  if (is_kept) {
    history_.join([&] {
      for (std::size_t i = 0; i < moved_.size(); i++) {
        history_.edit(scene_, moved_[i].node, [&](scene::Node &node) { node.parent_from_node = ends[i]; });
      }
    });
  }
  deform();
}

}  // namespace gnomon::view
