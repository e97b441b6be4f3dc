// SPDX-License-Identifier: MIT
#include "cli.hh"

#include <fmt/format.h>

#include <algorithm>
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

static Status run(int argc, char **argv)
{
  CLI::App app("gnomon " GNOMON_VERSION ": lights a glTF scene with an EEVEE-style draw-manager engine", "gnomon");
  app.set_version_flag("--version", "gnomon " GNOMON_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  Status status = Status::Done;
  add_render(app, status);
  add_info(app, status);
  add_compare(app, status);
  add_merge(app, status);
  add_report(app, status);
  add_stability(app, status);
  add_shaders(app, status);
  add_bench(app, status);
  add_view(app);
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
    fmt::print(stderr, "gnomon: {}\n", error.what());
    return Status::Usage;
  }
  catch (const std::exception &error) {
    fmt::print(stderr, "gnomon: {}\n", error.what());
    return Status::Failed;
  }
}

}  // namespace gnomon::cli

int main(int argc, char **argv)
{
  gnomon::cli::keep_freed_memory();
  return int(gnomon::cli::run(argc, argv));
}
