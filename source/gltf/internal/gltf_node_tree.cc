// SPDX-License-Identifier: MIT
#include "internal/gltf_node_tree.hh"

#include "internal/gltf_report.hh"

#include <algorithm>
#include <string>

namespace gnomon::gltf {

static std::string label_of(const Model &model, int node)
{
  return label("node", model.nodes[node].name, static_cast<std::size_t>(node));
}

/** The parent of each node, -1 for a root. \throws Fault if the nodes are not trees. */
static std::vector<int> parents(const Model &model)
{
  const std::vector<Model::Node> &nodes = model.nodes;
  std::vector<int> parent(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); i++) {
    for (const int child : nodes[i].children) {
      if (parent[child] >= 0) {
        throw Fault(label_of(model, child), "has two parents, " + label_of(model, parent[child]) + " and " +
                                                label_of(model, static_cast<int>(i)));
      }
      parent[child] = static_cast<int>(i);
    }
  }
  // Every node has at most one parent, so nodes that no root reaches are on a cycle or below one.
  std::vector<int> reached;
  for (std::size_t i = 0; i < nodes.size(); i++) {
    if (parent[i] < 0) {
      reached.push_back(static_cast<int>(i));
    }
  }
  std::vector<bool> is_reached(nodes.size(), false);
  for (std::size_t i = 0; i < reached.size(); i++) {
    is_reached[reached[i]] = true;
    const std::vector<int> &children = nodes[reached[i]].children;
    reached.insert(reached.end(), children.begin(), children.end());
  }
  const auto lost = std::find(is_reached.begin(), is_reached.end(), false);
  if (lost != is_reached.end()) {
    throw Fault(label_of(model, static_cast<int>(lost - is_reached.begin())),
                "is its own ancestor, or a descendant of such a node");
  }
  return parent;
}

std::vector<int> scene_roots(const Model &model)
{
  const std::vector<int> parent = parents(model);
  std::vector<int> roots;
  const Model::Scene *source = model.default_scene();
  if (source == nullptr) {
    for (std::size_t i = 0; i < parent.size(); i++) {
      if (parent[i] < 0) {
        roots.push_back(static_cast<int>(i));
      }
    }
    return roots;
  }
  roots = source->roots;
  std::vector<bool> is_listed(parent.size(), false);
  for (const int root : roots) {
    if (parent[root] >= 0) {
      throw Fault(label_of(model, root),
                  "is a root of the scene, but also a child of " + label_of(model, parent[root]));
    }
    if (is_listed[root]) {
      throw Fault(label_of(model, root), "is twice a root of the scene");
    }
    is_listed[root] = true;
  }
  return roots;
}

}  // namespace gnomon::gltf
