// SPDX-License-Identifier: MIT
#include "scene_parallel.hh"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace gnomon::scene {

void parallel_for(std::size_t count, unsigned thread_count, const std::function<void(std::size_t index)> &work)
{
  std::atomic<std::size_t> next = 0;
  std::exception_ptr error;
  std::mutex mutex;
  const auto run = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
      }
    }
    catch (...) {
      next = count;
      const std::scoped_lock lock(mutex);
      error = std::current_exception();
    }
  };
  if (thread_count == 0) {
    thread_count = std::max(std::thread::hardware_concurrency(), 1U);
  }
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < std::min<std::size_t>(thread_count, count); i++) {
      threads.emplace_back(run);
    }
    run();
  }
  if (error) {
    std::rethrow_exception(error);
  }
}

}  // namespace gnomon::scene
