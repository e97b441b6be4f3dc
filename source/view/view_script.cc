// SPDX-License-Identifier: MIT
#include "view_script.hh"

#include "view_commands.hh"

#include "output_file.hh"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace gnomon::view {

namespace {

[[noreturn]] void fail(const std::filesystem::path &path, int line, const std::string &reason)
{
  throw std::runtime_error(fmt::format("{}:{}: {}", path.string(), line, reason));
}

}  // namespace

Script::Script(const std::filesystem::path &path) : path_(path)
{
  output::require_readable(path, path.string() + ": ");
  std::ifstream file(path);
  std::ostringstream text;
  // An empty file is an empty script, but the operator counts no characters as a failure.
  const bool is_empty = file.peek() == std::ifstream::traits_type::eof() && file.eof() && !file.bad();
  if (!is_empty && !(text << file.rdbuf())) {
    throw std::runtime_error(fmt::format("{}: cannot be read", path.string()));
  }
  try {
    lines_ = parse_script(text.str());
  }
  catch (const std::runtime_error &error) {
    throw std::runtime_error(fmt::format("{}:{}", path.string(), error.what()));
  }
  for (const ScriptLine &line : lines_) {
    const Command *command = find_command(line.words[0]);
    if (!command) {
      fail(path, line.number, fmt::format("'{}' is no command", line.words[0]));
    }
    const std::size_t argument_count = line.words.size() - 1;
    if (argument_count < command->argument_min || argument_count > command->argument_max) {
      fail(path, line.number, fmt::format("usage: {} {}", line.words[0], command->usage));
    }
  }
}

void Script::step(App &app)
{
  // Draw one frame to lay out the changes, then frames until all pictures are complete.
  if (frames_ > 0) {
    frames_--;
  }
  else if (waits_) {
    waits_ = !app.is_complete();
  }
  const std::vector<Message> &messages = app.messages();
  while (!awaited_.empty() && seen_ < messages.size()) {
    if (messages[seen_++].text.find(awaited_) != std::string::npos) {
      awaited_.clear();
    }
  }
  const auto wait_for_pictures = [&] {
    // Pictures of a scene that moves are never complete.
    if (app.is_playing()) {
      app.play(false);
    }
    frames_ = 2;
    waits_ = true;
  };
  while (frames_ == 0 && !waits_ && awaited_.empty() && next_ < lines_.size()) {
    const ScriptLine &line = lines_[next_];
    const Command &command = *find_command(line.words[0]);
    if (command.is_after_pictures && !std::exchange(has_waited_, true)) {
      wait_for_pictures();
      return;
    }
    has_waited_ = false;
    next_++;
    try {
      command.run(app, Words(line.words).subspan(1));
      switch (command.need) {
        case Need::Nothing: break;
        case Need::Frame: frames_ = 1; break;
        case Need::Pointer: frames_ = Window::drag_frames; break;
        case Need::Pictures: wait_for_pictures(); break;
        case Need::Message: awaited_ = line.words[1]; break;
      }
    }
    catch (const std::exception &error) {
      fail(path_, line.number, error.what());
    }
  }
}

}  // namespace gnomon::view
