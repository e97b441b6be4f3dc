// SPDX-License-Identifier: MIT
#include "gpu/gpu_gl_state_table.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "hosts/host_calls.hh"

#include <map>
#include <type_traits>

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

int query_count = 0;

/** Counts the calls of one of epoxy's pointers to functions that read state. */
template <auto &pointer>
class CountedQuery {
 public:
  CountedQuery()
  {
    original_ = pointer;
    pointer = replacement(pointer);
  }
  ~CountedQuery()
  {
    pointer = original_;
  }
  CountedQuery(const CountedQuery &) = delete;
  CountedQuery &operator=(const CountedQuery &) = delete;

 private:
  using Function = std::remove_reference_t<decltype(pointer)>;
  template <typename Result, typename... Arguments>
  static auto replacement(Result (*)(Arguments...)) -> Result (*)(Arguments...)
  {
    return [](Arguments... arguments) {
      query_count++;
      return original_(arguments...);
    };
  }
  static inline Function original_ = nullptr;
};

/** Reading state costs time in each submission, more in drivers that have a thread of their own. */
TEST_P(HostsState, ASampleReadsLittleState)
{
  const scene::Scene scene = gltf::import_gltf(GNOMON_SOURCE "/examples/scenes/spots.glb");
  const HostPicture picture({48, 36}, GL_RGBA8, 0);
  const HostObjects objects;
  set_unusual_state(objects);
  std::map<std::string, int> counts;
  make_host_calls(scene, picture.framebuffer(), [&](const char *name, const std::function<void()> &call) {
    const CountedQuery<epoxy_glGetIntegerv> integers;
    const CountedQuery<epoxy_glGetIntegeri_v> indexed_integers;
    const CountedQuery<epoxy_glGetInteger64i_v> indexed_long_integers;
    const CountedQuery<epoxy_glGetBooleanv> booleans;
    const CountedQuery<epoxy_glGetBooleani_v> indexed_booleans;
    const CountedQuery<epoxy_glGetFloatv> floats;
    const CountedQuery<epoxy_glIsEnabled> capabilities;
    const CountedQuery<epoxy_glIsEnabledi> indexed_capabilities;
    const CountedQuery<epoxy_glIsBuffer> buffers;
    const CountedQuery<epoxy_glIsTexture> textures;
    const CountedQuery<epoxy_glIsSampler> samplers;
    const CountedQuery<epoxy_glGetTextureParameteriv> texture_parameters;
    query_count = 0;
    call();
    counts[name] = query_count;
  });
  for (const auto &[name, count] : counts) {
    printf("%s: %d queries\n", name.c_str(), count);
  }
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
  EXPECT_GE(StateSnapshot(table).deleted().size(), 100U);
  make_host_calls(scene, picture.framebuffer(), [&](const char *name, const std::function<void()> &call) {
    const StateSnapshot state(table);
    call();
    EXPECT_EQ(state.differences(), std::vector<std::string>()) << name;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << name;
  });
}

}  // namespace
}  // namespace gnomon::test
