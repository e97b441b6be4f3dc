// SPDX-License-Identifier: MIT
// Edits of the selected nodes.
#include "view_document.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace gnomon::view {

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
  end_transform(true);
  const bool is_undone = history_.undo(scene_);
  follow_history();
  return is_undone;
}

bool Document::redo()
{
  end_transform(true);
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
  end_transform(true);
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
  // Otherwise the edits of a running operation would be no undo step.
  end_transform(true);
  operation_.emplace(scene_, selected, transform, map, pointer);
  history_.end_gesture();
  moved_.clear();
  for (const scene::Handle<scene::Node> node : selected_roots()) {
    moved_.push_back({node, scene_.nodes()[node].parent_from_node, scene_.world_from_node(node)});
  }
}

void Document::update_transform()
{
  if (!operation_) {
    return;
  }
  if (!scene_.nodes().is_live(operation_->node())) {
    end_transform(true);
    return;
  }
  const glm::dmat4 change_ws = operation_->change_ws();
  for (const Moved &moved : moved_) {
    if (moved.node == operation_->node()) {
      // Without the rounding of change_ws, and also if the node's matrix has no inverse.
      scene_.set_transform(moved.node, operation_->parent_from_node());
      continue;
    }
    if (!scene_.nodes().is_live(moved.node)) {
      continue;
    }
    // The operation does not move the parents of roots.
    const scene::Handle<scene::Node> parent = scene_.parent(moved.node);
    const glm::dmat4 world_from_parent = parent ? scene_.world_from_node(parent) : glm::dmat4(1.0);
    if (has_inverse(world_from_parent)) {
      scene_.set_transform(moved.node, affine(glm::inverse(world_from_parent) * change_ws * moved.world_from_node));
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
