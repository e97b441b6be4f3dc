// SPDX-License-Identifier: MIT
// A library that edits_test.py loads into Blender: the state of OpenGL before and after a call.
#include "gpu/gpu_gl_state_table.hh"

#include <fmt/ranges.h>

#include <memory>

namespace {

const std::vector<gnomon::test::StateItem> &table()
{
  static const std::vector<gnomon::test::StateItem> items = gnomon::test::state_table();
  return items;
}

std::unique_ptr<gnomon::test::StateSnapshot> before;

}  // namespace

/** Remembers the state of the current context, and forgets errors of Blender. */
extern "C" void gl_state_remember()
{
  while (glGetError() != GL_NO_ERROR) {
  }
  before = std::make_unique<gnomon::test::StateSnapshot>(table());
}

/** \return what differs since gl_state_remember, one item a line. The text stays until the next call. */
extern "C" const char *gl_state_changes()
{
  static std::string text;
  std::vector<std::string> changes = before->differences();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    changes.push_back(fmt::format("glGetError: {:#x}", error));
  }
  text = fmt::format("{}", fmt::join(changes, "\n"));
  return text.c_str();
}
