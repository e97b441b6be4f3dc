// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_system.hh"

#include "gltf_import.hh"
#include "gpu_error.hh"
#include "output_roles.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <new>
#include <numeric>
#include <string>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gnomon::cli {

/**
 * Keep freed memory for the next frame. Mesa's software rasteriser allocates the triangles of each pass and frees them
 * after it. By default, the C library returns such memory to the system, which then clears it for each pass anew.
 */
static void keep_freed_memory()
{
#ifdef __GLIBC__
  // The largest values that the C library chooses by itself, after a program has freed large blocks. To set one of them
  // ends that choice, so both are set.
  constexpr int block_bytes_max = 32 << 20;
  constexpr int kept_bytes_max = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, block_bytes_max);
  mallopt(M_TRIM_THRESHOLD, kept_bytes_max);
#endif
}

/** \return \a status, or Status::Failed if the printed text could not be written to stdout */
static Status finish_output(Status status)
{
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) {
    return status;
  }
  // The reason of an earlier failure is not kept.
  print_message("gnomon: standard output: cannot be written{}\n",
                errno == 0 ? "" : fmt::format(": {}", std::strerror(errno)));
  return status == Status::Done ? Status::Failed : status;
}

/** \see Status::Transient */
static bool is_transient(const std::exception &error)
{
  return dynamic_cast<const std::bad_alloc *>(&error) || dynamic_cast<const gpu::TransientError *>(&error) ||
         dynamic_cast<const output::TransientError *>(&error) || dynamic_cast<const gltf::ImportOutOfMemory *>(&error);
}

/** Lets options refuse empty values, which scripts give by variables that are not set. */
static void refuse_empty_values(CLI::App &app)
{
  for (CLI::Option *option : app.get_options()) {
    if (option->get_items_expected_max() > 0) {
      option->check([](const std::string &value) { return value.empty() ? "the value is empty" : ""; });
    }
  }
  for (CLI::App *command : app.get_subcommands({})) {
    refuse_empty_values(*command);
  }
}

/** The least number of characters to insert, remove and replace. */
static std::size_t edit_distance(std::string_view from, std::string_view to)
{
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (const char one : from) {
    std::size_t diagonal = row[0]++;
    for (std::size_t i = 0; i < to.size(); i++) {
      const std::size_t replaced = diagonal + (one != to[i] ? 1 : 0);
      diagonal = row[i + 1];
      row[i + 1] = std::min({row[i] + 1, row[i + 1] + 1, replaced});
    }
  }
  return row.back();
}

/** " (similar: NAMES)" with the names that \a unknown may stand for, or nothing. */
static std::string similar_names(const std::string &unknown, std::vector<std::string> names)
{
  std::erase_if(names, [&](const std::string &name) {
    return !name.starts_with(unknown) && edit_distance(unknown, name) > unknown.size() / 4;
  });
  return names.empty() ? "" : fmt::format(" (similar: {})", fmt::join(names, ", "));
}

static std::vector<std::string> command_names(const CLI::App &app)
{
  std::vector<std::string> names;
  for (const CLI::App *command : app.get_subcommands([](const CLI::App *) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

static std::vector<std::string> option_names(const CLI::App &app)
{
  std::vector<std::string> names;
  for (const CLI::Option *option : app.get_options()) {
    for (const std::string &name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  return names;
}

/** The error of an \a argument that \a command does not have. */
static std::string unknown_argument(const CLI::App &command, const std::string &argument)
{
  const std::string name = argument.substr(0, argument.find('='));
  if (name.starts_with('-')) {
    return fmt::format("there is no option '{}'{}", name, similar_names(name, option_names(command)));
  }
  const std::vector<std::string> commands = command_names(command);
  return commands.empty() ? fmt::format("'{}' is one argument too many", argument)
                          : fmt::format("there is no command '{}'{}", argument, similar_names(argument, commands));
}

/** One line with the command, the reason, and where more is said. */
static std::string failure_message(const CLI::App *app, const CLI::Error &error)
{
  std::string path = app->get_name();
  const CLI::App *command = app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    path += ' ' + command->get_name();
  }
  const std::vector<std::string> unknown = app->remaining(true);
  const std::string reason = unknown.empty() ? error.what() : unknown_argument(*command, unknown.front());
  return fmt::format("{}: {}; '{} --help' lists more\n", path, output::printable_text(reason, "  "), path);
}

static Status run(int argc, char **argv)
{
  CLI::App app("gnomon " GNOMON_VERSION ": lights a glTF scene with an EEVEE-style draw-manager engine", "gnomon");
  app.set_version_flag("--version", "gnomon " GNOMON_VERSION);
  app.failure_message(failure_message);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  Status status = Status::Done;
  add_render(app, status);
  add_info(app, status);
  add_compare(app, status);
  add_merge(app, status);
  add_plan(app, status);
  add_report(app, status);
  add_stability(app, status);
  add_shaders(app, status);
  add_bench(app, status);
  add_view(app);
  refuse_empty_values(app);
  try {
    // Compilers have these names of more than one letter after one dash, and CLI11 has not.
    std::vector<std::string> arguments(argv + 1, argv + argc);
    for (std::string &argument : arguments) {
      if (argument == "-MD" || argument == "-MF" || argument == "-MT") {
        argument.insert(0, 1, '-');
      }
    }
    std::ranges::reverse(arguments);
    app.parse(std::move(arguments));
    return status;
  }
  catch (const CLI::ParseError &error) {
    // Help and version are not errors.
    return app.exit(error) == 0 ? Status::Done : Status::Usage;
  }
  catch (const UsageError &error) {
    print_message("gnomon: {}\n", error.what());
    return Status::Usage;
  }
  catch (const output::Conflict &error) {
    print_message("gnomon: {}\n", error.what());
    return Status::Usage;
  }
  catch (const std::exception &error) {
    // finish_output says that stdout failed.
    if (std::ferror(stdout) == 0) {
      print_message("gnomon: {}\n", error.what());
    }
    return is_transient(error) ? Status::Transient : Status::Failed;
  }
}

}  // namespace gnomon::cli

int main(int argc, char **argv)
{
  gnomon::cli::open_standard_streams();
  // Printing beyond the limit of the size of files fails instead.
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  gnomon::cli::keep_freed_memory();
  return int(gnomon::cli::finish_output(gnomon::cli::run(argc, argv)));
}
