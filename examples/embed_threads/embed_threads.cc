// SPDX-License-Identifier: MIT
// One thread moves a lamp and prepares frames, the device's thread submits them. Without a window.
//   embed_threads SCENE PICTURE.ppm
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cstdio>
#include <exception>
#include <semaphore>
#include <stdexcept>
#include <thread>

using namespace gnomon;

/** A frame that one thread prepares and the other submits. Only one of them uses it at a time. */
struct Frame {
  gpu::Packet packet;
  /** The picture is complete with this frame, or `failure` is set. */
  bool is_last = false;
  /** Why it could not be prepared. */
  std::exception_ptr failure;
};

/** Two frames that take turns: while one is submitted, the next is prepared. */
struct Turns {
  std::array<Frame, 2> frames;
  std::counting_semaphore<2> free{2};
  std::counting_semaphore<2> prepared{0};
};

/** The lamp moves for some frames and returns. Then the picture refines until it is complete. */
static void move_lamp(scene::Scene &scene, int number, const glm::dmat4 &at_first)
{
  constexpr int move_count = 6;
  const scene::Handle<scene::Node> node = scene.placed_lamps().front().node;
  const double way = number < move_count ? 0.1 * (number + 1) : 0.0;
  scene.set_transform(node, glm::translate(glm::dmat4(1), {way, 0, 0}) * at_first);
}

/** Runs on a thread of its own, which uses no context. It alone uses the scene and the renderer. */
static void prepare_frames(const std::stop_token &stop, Turns &turns, scene::Scene &scene,
                           eevee::SceneRenderer &renderer, const draw::Target &target)
{
  const scene::PlacedCamera camera = scene.placed_cameras().front();
  const glm::dmat4 at_first = scene.nodes()[scene.placed_lamps().front().node].parent_from_node;
  bool is_last = false;
  for (int number = 0; !is_last; number++) {
    turns.free.acquire();
    if (stop.stop_requested()) {
      return;
    }
    Frame &frame = turns.frames[std::size_t(number % 2)];
    try {
      move_lamp(scene, number, at_first);
      is_last = renderer.prepare(frame.packet, camera, target);
    }
    catch (...) {
      frame.failure = std::current_exception();
      is_last = true;
    }
    frame.is_last = is_last;
    turns.prepared.release();
  }
}

/** Runs on the device's thread. \return the number of frames */
static int submit_frames(gpu::Device &device, Turns &turns)
{
  for (int number = 0;; number++) {
    turns.prepared.acquire();
    Frame &frame = turns.frames[std::size_t(number % 2)];
    if (frame.failure) {
      std::rethrow_exception(frame.failure);
    }
    device.submit(frame.packet);
    // A host with a window shows the picture here.
    if (frame.is_last) {
      return number + 1;
    }
    turns.free.release();
  }
}

int main(int argc, char **argv)
try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: embed_threads SCENE PICTURE.ppm\n");
    return 2;
  }
  constexpr glm::ivec2 size_px(320, 180);
  scene::Scene scene = gltf::import_gltf(argv[1]);
  if (scene.placed_lamps().empty() || scene.placed_cameras().empty()) {
    throw std::runtime_error("the scene has no visible lamp or no camera");
  }
  const auto device = gpu::create_gl_device();
  const draw::TargetTexture picture(*device, "picture", gpu::Format::RGBA8, size_px);
  eevee::SceneRenderer renderer(*device, scene, size_px, {.sample_count = 8});
  Turns turns;

  std::jthread thread(
      [&](const std::stop_token &stop) { prepare_frames(stop, turns, scene, renderer, picture.target()); });
  int frame_count = 0;
  try {
    frame_count = submit_frames(*device, turns);
  }
  catch (...) {
    // The other thread may wait for a frame that this one has not given back.
    thread.request_stop();
    turns.free.release();
    throw;
  }
  thread.join();
  std::printf("%d frames\n", frame_count);
  write_ppm(argv[2], size_px.x, size_px.y, device->read(picture.texture()));
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "embed_threads: %s\n", error.what());
  return 1;
}
