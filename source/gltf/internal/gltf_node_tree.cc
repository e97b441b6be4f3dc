// SPDX-License-Identifier: MIT
#include "internal/gltf_node_tree.hh"

#include <algorithm>
#include <string>
#include <utility>

namespace gnomon::gltf {

static std::string label_of(const Model &model, int node)
{
  return label("node", model.nodes[node].name, static_cast<std::size_t>(node));
}

namespace {

struct Trees {
  /** The parent of each node; -1: it is a root. */
  std::vector<int> parent;
  /** All nodes, each after its parent. */
  std::vector<int> order;
};

/** \throws Fault if the nodes of the file are not trees */
Trees trees_of(const Model &model)
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
  std::vector<int> order;
  for (std::size_t i = 0; i < nodes.size(); i++) {
    if (parent[i] < 0) {
      order.push_back(static_cast<int>(i));
    }
  }
  std::vector<bool> is_reached(nodes.size(), false);
  for (std::size_t i = 0; i < order.size(); i++) {
    is_reached[order[i]] = true;
    // GCC 14 warns of order.insert() here.
    for (const int child : nodes[order[i]].children) {
      order.push_back(child);
    }
  }
  const auto lost = std::find(is_reached.begin(), is_reached.end(), false);
  if (lost != is_reached.end()) {
    throw Fault(label_of(model, static_cast<int>(lost - is_reached.begin())),
                "is its own ancestor, or a descendant of such a node");
  }
  return {std::move(parent), std::move(order)};
}

}  // namespace

std::vector<int> scene_roots(const Model &model, Warnings &warnings)
{
  const auto [parent, order] = trees_of(model);
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
  std::vector<bool> is_listed(parent.size(), false);
  for (const int node : source->roots) {
    is_listed[node] = true;
  }
  std::vector<bool> is_below_listed(parent.size(), false);
  for (const int node : order) {
    const int up = parent[node];
    is_below_listed[node] = up >= 0 && (is_listed[up] || is_below_listed[up]);
  }
  // Exporters of Unity list a child without its parent.
  std::vector<bool> is_added(parent.size(), false);
  for (const int node : source->roots) {
    const bool is_below = is_below_listed[node];
    if (is_added[node]) {
      warnings.add(label_of(model, node), "is twice a root of the scene: it is drawn once");
    }
    else if (parent[node] >= 0) {
      warnings.add(label_of(model, node), "is a root of the scene, but also a child of " +
                                              label_of(model, parent[node]) + ": it is drawn " +
                                              (is_below ? "below that node alone" : "without that node"));
    }
    if (!is_below && !is_added[node]) {
      roots.push_back(node);
    }
    is_added[node] = true;
  }
  return roots;
}

}  // namespace gnomon::gltf
