// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_packet.hh"

#include <array>
#include <semaphore>
#include <thread>

namespace gnomon::test {

/**
 * Call \a prepare with each frame's number and a packet, and \a submit with the packets in order: on this thread, or,
 * where \a has_two_threads, prepare on another one, up to two frames ahead. Neither may throw. Two packets take turns.
 */
template <typename Prepare, typename Submit>
void run_frames(int frame_count, bool has_two_threads, Prepare &&prepare, Submit &&submit)
{
  std::array<gpu::Packet, 2> packets;
  if (!has_two_threads) {
    for (int frame = 0; frame < frame_count; frame++) {
      prepare(frame, packets[std::size_t(frame % 2)]);
      submit(packets[std::size_t(frame % 2)]);
    }
    return;
  }
  std::counting_semaphore<2> free(2);
  std::counting_semaphore<2> prepared(0);
  std::thread thread([&] {
    for (int frame = 0; frame < frame_count; frame++) {
      free.acquire();
      prepare(frame, packets[std::size_t(frame % 2)]);
      prepared.release();
    }
  });
  for (int frame = 0; frame < frame_count; frame++) {
    prepared.acquire();
    submit(packets[std::size_t(frame % 2)]);
    free.release();
  }
  thread.join();
}

}  // namespace gnomon::test
