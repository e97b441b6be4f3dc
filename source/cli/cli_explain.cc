// SPDX-License-Identifier: MIT
#include "cli_explain.hh"

#include "eevee_frame_text.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <vector>

namespace gnomon::cli {

namespace {

/** Columns of one node. */
struct Row {
  std::string what;
  std::string count;
  std::string bytes;
  std::string seconds;
  std::string why;
};

/** \a lines: prefix of the lines of the node's children. */
void add_rows(const eevee::FrameNode &node, const std::string &head, const std::string &lines, std::vector<Row> &rows)
{
  Row &row = rows.emplace_back();
  row.what = fmt::format("{}{} {}", head, node.is_made ? '+' : '-', node.what);
  row.count = node.count ? fmt::format("{}", *node.count) : "";
  row.bytes = node.bytes ? eevee::bytes_text(*node.bytes) : "";
  row.seconds = node.seconds && node.is_made ? eevee::seconds_text(*node.seconds) : "";
  row.why = node.why;
  if (node.upload_bytes) {
    row.why += fmt::format(" ({} uploaded)", eevee::bytes_text(*node.upload_bytes));
  }
  for (const eevee::FrameNode &child : node.children) {
    const bool is_last = &child == &node.children.back();
    add_rows(child, lines + (is_last ? "`-" : "|-"), lines + (is_last ? "  " : "| "), rows);
  }
}

}  // namespace

std::string tree_text(const eevee::FrameNode &root)
{
  std::vector<Row> rows;
  add_rows(root, "", "", rows);
  const auto width = [&](std::string Row::*column) {
    std::size_t most = 0;
    for (const Row &row : rows) {
      most = std::max(most, (row.*column).size());
    }
    return most;
  };
  std::string text;
  for (const Row &row : rows) {
    text += fmt::format("{:<{}} {:>{}} {:>{}} {:>{}}  {}\n", row.what, width(&Row::what), row.count, width(&Row::count),
                        row.bytes, width(&Row::bytes), row.seconds, width(&Row::seconds), row.why);
  }
  return text;
}

nlohmann::json tree_json(const eevee::FrameNode &node)
{
  nlohmann::json json = {{"what", node.what}, {"is_made", node.is_made}, {"why", node.why}};
  if (node.bytes) {
    json["bytes"] = *node.bytes;
  }
  if (node.upload_bytes) {
    json["upload_bytes"] = *node.upload_bytes;
  }
  if (node.seconds) {
    json["seconds"] = *node.seconds;
  }
  if (node.count) {
    json["count"] = *node.count;
  }
  for (const eevee::FrameNode &child : node.children) {
    json["children"].push_back(tree_json(child));
  }
  return json;
}

}  // namespace gnomon::cli
