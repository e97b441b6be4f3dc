// SPDX-License-Identifier: MIT
// Edits of the selected nodes.
#include "view_document.hh"

#include <utility>

namespace gnomon::view {

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
  const bool was_saved = is_saved();
  scene::pose(scene_, animation, seconds);
  saved_revision_ = was_saved ? scene_.revision() : saved_revision_;
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
  if (!scene_.nodes().is_live(selected)) {
    return false;
  }
  select(duplicate(scene_, selected));
  history_.note_added(scene_, selected);
  return true;
}

void Document::begin_transform(const Transform &transform, const PictureMap &map, const glm::dvec2 &pointer)
{
  end_transform(true);
  operation_.emplace(scene_, selected, transform, map, pointer);
  history_.end_gesture();
}

void Document::update_transform()
{
  if (operation_ && !scene_.nodes().is_live(operation_->node())) {
    operation_.reset();
  }
  if (operation_) {
    const glm::dmat4 moved = operation_->parent_from_node();
    edit(operation_->node(), [&](scene::Node &node) { node.parent_from_node = moved; });
  }
}

void Document::end_transform(bool is_kept)
{
  if (!operation_) {
    return;
  }
  operation_.reset();
  if (is_kept) {
    history_.end_gesture();
  }
  else {
    history_.revert_gesture(scene_);
    deform();
  }
}

}  // namespace gnomon::view
