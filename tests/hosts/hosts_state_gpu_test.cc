// SPDX-License-Identifier: MIT
#include "gpu/gpu_gl_state_table.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "hosts/host_calls.hh"

namespace gnomon::test {
namespace {

class HostsState : public HostContextTest {};

INSTANTIATE_TEST_SUITE_P(, HostsState, testing::Values(HostKind::Egl, HostKind::Glx), name_of_host);

/** The toolkits' own contexts, with the state that they have there: the tests example.*.state. */
TEST_P(HostsState, UnusualStateIsKeptByEveryCallOfEnginesAndOverlays)
{
  const scene::Scene scene = gltf::import_gltf(GNOMON_SOURCE "/examples/scenes/spots.glb");
  const HostPicture picture({48, 36}, GL_RGBA8, 0);
  const Pixels before = picture.pixels();
  const HostObjects objects;
  set_unusual_state(objects);
  const std::vector<StateItem> table = state_table();
  int call_count = 0;
  make_host_calls(scene, picture.framebuffer(), [&](const char *name, const std::function<void()> &call) {
    const StateSnapshot state(table);
    call();
    EXPECT_EQ(state.differences(), std::vector<std::string>()) << name;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << name;
    call_count++;
  });
  EXPECT_GE(call_count, 25);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  for (const GLenum name : {GL_PACK_SWAP_BYTES, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS}) {
    glPixelStorei(name, 0);
  }
  EXPECT_NE(picture.pixels(), before) << "nothing was drawn";
}

/** As after an end of a host's own work, whose objects another context of it has deleted. */
TEST_P(HostsState, NamesThatTheHostHasDeletedAreLeftUnbound)
{
  const scene::Scene scene = gltf::import_gltf(GNOMON_SOURCE "/examples/scenes/spots.glb");
  const HostPicture picture({48, 36}, GL_RGBA8, 0);
  HostObjects objects;
  set_unusual_state(objects);
  ASSERT_TRUE(context->in_shared_context([&] {
    for (const HostObjects::Kind &kind : HostObjects::kinds()) {
      if (kind.is_shared) {
        (objects.*kind.destroy)();
      }
    }
  }));
  const std::vector<StateItem> table = state_table();
  const StateSnapshot deletions(table);
  EXPECT_GE(deletions.deleted().size(), 100U);
  make_host_calls(scene, picture.framebuffer(), [&](const char *name, const std::function<void()> &call) {
    const StateSnapshot state(table, &deletions);
    call();
    EXPECT_EQ(state.differences(), std::vector<std::string>()) << name;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << name;
  });
}

}  // namespace
}  // namespace gnomon::test
