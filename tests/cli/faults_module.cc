// SPDX-License-Identifier: MIT
// Faults of a system, for LD_PRELOAD. By environment variables:
//   GNOMON_FAULT=CALL:N   The N-th call of CALL (fwrite, fflush, fsync, linkat, rename) that writes a file below the
//                         working folder fails because the disk is full; half of what fwrite gets is written.
//   GNOMON_FAULT_KILLS    The process is killed instead.
//   GNOMON_FAULT_CLOCK    The clock of the day jumps by a day, forwards and backwards, with each reading.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

namespace {

template <typename Function>
Function *original(Function * /*of*/, const char *name)
{
  return reinterpret_cast<Function *>(::dlsym(RTLD_NEXT, name));
}

bool is_below_working_folder(const std::string &path)
{
  char folder[PATH_MAX] = "";
  return path[0] != '/' || (::getcwd(folder, sizeof(folder)) && path.rfind(folder, 0) == 0);
}

bool is_below_working_folder(int descriptor)
{
  char path[PATH_MAX] = "";
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  // The standard streams of a test are files there, too.
  return descriptor > STDERR_FILENO && ::readlink(link.c_str(), path, sizeof(path) - 1) > 0 && path[0] == '/' &&
         is_below_working_folder(path);
}

/** Whether this call of \a name is the one that fails. */
bool is_faulty(const std::string &name)
{
  static std::atomic<int> count = 0;
  const char *fault = std::getenv("GNOMON_FAULT");
  return fault && std::string(fault).rfind(name + ':', 0) == 0 && ++count == std::atoi(fault + name.size() + 1);
}

/** \return -1, where the process goes on */
int fail()
{
  if (std::getenv("GNOMON_FAULT_KILLS")) {
    ::raise(SIGKILL);
  }
  errno = ENOSPC;
  return -1;
}

/** Seconds by which the next reading of the clock of the day is wrong. */
time_t jump()
{
  constexpr time_t day = 24 * 60 * 60;
  static std::atomic<unsigned> count = 0;
  return std::getenv("GNOMON_FAULT_CLOCK") ? (count++ % 2 == 0 ? day : -day) : 0;
}

}  // namespace

extern "C" {

std::size_t fwrite(const void *bytes, std::size_t size, std::size_t count, FILE *file)
{
  static const auto call = original(&fwrite, "fwrite");
  if (is_below_working_folder(::fileno(file)) && is_faulty("fwrite")) {
    const std::size_t half = call(bytes, 1, size * count / 2, file);
    static_cast<void>(original(&fflush, "fflush")(file));
    fail();
    return half / size;
  }
  return call(bytes, size, count, file);
}

int fflush(FILE *file)
{
  static const auto call = original(&fflush, "fflush");
  return file && is_below_working_folder(::fileno(file)) && is_faulty("fflush") ? fail() : call(file);
}

int fsync(int descriptor)
{
  static const auto call = original(&fsync, "fsync");
  return is_below_working_folder(descriptor) && is_faulty("fsync") ? fail() : call(descriptor);
}

int linkat(int folder, const char *path, int new_folder, const char *new_path, int flags) noexcept
{
  static const auto call = original(&linkat, "linkat");
  return is_below_working_folder(new_path) && is_faulty("linkat") ? fail()
                                                                  : call(folder, path, new_folder, new_path, flags);
}

int rename(const char *path, const char *new_path) noexcept
{
  static const auto call = original(&rename, "rename");
  return is_below_working_folder(new_path) && is_faulty("rename") ? fail() : call(path, new_path);
}

int clock_gettime(clockid_t clock, timespec *time) noexcept
{
  static const auto call = original(&clock_gettime, "clock_gettime");
  const int result = call(clock, time);
  time->tv_sec += clock == CLOCK_REALTIME ? jump() : 0;
  return result;
}

int gettimeofday(timeval *time, void *zone) noexcept
{
  static const auto call = original(&gettimeofday, "gettimeofday");
  const int result = call(time, zone);
  time->tv_sec += jump();
  return result;
}

time_t time(time_t *result) noexcept
{
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (result) {
    *result = now.tv_sec;
  }
  return now.tv_sec;
}

}  // extern "C"
