// SPDX-License-Identifier: MIT
#include "cli_workers.hh"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

namespace gnomon::cli {

namespace {

using Clock = std::chrono::steady_clock;

/** Precedes the bytes of an answer. */
struct AnswerHead {
  std::uint64_t size;
  bool is_failure;
};

bool send_all(int socket, const void *data, std::size_t size)
{
  for (const auto *bytes = static_cast<const char *>(data); size > 0;) {
    const ssize_t sent = send(socket, bytes, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) {
      continue;
    }
    if (sent <= 0) {
      return false;
    }
    bytes += sent;
    size -= std::size_t(sent);
  }
  return true;
}

/** Answers jobs until the other side closes \a socket. */
[[noreturn]] void work_until_closed(int socket, const WorkLimits &limits,
                                    const std::function<std::string(std::size_t)> &work)
{
  // Libraries print to it.
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    close(nowhere);
  }
#ifndef GNOMON_ADDRESS_SANITIZER
  const rlimit memory{limits.memory_bytes, limits.memory_bytes};
  setrlimit(RLIMIT_DATA, &memory);
#endif
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  std::uint64_t index = 0;
  while (recv(socket, &index, sizeof(index), MSG_WAITALL) == ssize_t(sizeof(index))) {
    std::string bytes;
    AnswerHead head{0, false};
    try {
      bytes = work(std::size_t(index));
    }
    catch (const std::bad_alloc &) {
      bytes = fmt::format("takes more than {} MiB of memory", limits.memory_bytes >> 20U);
      head.is_failure = true;
    }
    catch (const std::exception &error) {
      bytes = error.what();
      head.is_failure = true;
    }
    head.size = bytes.size();
    if (!send_all(socket, &head, sizeof(head)) || !send_all(socket, bytes.data(), bytes.size())) {
      break;
    }
    // A job that ran out of memory leaves its process in an unknown state.
    if (head.is_failure) {
      break;
    }
  }
  _exit(0);
}

/** CPU time of a process; 0 if it has ended. */
double cpu_seconds(pid_t process)
{
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) {
    return 0.0;
  }
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/** A job without CPU time, which waits for something, ends after this many times its limit. */
constexpr double wall_factor = 20.0;

/** A process and the job that it runs. */
class Worker {
 public:
  Worker(const WorkLimits &limits, const std::function<std::string(std::size_t)> &work)
  {
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
      throw std::system_error(errno, std::generic_category(), "a process for checks cannot be started");
    }
    // Flush first, otherwise both processes would write the buffered text.
    std::fflush(nullptr);
    process_ = fork();
    if (process_ < 0) {
      const int reason = errno;
      close(sockets[0]);
      close(sockets[1]);
      throw std::system_error(reason, std::generic_category(), "a process for checks cannot be started");
    }
    if (process_ == 0) {
      close(sockets[0]);
      // It ends with the program, however that ends.
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      work_until_closed(sockets[1], limits, work);
    }
    close(sockets[1]);
    socket_ = sockets[0];
  }
  Worker(Worker &&other) noexcept
      : process_(std::exchange(other.process_, -1)),
        socket_(std::exchange(other.socket_, -1)),
        job_(other.job_),
        seconds_(other.seconds_),
        cpu_start_(other.cpu_start_),
        deadline_(other.deadline_),
        next_look_(other.next_look_),
        answer_(std::move(other.answer_))
  {
  }
  Worker &operator=(Worker &&other) noexcept
  {
    std::swap(process_, other.process_);
    std::swap(socket_, other.socket_);
    std::swap(job_, other.job_);
    std::swap(seconds_, other.seconds_);
    std::swap(cpu_start_, other.cpu_start_);
    std::swap(deadline_, other.deadline_);
    std::swap(next_look_, other.next_look_);
    std::swap(answer_, other.answer_);
    return *this;
  }
  ~Worker()
  {
    stop();
  }

  int socket() const
  {
    return socket_;
  }
  std::optional<std::size_t> job() const
  {
    return job_;
  }
  /** When is_late() may next be true. */
  Clock::time_point next_look() const
  {
    return next_look_;
  }
  /** Whether the job has used its time. */
  bool is_late()
  {
    const Clock::time_point now = Clock::now();
    const double left = seconds_ - (cpu_seconds(process_) - cpu_start_);
    next_look_ = std::min(deadline_, now + duration(left));
    return left <= 0.0 || now >= deadline_;
  }
  void start(std::size_t job, double seconds)
  {
    job_ = job;
    answer_.clear();
    seconds_ = seconds;
    cpu_start_ = cpu_seconds(process_);
    deadline_ = Clock::now() + duration(wall_factor * seconds);
    next_look_ = Clock::now() + duration(seconds);
    const std::uint64_t index = job;
    // A failure shows when the answer is read.
    send_all(socket_, &index, sizeof(index));
  }
  void idle()
  {
    job_.reset();
  }
  /** Read the available bytes. \return the result once it is complete */
  std::optional<WorkResult> read()
  {
    char buffer[65536];
    const ssize_t count = recv(socket_, buffer, sizeof(buffer), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
      return std::nullopt;
    }
    if (count <= 0) {
      return WorkResult{"", reap(), true};
    }
    answer_.append(buffer, std::size_t(count));
    AnswerHead head{};
    if (answer_.size() < sizeof(head)) {
      return std::nullopt;
    }
    std::memcpy(&head, answer_.data(), sizeof(head));
    if (answer_.size() < sizeof(head) + head.size) {
      return std::nullopt;
    }
    std::string bytes = answer_.substr(sizeof(head));
    if (head.is_failure) {
      stop();
      return WorkResult{"", std::move(bytes)};
    }
    return WorkResult{std::move(bytes), ""};
  }
  bool is_ended() const
  {
    return process_ < 0;
  }
  /** Ends the process at once. */
  void stop()
  {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      static_cast<void>(reap());
    }
  }

 private:
  static Clock::duration duration(double seconds)
  {
    constexpr double seconds_max = 1e8;
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, seconds_max)));
  }
  /** Waits for the end of a process that ends. \return how it did */
  std::string reap()
  {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    close(socket_);
    process_ = -1;
    socket_ = -1;
    return WIFSIGNALED(status) ? fmt::format("ends the compiler with signal {}", WTERMSIG(status))
                               : "ends the compiler";
  }

  pid_t process_ = -1;
  int socket_ = -1;
  std::optional<std::size_t> job_;
  double seconds_ = 0.0;
  double cpu_start_ = 0.0;
  Clock::time_point deadline_;
  Clock::time_point next_look_;
  std::string answer_;
};

}  // namespace

std::vector<WorkResult> run_in_workers(std::size_t count, const WorkLimits &limits,
                                       const std::function<std::string(std::size_t)> &work,
                                       const std::function<void(std::size_t)> &progress)
{
  std::vector<WorkResult> results(count);
  const std::size_t worker_count = std::min<std::size_t>(std::max(std::thread::hardware_concurrency(), 1U), count);
  std::vector<Worker> workers;
  workers.reserve(worker_count);
  std::size_t next = 0;
  std::size_t done = 0;
  const auto start_next = [&](Worker &worker) {
    worker.idle();
    if (next < count) {
      worker.start(next++, limits.seconds);
    }
  };
  for (std::size_t i = 0; i < worker_count; i++) {
    workers.emplace_back(limits, work);
    start_next(workers.back());
  }
  const auto finish = [&](Worker &worker, WorkResult result) {
    results[*worker.job()] = std::move(result);
    done++;
    progress(done);
    if (worker.is_ended() && next < count) {
      worker = Worker(limits, work);
    }
    if (!worker.is_ended()) {
      start_next(worker);
    }
    else {
      worker.idle();
    }
  };
  while (done < count) {
    std::vector<pollfd> polled;
    Clock::time_point first = Clock::time_point::max();
    for (const Worker &worker : workers) {
      polled.push_back({worker.job() ? worker.socket() : -1, POLLIN, 0});
      first = worker.job() ? std::min(first, worker.next_look()) : first;
    }
    const auto wait = std::chrono::duration_cast<std::chrono::milliseconds>(first - Clock::now()).count();
    poll(polled.data(), nfds_t(polled.size()), int(std::clamp<long long>(wait + 1, 0, 60'000)));
    for (std::size_t i = 0; i < workers.size(); i++) {
      Worker &worker = workers[i];
      if (!worker.job()) {
        continue;
      }
      if (polled[i].revents != 0) {
        if (std::optional<WorkResult> result = worker.read()) {
          finish(worker, std::move(*result));
        }
      }
      else if (Clock::now() >= worker.next_look() && worker.is_late()) {
        worker.stop();
        finish(worker, {"", fmt::format("takes more than {} s, the limit of --time-limit", limits.seconds)});
      }
    }
  }
  return results;
}

}  // namespace gnomon::cli
