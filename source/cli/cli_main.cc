// SPDX-License-Identifier: MIT
#include "cli.hh"

#include <fmt/format.h>

namespace gnomon::cli {

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
    app.parse(argc, argv);
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
  return int(gnomon::cli::run(argc, argv));
}
