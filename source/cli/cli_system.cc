// SPDX-License-Identifier: MIT
#include "cli_system.hh"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>
#include <array>

namespace gnomon::cli {

bool stderr_is_terminal()
{
  return isatty(STDERR_FILENO) != 0;
}

std::string host_name()
{
  std::array<char, 65> name{};
  static_cast<void>(gethostname(name.data(), name.size() - 1));
  return name.data();
}

std::filesystem::path program_file()
{
  return std::filesystem::read_symlink("/proc/self/exe");
}

std::uint64_t memory_bytes_max()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  // Linux counts KiB.
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

void open_standard_streams()
{
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) < 0) {
      // The file takes the smallest free number, which is this one. Reading a closed input stays an error, as does
      // writing to a closed output.
      static_cast<void>(open("/dev/null", stream == STDOUT_FILENO ? O_RDONLY : O_WRONLY));
    }
  }
}

}  // namespace gnomon::cli
