// SPDX-License-Identifier: MIT
// Edits of a scene, and what they change on the device and in the lists that engines read.
#include "render_scene.hh"

#include "measure_scene.hh"
#include "render_materials.hh"

#include "gpu/gpu_testing.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace gnomon::render_scene {
namespace {

using measure::add_lamp;
using measure::add_material;
using measure::add_object;
using measure::add_square_mesh;
using measure::add_texture;

glm::dmat4 at(const glm::dvec3 &position)
{
  return glm::translate(glm::dmat4(1.0), position);
}

class RenderSceneTest : public testing::Test {
 protected:
  /** The only object of \a node; object_identity: it has none. */
  [[nodiscard]] draw::ObjectIndex object_of(scene::Handle<scene::Node> node)
  {
    draw::ObjectIndex found = draw::object_identity;
    draw::ObjectBuffer &objects = render_scene.objects();
    for (draw::ObjectIndex index = draw::object_identity + 1; index < objects.index_end(); index++) {
      if (objects.is_live(index) && render_scene.object(index).node == node) {
        EXPECT_EQ(found, draw::object_identity) << "a second object of the node";
        found = index;
      }
    }
    return found;
  }
  /** Where an object is, relative to the origin. */
  [[nodiscard]] glm::vec3 place_of(scene::Handle<scene::Node> node)
  {
    return glm::vec3(render_scene.objects().world_from_object(object_of(node))[3]);
  }
  /** Objects, without the identity. */
  [[nodiscard]] std::size_t object_count()
  {
    return render_scene.objects().size() - 1;
  }
  /** Objects that \a change and an update change, by index. */
  template <typename Change>
  std::vector<draw::ObjectIndex> changed_by(Change &&change)
  {
    draw::ObjectBuffer &objects = render_scene.objects();
    const std::uint64_t before = objects.revision();
    change();
    render_scene.update();
    std::vector<draw::ObjectIndex> changed;
    for (draw::ObjectIndex index = draw::object_identity + 1; index < objects.index_end(); index++) {
      if (objects.is_live(index) && objects.revision(index) > before) {
        changed.push_back(index);
      }
    }
    return changed;
  }
  /** Bytes that \a change, an update and an upload write to the device. */
  template <typename Change>
  std::uint64_t uploaded_by(Change &&change)
  {
    const std::uint64_t before = device->counters().upload_bytes;
    change();
    render_scene.update();
    render_scene.upload(MaterialClass::Plain);
    return device->counters().upload_bytes - before;
  }
  std::uint64_t uploads_of_batch(scene::Handle<scene::Mesh> handle, MeshStreams streams = MeshStreams::Shape)
  {
    const std::uint64_t before = device->counters().upload_bytes;
    static_cast<void>(render_scene.batch(handle, streams));
    return device->counters().upload_bytes - before;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Material> material = add_material(scene, glm::vec3(0.5F));
  scene::Handle<scene::Mesh> mesh = add_square_mesh(scene, material);
  RenderScene render_scene{*device, scene};
};

TEST_F(RenderSceneTest, UpdateNeedsNoDevice)
{
  add_object(scene, mesh, at({1, 2, 3}));
  add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  render_scene.update();
  EXPECT_EQ(object_count(), 1U);
  EXPECT_EQ(render_scene.lamps().size(), 1U);
  EXPECT_EQ(device->counters().upload_bytes, 0U);
  EXPECT_TRUE(device->live_resources().empty());
}

TEST_F(RenderSceneTest, UpdateOfAStillSceneChangesNothing)
{
  add_object(scene, mesh, at({1, 2, 3}));
  add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  EXPECT_GT(uploaded_by([] {}), 0U);
  const std::uint64_t lamps = render_scene.lamps_revision();
  const std::uint64_t passes = render_scene.passes_revision();
  const std::uint64_t materials = render_scene.materials_revision();
  const std::uint64_t objects = render_scene.objects().revision();
  EXPECT_EQ(uploaded_by([] {}), 0U);
  EXPECT_EQ(uploaded_by([&] {
              scene.edit(material, [](scene::Material &value) { value.name = "renamed"; });
              scene.edit(mesh, [](scene::Mesh &value) { value.name = "renamed"; });
              scene.edit(scene.lamps().first(), [](scene::Lamp &value) { value.name = "lamp0"; });
              scene.edit(scene.nodes().first(), [](scene::Node &value) { value.name = "renamed"; });
            }),
            0U);
  EXPECT_EQ(render_scene.lamps_revision(), lamps);
  EXPECT_EQ(render_scene.passes_revision(), passes);
  EXPECT_EQ(render_scene.materials_revision(), materials);
  EXPECT_EQ(render_scene.objects().revision(), objects);
}

TEST_F(RenderSceneTest, AMeshIsUploadedOnceAndAgainWhereItsShapeChanged)
{
  const std::size_t bytes = 4 * 2 * sizeof(glm::vec3) + 6 * sizeof(std::uint32_t);
  EXPECT_EQ(uploads_of_batch(mesh), bytes);
  EXPECT_EQ(uploads_of_batch(mesh), 0U);
  scene.edit(mesh, [](scene::Mesh &value) { value.name = "renamed"; });
  scene.edit(mesh, [&](scene::Mesh &value) { value.material = add_material(scene, glm::vec3(1.0F)); });
  EXPECT_EQ(uploads_of_batch(mesh), 0U) << "the same shape";
  scene.edit(mesh, [](scene::Mesh &value) { value.indices.resize(3); });
  EXPECT_EQ(uploads_of_batch(mesh), bytes - 3 * sizeof(std::uint32_t));
  EXPECT_EQ(uploads_of_batch(mesh), 0U);
}

/** Vertices on a line, with uvs. */
scene::Mesh long_mesh(std::size_t count)
{
  scene::Mesh mesh;
  for (std::size_t i = 0; i < count; i++) {
    mesh.positions.emplace_back(0.01F * float(i), 0, 0);
  }
  mesh.normals.assign(count, {0, 0, 1});
  mesh.uvs.assign(count, glm::vec2(0));
  mesh.indices = {0, 1, 2};
  return mesh;
}

void move_vertex(scene::Scene &scene, scene::Handle<scene::Mesh> mesh, std::uint32_t vertex, const glm::vec3 &position)
{
  scene.set_vertices(mesh, {.vertices = std::span(&vertex, 1), .positions = std::span(&position, 1)});
}

TEST_F(RenderSceneTest, OtherValuesOfVerticesAreWrittenIntoTheBatchThatPassesDraw)
{
  constexpr std::size_t count = 1000;
  const auto edited = scene.add(long_mesh(count));
  const auto node = add_object(scene, edited, glm::dmat4(1.0));
  render_scene.update();
  const gpu::ResourceId id = render_scene.batch(edited, MeshStreams::Uvs).id();
  EXPECT_GT(uploaded_by([] {}), 0U);
  const std::uint64_t passes = render_scene.passes_revision();
  const std::uint64_t content = render_scene.content_revision();
  const auto move = [&](std::uint32_t vertex, const glm::vec3 &position) {
    move_vertex(scene, edited, vertex, position);
  };
  constexpr std::size_t block_bytes = 64 * (2 * sizeof(glm::vec3) + sizeof(glm::vec2));
  EXPECT_EQ(uploaded_by([&] {
              move(70, {0.7F, 0.001F, 0});
            }),
            block_bytes + sizeof(shared::ObjectData))
      << "a larger box is another culling volume";
  EXPECT_EQ(uploaded_by([&] {
              move(71, {0.71F, 0.0005F, 0});
              move(500, {5, 0.0005F, 0});
            }),
            2 * block_bytes);
  EXPECT_EQ(uploaded_by([] {}), 0U);
  EXPECT_EQ(uploaded_by([&] { move(71, {0.71F, 0.0005F, 0}); }), 0U) << "the same value";
  EXPECT_EQ(uploaded_by([&] { scene.edit(edited, [](scene::Mesh &all) {
                                all.normals[3] = {0, 1, 0};
                              }); }),
            count * (2 * sizeof(glm::vec3) + sizeof(glm::vec2)));
  EXPECT_EQ(render_scene.batch(edited, MeshStreams::Shape).id(), id);
  EXPECT_EQ(render_scene.passes_revision(), passes);
  EXPECT_EQ(render_scene.content_revision(), content + 3);
  EXPECT_EQ(render_scene.object(object_of(node)).bounds, scene.meshes()[edited].bounds);
  EXPECT_EQ(uploads_of_batch(edited, MeshStreams::All), count * (2 * 12 + 4 * 8) + 12) << "a batch with more streams";
  EXPECT_EQ(uploaded_by([&] { move(71, {0.71F, 0.0004F, 0}); }), block_bytes) << "streams that the mesh has not stay";
}

TEST_F(RenderSceneTest, VerticesOfALostPacketAreWrittenAgain)
{
  const auto still = add_square_mesh(scene, material);
  const auto brushed = scene.add(long_mesh(1000));
  for (const auto handle : {mesh, still, brushed}) {
    static_cast<void>(render_scene.batch(handle, MeshStreams::Shape));
  }
  uploaded_by([&] { move_vertex(scene, brushed, 500, {5, 1, 0}); });
  {
    gpu::Packet lost;
    const gpu::Recording recording(*device, lost);
    scene.edit(mesh, [](scene::Mesh &value) { value.positions[0].z = 1.0F; });
    move_vertex(scene, brushed, 70, {0.7F, 1, 0});
    render_scene.update();
    render_scene.upload(MaterialClass::Plain);
  }
  const auto batch_bytes = [&](scene::Handle<scene::Mesh> handle) {
    return device->live(*render_scene.meshes().find(handle)).upload_bytes;
  };
  const std::array before = {batch_bytes(mesh), batch_bytes(still), batch_bytes(brushed)};
  uploaded_by([] {});
  constexpr std::size_t vertex_bytes = 2 * sizeof(glm::vec3);
  EXPECT_EQ(batch_bytes(mesh), before[0] + 4 * vertex_bytes);
  EXPECT_EQ(batch_bytes(still), before[1]) << "never written";
  EXPECT_EQ(batch_bytes(brushed), before[2] + std::size_t(2 * 64) * vertex_bytes) << "changes since the batch was made";
  const std::uint64_t after = batch_bytes(brushed);
  uploaded_by([] {});
  EXPECT_EQ(batch_bytes(brushed), after);
}

TEST_F(RenderSceneTest, AMeshGetsTextureCoordinatesWhereTheyAreReadAndKeepsThem)
{
  const auto box = measure::add_box_mesh(scene, material);
  const std::size_t bare = 24 * 2 * sizeof(glm::vec3) + 36 * sizeof(std::uint32_t);
  EXPECT_EQ(uploads_of_batch(box), bare);
  EXPECT_EQ(uploads_of_batch(box, MeshStreams::Uvs), bare + 24 * sizeof(glm::vec2));
  EXPECT_EQ(uploads_of_batch(box), 0U) << "another viewport may read them";
  scene.edit(box, [](scene::Mesh &value) { value.indices.resize(33); });
  EXPECT_EQ(uploads_of_batch(box), bare - 3 * sizeof(std::uint32_t)) << "no viewport asked for those of the new shape";
}

TEST_F(RenderSceneTest, LevelsOfAMaskAreThoseOfCutoffsThatMaterialsHave)
{
  const auto texture = add_texture(scene, 2, std::vector<std::uint8_t>(16, 100));
  for (const float cutoff : {0.25F, 0.5F, 0.75F}) {
    scene.edit(material, [&](scene::Material &value) {
      value.alpha_mode = scene::AlphaMode::Mask;
      value.alpha_cutoff = cutoff;
    });
    render_scene.update();
    static_cast<void>(render_scene.texture(texture, scene::ImageUse::Mask, cutoff));
    EXPECT_EQ(render_scene.images().count(), 1U) << cutoff;
  }
}

TEST_F(RenderSceneTest, RemovedMeshesAndImagesAreFreed)
{
  const auto texture = add_texture(scene, 1, {1, 2, 3, 255});
  const auto image = scene.textures()[texture].image;
  static_cast<void>(render_scene.batch(mesh, MeshStreams::Shape));
  static_cast<void>(render_scene.texture(texture, scene::ImageUse::Color));
  ASSERT_TRUE(render_scene.meshes().find(mesh));
  ASSERT_TRUE(render_scene.images().find(image));
  EXPECT_EQ(render_scene.images().count(), 1U);
  scene.remove(mesh);
  scene.remove(image);
  render_scene.update();
  EXPECT_FALSE(render_scene.meshes().find(mesh));
  EXPECT_FALSE(render_scene.images().find(image));
  EXPECT_EQ(render_scene.images().count(), 0U);
  for (const std::string &resource : device->live_resources()) {
    EXPECT_TRUE(resource.starts_with("sampler")) << resource;
  }
}

TEST_F(RenderSceneTest, AMeshInThePlaceOfARemovedOneIsItsOwn)
{
  static_cast<void>(render_scene.batch(mesh, MeshStreams::Shape));
  scene.remove(mesh);
  const auto other = add_square_mesh(scene, material);
  ASSERT_EQ(other.index, mesh.index);
  EXPECT_FALSE(render_scene.meshes().find(other));
  EXPECT_GT(uploads_of_batch(other), 0U);
  EXPECT_TRUE(render_scene.meshes().find(other));
  EXPECT_FALSE(render_scene.meshes().find(mesh));
}

TEST_F(RenderSceneTest, AnImageIsUploadedOnceAndAgainWhereItsContentChanged)
{
  const auto first = add_texture(scene, 2, {1, 2, 3, 255, 4, 5, 6, 255});
  scene::Texture repeated = scene.textures()[first];
  repeated.wrap_u = scene::TextureWrap::ClampToEdge;
  const auto second = scene.add(repeated);
  const auto uploaded = [&](scene::Handle<scene::Texture> texture) {
    const std::uint64_t before = device->counters().upload_bytes;
    static_cast<void>(render_scene.texture(texture, scene::ImageUse::Color));
    return device->counters().upload_bytes - before;
  };
  EXPECT_EQ(uploaded(first), 8U);
  EXPECT_EQ(uploaded(first), 0U);
  EXPECT_EQ(uploaded(second), 0U) << "the same image with another sampler";
  EXPECT_EQ(device->counters().textures_made, 1U);
  const auto image = scene.textures()[first].image;
  scene.edit(image, [](scene::Image &value) { value.name = "renamed"; });
  scene.edit(first, [](scene::Texture &value) { value.wrap_v = scene::TextureWrap::ClampToEdge; });
  EXPECT_EQ(uploaded(first), 0U);
  scene.edit(image, [](scene::Image &value) { value.texels[0] = 9; });
  EXPECT_EQ(uploaded(second), 8U);
  EXPECT_EQ(uploaded(first), 0U);
  EXPECT_EQ(std::ranges::count_if(device->live_resources(),
                                  [](const std::string &name) { return name.starts_with("texture"); }),
            1);
}

TEST_F(RenderSceneTest, LinearTexturesAreAnisotropicWhereTheDeviceFiltersThemItself)
{
  const auto texture = add_texture(scene, 1, std::vector<std::uint8_t>(4, 255));
  const auto anisotropy = [&](const gpu::Limits &limits) {
    const auto on_device = gpu::create_null_device(limits);
    RenderScene on_limits(*on_device, scene);
    const gpu::ResourceId sampler = on_limits.texture(texture, scene::ImageUse::Color).sampler.id();
    return std::get<gpu::SamplerDesc>(on_device->find(gpu::ResourceKind::Sampler, sampler)->desc).anisotropy;
  };
  EXPECT_EQ(anisotropy({}), 1) << "nearest";
  scene.edit(texture, [](scene::Texture &value) {
    value.magnified = value.minified = scene::TextureFilter::Linear;
    value.mip = scene::MipFilter::Linear;
  });
  EXPECT_EQ(anisotropy({}), 8);
  EXPECT_EQ(anisotropy({.anisotropy_max = 2}), 2);
  EXPECT_EQ(anisotropy({.is_software = true}), 1);
}

TEST_F(RenderSceneTest, AFailedUploadLeavesWhatWasThere)
{
  // The null device accepts every batch, but not every image.
  gpu::Limits limits;
  limits.texture_size_max = 4;
  const auto small = gpu::create_null_device(limits);
  RenderScene on_small(*small, scene);
  const auto texture = add_texture(scene, 2, std::vector<std::uint8_t>(8, 255));
  const auto image = scene.textures()[texture].image;
  static_cast<void>(on_small.texture(texture, scene::ImageUse::Color));
  const gpu::ResourceId before = on_small.images().find(image)->id();
  const scene::Image large{"large", 5, 1, std::vector<std::uint8_t>(20, 255)};
  scene.replace(image, large);
  on_small.update();
  test::expect_contains(test::error_of([&] { static_cast<void>(on_small.texture(texture, scene::ImageUse::Color)); }),
                        "large");
  ASSERT_TRUE(on_small.images().find(image));
  EXPECT_EQ(on_small.images().find(image)->id(), before);
  EXPECT_NE(test::error_of([&] { static_cast<void>(on_small.texture(texture, scene::ImageUse::Color)); }), "")
      << "it is tried again";
  scene.replace(image, scene::Image{"small", 1, 1, std::vector<std::uint8_t>(4, 255)});
  EXPECT_EQ(on_small.texture(texture, scene::ImageUse::Color).image.desc().width, 1);
}

/** A mesh in buffers of the host, of the size of a square. */
scene::Mesh host_mesh(scene::Handle<scene::Material> material)
{
  return {.name = "terrain", .material = material, .host_shape = scene::HostShape{.bounds = {{-1, -1, 0}, {1, 1, 0}}}};
}

constexpr gpu::HostBatch host_batch{
    .positions = {1, 0, 12}, .normals = {2, 0, 12}, .vertex_count = 4, .index_buffer = 3, .index_count = 6};

TEST_F(RenderSceneTest, AHostsMeshIsDrawnFromItsBuffersWithoutAnUpload)
{
  const scene::Handle<scene::Mesh> terrain = scene.add(host_mesh(material));
  add_object(scene, terrain, at({1, 2, 3}));
  render_scene.update();
  EXPECT_EQ(object_count(), 0U) << "without buffers";
  const std::uint64_t passes = render_scene.passes_revision();
  render_scene.set_host_batch(terrain, host_batch);
  EXPECT_FALSE(render_scene.is_up_to_date());
  EXPECT_FALSE(render_scene.meshes().has_shape(terrain, scene.meshes()[terrain])) << "before the update";
  render_scene.update();
  EXPECT_TRUE(render_scene.is_up_to_date());
  EXPECT_EQ(object_count(), 1U);
  EXPECT_GT(render_scene.passes_revision(), passes);
  EXPECT_EQ(render_scene.bounds(), (scene::Bounds{{0, 1, 3}, {2, 3, 3}}));
  EXPECT_EQ(uploads_of_batch(terrain, MeshStreams::All), 0U);
  const gpu::ResourceId first = render_scene.meshes().find(terrain)->id();
  EXPECT_EQ(render_scene.batch(terrain, MeshStreams::Shape).id(), first);
  render_scene.set_host_batch(terrain, std::nullopt);
  EXPECT_EQ(render_scene.batch(terrain, MeshStreams::Shape).id(), first) << "before the update";
  render_scene.update();
  EXPECT_EQ(object_count(), 0U);
  EXPECT_EQ(render_scene.meshes().find(terrain), nullptr);
  EXPECT_TRUE(device->live_resources().empty());
}

TEST_F(RenderSceneTest, OtherContentOfTheHostBuildsNoPassAgain)
{
  const scene::Handle<scene::Mesh> terrain = scene.add(host_mesh(material));
  add_object(scene, terrain, at({}));
  render_scene.set_host_batch(terrain, host_batch);
  render_scene.update();
  const gpu::ResourceId first = render_scene.batch(terrain, MeshStreams::Shape).id();
  const std::uint64_t passes = render_scene.passes_revision();
  std::uint64_t content = render_scene.content_revision();
  EXPECT_TRUE(changed_by([&] { render_scene.set_host_batch(terrain, host_batch); }).empty());
  EXPECT_EQ(render_scene.batch(terrain, MeshStreams::Shape).id(), first);
  EXPECT_EQ(render_scene.passes_revision(), passes);
  EXPECT_GT(render_scene.content_revision(), content);
  content = render_scene.content_revision();
  gpu::HostBatch shorter = host_batch;
  shorter.index_count = 3;
  render_scene.set_host_batch(terrain, shorter);
  render_scene.update();
  EXPECT_NE(render_scene.batch(terrain, MeshStreams::Shape).id(), first);
  EXPECT_GT(render_scene.passes_revision(), passes);
  EXPECT_GT(render_scene.content_revision(), content);
  content = render_scene.content_revision();
  render_scene.set_host_batch(mesh, std::nullopt);
  render_scene.update();
  EXPECT_EQ(render_scene.content_revision(), content) << "it had none";
}

TEST_F(RenderSceneTest, AHostsMeshInThePlaceOfARemovedOneHasNoBuffers)
{
  const scene::Handle<scene::Mesh> terrain = scene.add(host_mesh(material));
  const scene::Handle<scene::Node> node = add_object(scene, terrain, at({}));
  render_scene.set_host_batch(terrain, host_batch);
  render_scene.update();
  EXPECT_EQ(object_count(), 1U);
  scene.remove(node);
  scene.remove(terrain);
  add_object(scene, scene.add(host_mesh(material)), at({}));
  render_scene.update();
  EXPECT_EQ(object_count(), 0U);
  EXPECT_THROW(render_scene.set_host_batch(terrain, host_batch), scene::StaleHandle);
}

TEST_F(RenderSceneTest, AMeshThatWasUploadedMeanwhileHasNoBuffersOfTheHost)
{
  const scene::Handle<scene::Mesh> terrain = scene.add(host_mesh(material));
  add_object(scene, terrain, at({}));
  render_scene.set_host_batch(terrain, host_batch);
  render_scene.update();
  const scene::Mesh before = scene.meshes()[terrain];
  scene.replace(terrain, scene.meshes()[mesh]);
  render_scene.update();
  EXPECT_EQ(object_count(), 1U);
  EXPECT_GT(uploads_of_batch(terrain), 0U);
  render_scene.set_host_batch(terrain, std::nullopt);
  scene.replace(terrain, before);
  render_scene.update();
  EXPECT_EQ(object_count(), 0U) << "the host may have deleted its buffers";
}

TEST_F(RenderSceneTest, BuffersThatDoNotFitTheMeshAreRefusedByName)
{
  const auto message_of = [](const auto &action) { return test::error_of(action); };
  test::expect_contains(message_of([&] { render_scene.set_host_batch(mesh, host_batch); }),
                        "mesh 'square': it has no shape in buffers of a host");
  scene::Mesh textured = host_mesh(material);
  textured.host_shape->has_uvs = true;
  const scene::Handle<scene::Mesh> terrain = scene.add(textured);
  const auto batch_error = [&](const gpu::HostBatch &batch) {
    render_scene.set_host_batch(terrain, batch);
    render_scene.update();
    return message_of([&] { static_cast<void>(render_scene.batch(terrain, MeshStreams::All)); });
  };
  test::expect_contains(batch_error(host_batch), "mesh 'terrain': its shape has uvs, and the host's batch has none");
  gpu::HostBatch with_uvs = host_batch;
  with_uvs.uvs = {3, 0, 8};
  EXPECT_EQ(batch_error(with_uvs), "");
  with_uvs.index_count = 4;
  test::expect_contains(batch_error(with_uvs),
                        "mesh 'terrain': the 4 indices of the host's batch are no multiple of 3");
  with_uvs.index_count = 0;
  EXPECT_EQ(batch_error(with_uvs), "");
  with_uvs.normals = {};
  test::expect_contains(batch_error(with_uvs), "its shape has normals");
}

TEST_F(RenderSceneTest, AHostsTextureIsLookedUpWithoutAnUploadUntilItIsTakenBack)
{
  const scene::Handle<scene::Texture> texture = add_texture(scene, 1, {1, 2, 3, 255});
  const scene::Handle<scene::Image> image = scene.textures()[texture].image;
  scene.edit(texture, [](scene::Texture &value) { value.mip = scene::MipFilter::Linear; });
  render_scene.update();
  const std::uint64_t passes = render_scene.passes_revision();
  const std::uint64_t uploads = device->counters().upload_bytes;
  const std::uint64_t made = device->counters().textures_made;
  render_scene.set_host_texture(image, gpu::HostTexture{7, {64, 32}});
  render_scene.update();
  EXPECT_GT(render_scene.passes_revision(), passes);
  const Images::Lookup of_host = render_scene.texture(texture, scene::ImageUse::Color);
  EXPECT_EQ(of_host.image.desc().host.name, 7U);
  EXPECT_EQ(of_host.image.desc().width, 64);
  const auto mip_of = [&](const gpu::Sampler &sampler) {
    return std::get<gpu::SamplerDesc>(device->find(gpu::ResourceKind::Sampler, sampler.id())->desc).mip;
  };
  EXPECT_EQ(mip_of(of_host.sampler), gpu::MipFilter::None) << "it has one level";
  render_scene.set_host_texture(image, gpu::HostTexture{7, {64, 32}, true});
  render_scene.update();
  EXPECT_EQ(mip_of(render_scene.texture(texture, scene::ImageUse::Color).sampler), gpu::MipFilter::Linear);
  EXPECT_EQ(device->counters().upload_bytes, uploads);
  EXPECT_EQ(device->counters().textures_made, made);
  EXPECT_EQ(device->memory_bytes(), 0U);
  render_scene.set_host_texture(image, std::nullopt);
  render_scene.update();
  EXPECT_EQ(render_scene.images().find(image), nullptr);
  EXPECT_EQ(render_scene.texture(texture, scene::ImageUse::Color).image.desc().width, 1);
  EXPECT_GT(device->counters().upload_bytes, uploads);
  render_scene.set_host_texture(image, gpu::HostTexture{0, {64, 32}});
  render_scene.update();
  test::expect_contains(
      test::error_of([&] { static_cast<void>(render_scene.texture(texture, scene::ImageUse::Color)); }),
      "the name of the host's texture is 0");
}

TEST_F(RenderSceneTest, HiddenNodesHaveNoObjectAndNoLamp)
{
  const auto parent = scene.add(scene::Node());
  scene::Node child;
  child.meshes = {mesh};
  child.lamp = scene.add(scene::Lamp());
  const auto node = scene.add(child, parent);
  const auto other = add_object(scene, mesh, at({5, 0, 0}));
  render_scene.update();
  EXPECT_EQ(object_count(), 2U);
  EXPECT_EQ(render_scene.lamps().size(), 1U);
  const auto set_visible = [&](bool is_visible) {
    scene.edit(parent, [&](scene::Node &value) { value.is_visible = is_visible; });
    render_scene.update();
  };
  set_visible(false);
  EXPECT_EQ(object_of(node), draw::object_identity);
  EXPECT_NE(object_of(other), draw::object_identity);
  EXPECT_TRUE(render_scene.lamps().empty());
  EXPECT_NEAR(render_scene.bounds().min.x, 4.0F, 1e-6F) << "the bounds are those of what is there";
  set_visible(true);
  EXPECT_EQ(object_count(), 2U);
  EXPECT_NEAR(render_scene.bounds().min.x, -1.0F, 1e-6F);
  EXPECT_EQ(render_scene.lamps().size(), 1U);
}

TEST_F(RenderSceneTest, AMaskBelowItsCutoffHasNoObject)
{
  const auto node = add_object(scene, mesh, glm::dmat4(1.0));
  render_scene.update();
  ASSERT_NE(object_of(node), draw::object_identity);
  const auto set_alpha = [&](float alpha) {
    scene.edit(material, [&](scene::Material &value) {
      value.alpha_mode = scene::AlphaMode::Mask;
      value.alpha = alpha;
    });
    render_scene.update();
  };
  set_alpha(0.25F);
  EXPECT_EQ(object_of(node), draw::object_identity);
  set_alpha(0.75F);
  EXPECT_NE(object_of(node), draw::object_identity);
}

TEST_F(RenderSceneTest, MovingAParentChangesTheObjectsBelowItAlone)
{
  const auto parent = scene.add(scene::Node());
  const auto add_below = [&](scene::Handle<scene::Node> above, const glm::dvec3 &position) {
    scene::Node node;
    node.meshes = {mesh};
    node.parent_from_node = at(position);
    return scene.add(node, above);
  };
  const auto first = add_below(parent, {1, 0, 0});
  const auto second = add_below(first, {0, 1, 0});
  const auto other = add_below({}, {0, 0, 1});
  render_scene.update();
  std::vector<draw::ObjectIndex> expected = {object_of(first), object_of(second)};
  std::ranges::sort(expected);
  const std::uint64_t structure = render_scene.objects().structure_revision();
  EXPECT_EQ(changed_by([&] { scene.set_transform(parent, at({10, 0, 0})); }), expected);
  EXPECT_EQ(render_scene.objects().structure_revision(), structure) << "indices stay";
  EXPECT_EQ(place_of(first), glm::vec3(11, 0, 0));
  EXPECT_EQ(place_of(second), glm::vec3(11, 1, 0));
  EXPECT_EQ(changed_by([&] {
              scene.set_transform(other, at({0, 0, 2}));
            }),
            std::vector<draw::ObjectIndex>{object_of(other)});
  EXPECT_EQ(render_scene.objects().volume(object_of(other)).center_ws, glm::vec3(0, 0, 2));
}

TEST_F(RenderSceneTest, RemovedNodesTakeTheirObjectsWithThem)
{
  const auto parent = add_object(scene, mesh, at({1, 0, 0}));
  scene::Node child;
  child.meshes = {mesh, add_square_mesh(scene, material)};
  scene.add(child, parent);
  const auto other = add_object(scene, mesh, at({7, 0, 0}));
  render_scene.update();
  EXPECT_EQ(object_count(), 4U);
  const draw::ObjectIndex index = object_of(other);
  scene.remove(parent);
  render_scene.update();
  EXPECT_EQ(object_count(), 1U);
  EXPECT_EQ(object_of(other), index);
  // Two nodes in the places of the removed ones.
  const auto a = add_object(scene, mesh, at({2, 0, 0}));
  const auto b = add_object(scene, mesh, at({3, 0, 0}));
  render_scene.update();
  EXPECT_EQ(object_count(), 3U);
  EXPECT_EQ(place_of(a), glm::vec3(2, 0, 0));
  EXPECT_EQ(place_of(b), glm::vec3(3, 0, 0));
}

TEST_F(RenderSceneTest, ANodeHasAnObjectForEachOfItsMeshesAfterAnyEdits)
{
  std::minstd_rand random(7);
  const std::array<scene::Handle<scene::Mesh>, 3> meshes = {mesh, add_square_mesh(scene, material),
                                                            add_square_mesh(scene, material)};
  const std::array<scene::Handle<scene::Node>, 2> nodes = {add_object(scene, mesh, at({0, 0, 0})),
                                                           add_object(scene, mesh, at({1, 0, 0}))};
  for (int i = 0; i < 200; i++) {
    scene.edit(nodes[random() % 2], [&](scene::Node &node) {
      node.meshes.clear();
      for (std::size_t count = random() % 4; count > 0; count--) {
        node.meshes.push_back(meshes[random() % 3]);
      }
      node.parent_from_node[3].y = double(random() % 2);
    });
    render_scene.update();
    std::size_t expected_count = 0;
    for (const scene::Handle<scene::Node> node : nodes) {
      std::vector<scene::Handle<scene::Mesh>> expected = scene.nodes()[node].meshes;
      std::vector<scene::Handle<scene::Mesh>> found;
      for (draw::ObjectIndex index = 1; index < render_scene.objects().index_end(); index++) {
        if (render_scene.objects().is_live(index) && render_scene.object(index).node == node) {
          found.push_back(render_scene.object(index).mesh);
          EXPECT_EQ(render_scene.objects().world_from_object(index), glm::mat4(scene.world_from_node(node)));
        }
      }
      expected_count += expected.size();
      std::ranges::sort(expected);
      std::ranges::sort(found);
      ASSERT_EQ(found, expected) << "edit " << i;
    }
    ASSERT_EQ(object_count(), expected_count) << "edit " << i;
  }
}

TEST_F(RenderSceneTest, AnUpdateAfterOneThatFailedIsWhole)
{
  const auto node = add_object(scene, mesh, at({0, 0, 0}));
  scene.edit(node, [&](scene::Node &value) { value.meshes.push_back(mesh); });
  // Finite in double and not in float.
  const auto scaled = [&](scene::Handle<scene::Node> parent) {
    return scene.add(scene::Node{.name = "scaled", .parent_from_node = glm::scale(glm::dmat4(1.0), glm::dvec3(1e12))},
                     parent);
  };
  scene.set_parent(node, scaled(scaled(scaled({}))));
  scene.edit(node, [](scene::Node &value) { value.parent_from_node[3].x = 1e12; });
  EXPECT_THROW(render_scene.update(), gpu::Error);
  EXPECT_THROW(render_scene.update(), gpu::Error);
  scene.set_parent(node, {});
  render_scene.update();
  EXPECT_EQ(object_count(), 2U);
}

TEST_F(RenderSceneTest, ANodeInThePlaceOfARemovedOneBetweenTwoUpdates)
{
  const auto before = add_object(scene, mesh, at({1, 0, 0}));
  render_scene.update();
  scene.remove(before);
  const auto after = add_object(scene, mesh, at({2, 0, 0}));
  ASSERT_EQ(after.index, before.index);
  render_scene.update();
  EXPECT_EQ(object_count(), 1U);
  EXPECT_EQ(place_of(after), glm::vec3(2, 0, 0));
}

TEST_F(RenderSceneTest, OfManyObjectsTheMovedOneIsUploaded)
{
  std::vector<scene::Handle<scene::Node>> nodes;
  for (int i = 0; i < 1000; i++) {
    nodes.push_back(add_object(scene, mesh, at({i, 0, 0})));
  }
  constexpr std::size_t entry_bytes = sizeof(shared::ObjectData);
  EXPECT_EQ(uploaded_by([] {}), 1001 * entry_bytes + 2 * sizeof(shared::MaterialData));
  EXPECT_EQ(uploaded_by([] {}), 0U);
  EXPECT_EQ(uploaded_by([&] { scene.set_transform(nodes[500], at({0, 3, 0})); }), entry_bytes);
  EXPECT_EQ(uploaded_by([&] { scene.set_transform(nodes[500], at({0, 3, 0})); }), 0U) << "it is there already";
  EXPECT_EQ(uploaded_by([&] { scene.remove(nodes[500]); }), 0U);
  EXPECT_EQ(uploaded_by([&] { add_object(scene, mesh, at({0, 4, 0})); }), entry_bytes);
}

TEST_F(RenderSceneTest, AMaterialEditWritesTheMaterialBlockAlone)
{
  add_object(scene, mesh, glm::dmat4(1.0));
  static_cast<void>(uploaded_by([] {}));
  const std::uint64_t objects = render_scene.objects().revision();
  const std::uint64_t passes = render_scene.passes_revision();
  const std::uint64_t materials = render_scene.materials_revision();
  EXPECT_EQ(uploaded_by([&] {
              scene.edit(material, [](scene::Material &value) { value.base_color = {0.25F, 0.5F, 1.0F}; });
            }),
            sizeof(shared::MaterialData));
  EXPECT_EQ(render_scene.materials()[MaterialTable::place_of(scene, material)].diffuse, glm::vec3(0.25F, 0.5F, 1.0F));
  EXPECT_GT(render_scene.materials_revision(), materials);
  EXPECT_EQ(render_scene.passes_revision(), passes);
  EXPECT_EQ(render_scene.objects().revision(), objects);
}

TEST_F(RenderSceneTest, OfManyMaterialsTheEditedOnesAreUploaded)
{
  std::vector<scene::Handle<scene::Material>> materials;
  for (int i = 0; i < 100; i++) {
    materials.push_back(add_material(scene, glm::vec3(0.5F)));
  }
  constexpr std::size_t entry_bytes = sizeof(shared::MaterialData);
  static_cast<void>(uploaded_by([] {}));
  const auto edit = [&](std::size_t index) {
    scene.edit(materials[index], [](scene::Material &value) { value.roughness *= 0.5F; });
  };
  EXPECT_EQ(uploaded_by([&] { edit(50); }), entry_bytes);
  EXPECT_EQ(uploaded_by([&] {
              edit(10);
              edit(13);
            }),
            4 * entry_bytes)
      << "the range around both";
  EXPECT_EQ(uploaded_by([&] { scene.remove(materials[99]); }), entry_bytes) << "the default material stands there";
  const auto added = [&] { materials[99] = add_material(scene, glm::vec3(0.25F)); };
  EXPECT_EQ(uploaded_by(added), entry_bytes);
  add_texture(scene, 1, {1, 2, 3, 255});
  EXPECT_EQ(uploaded_by([] {}), 0U) << "no material reads the texture";
}

TEST_F(RenderSceneTest, PassesRevisionTellsWhatPassesAreMadeOf)
{
  const auto texture = add_texture(scene, 1, {1, 2, 3, 255});
  const auto node = add_object(scene, mesh, glm::dmat4(1.0));
  const auto lamp = add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  render_scene.update();
  const auto is_changed_by = [&](auto &&change) {
    const std::uint64_t before = render_scene.passes_revision();
    change();
    render_scene.update();
    return render_scene.passes_revision() != before;
  };
  const auto edit_material = [&](auto &&change) { return is_changed_by([&] { scene.edit(material, change); }); };
  EXPECT_TRUE(edit_material([](scene::Material &value) { value.is_double_sided = false; }));
  EXPECT_TRUE(edit_material([](scene::Material &value) { value.alpha_mode = scene::AlphaMode::Mask; }));
  EXPECT_TRUE(edit_material([&](scene::Material &value) { value.base_color_texture = texture; }));
  EXPECT_FALSE(edit_material([](scene::Material &value) { value.roughness = 0.25F; }));
  EXPECT_TRUE(is_changed_by([&] { scene.edit(mesh, [](scene::Mesh &value) { value.indices.resize(3); }); }));
  EXPECT_FALSE(is_changed_by([&] { scene.edit(mesh, [](scene::Mesh &value) { value.positions[0].z = 1.0F; }); }));
  EXPECT_TRUE(is_changed_by([&] { scene.edit(mesh, [](scene::Mesh &value) { value.material = {}; }); }));
  EXPECT_TRUE(
      is_changed_by([&] { scene.edit(scene.images().first(), [](scene::Image &value) { value.texels[0] = 77; }); }));
  EXPECT_TRUE(is_changed_by(
      [&] { scene.edit(texture, [](scene::Texture &value) { value.wrap_u = scene::TextureWrap::MirroredRepeat; }); }));
  EXPECT_FALSE(is_changed_by([&] { scene.set_transform(node, at({1, 0, 0})); }));
  EXPECT_FALSE(is_changed_by([&] { scene.edit(lamp, [](scene::Lamp &value) { value.intensity = 3.0F; }); }));
}

TEST_F(RenderSceneTest, LampsRevisionTellsOfEditsAndMovesOfLamps)
{
  const auto parent = scene.add(scene::Node());
  scene::Node node;
  node.lamp = scene.add(scene::Lamp());
  const auto lamp_node = scene.add(node, parent);
  const auto object = add_object(scene, mesh, glm::dmat4(1.0));
  render_scene.update();
  const auto is_changed_by = [&](auto &&change) {
    const std::uint64_t before = render_scene.lamps_revision();
    change();
    render_scene.update();
    return render_scene.lamps_revision() != before;
  };
  EXPECT_TRUE(is_changed_by([&] { scene.set_transform(lamp_node, at({1, 0, 0})); }));
  EXPECT_TRUE(is_changed_by([&] { scene.set_transform(parent, at({0, 1, 0})); }));
  EXPECT_EQ(glm::dvec3(render_scene.lamps()[0].world_from_lamp[3]), glm::dvec3(1, 1, 0));
  EXPECT_TRUE(is_changed_by([&] { scene.edit(node.lamp, [](scene::Lamp &lamp) { lamp.intensity = 9.0F; }); }));
  EXPECT_FALSE(is_changed_by([&] { scene.set_transform(object, at({1, 0, 0})); }));
  EXPECT_FALSE(is_changed_by([&] { scene.add(scene::Lamp()); })) << "a lamp at no node";
  EXPECT_FALSE(is_changed_by([&] {
    scene.set_transform(parent, glm::scale(at({0, 1, 0}), glm::dvec3(1, 1, 2)));
  })) << "a node's scale does not change its lamp";
  EXPECT_TRUE(is_changed_by([&] { scene.remove(node.lamp); }));
  EXPECT_TRUE(render_scene.lamps().empty());
}

TEST_F(RenderSceneTest, TheOriginIsSubtractedInDouble)
{
  // Floats at 1e6 m are spaced by 6 cm, and half a metre beside 1e9 m is lost.
  for (const double far : {1e6, 1e9}) {
    const auto node = add_object(scene, mesh, at({far + 0.5, -far - 0.25, 0.125}));
    add_lamp(scene, scene::Lamp(), at({far + 0.125, -far, 0}));
    const auto camera = measure::camera_at({0, 0, 0}, {0, 0, -1});
    render_scene.set_origin({far, -far, 0});
    render_scene.update();
    EXPECT_EQ(place_of(node), glm::vec3(0.5F, -0.25F, 0.125F));
    EXPECT_EQ(render_scene.object(object_of(node)).bounds.center(), glm::vec3(0.5F, -0.25F, 0.125F));
    EXPECT_EQ(glm::dvec3(render_scene.lamps().back().world_from_lamp[3]), glm::dvec3(0.125, 0, 0));
    scene::PlacedCamera moved = camera;
    moved.world_from_camera[3] = glm::dvec4(far + 0.0625, -far, 3, 1);
    EXPECT_EQ(glm::dvec3(render_scene.relative(moved).world_from_camera[3]), glm::dvec3(0.0625, 0, 3));
    measure::remove_lamps(scene);
    scene.remove(node);
  }
}

TEST_F(RenderSceneTest, AnotherOriginMovesEveryObjectAndTheSameOneNone)
{
  for (int i = 0; i < 10; i++) {
    add_object(scene, mesh, at({i, 0, 0}));
  }
  render_scene.update();
  EXPECT_EQ(changed_by([&] { render_scene.set_origin({0, 0, 0}); }).size(), 0U);
  EXPECT_EQ(changed_by([&] { render_scene.set_origin({100, 0, 0}); }).size(), 10U);
  EXPECT_EQ(changed_by([&] { render_scene.set_origin({100, 0, 0}); }).size(), 0U);
  EXPECT_NEAR(render_scene.bounds().min.x, -101.0F, 1e-4F);
}

TEST(OriginNear, KeepsTheCurrentOriginWithinItsStep)
{
  const glm::dvec3 current(1024, 0, -2048);
  for (const glm::dvec3 &offset : {glm::dvec3(0), glm::dvec3(1000, -1000, 1000), glm::dvec3(0, 0, -1024)}) {
    EXPECT_EQ(origin_near(current + offset, current, {}), current);
  }
  EXPECT_EQ(origin_near({1024 + 1025, 0, -2048}, current, {}), glm::dvec3(2048, 0, -2048));
  EXPECT_EQ(origin_near({1e6 + 0.5, -3, 600}, current, {}), glm::dvec3(1024.0 * 977, 0, 1024));
}

TEST(OriginNear, IsWithinAStepOfThePositionAndAMultipleOfIt)
{
  for (const double coordinate : {0.0, 511.0, 513.0, -1e3, 1e6 + 0.5, -1e9}) {
    const glm::dvec3 position(coordinate, -coordinate, 0.5 * coordinate);
    const glm::dvec3 origin = origin_near(position, glm::dvec3(0), {});
    for (int axis = 0; axis < 3; axis++) {
      EXPECT_LE(std::abs(position[axis] - origin[axis]), 1024.0);
      EXPECT_EQ(std::fmod(origin[axis], 1024.0), 0.0);
    }
  }
}

TEST(OriginNear, HasSmallStepsForASmallScene)
{
  // The radius is 1.73 mm, and the step 0.25 m.
  const scene::Bounds small{glm::vec3(-1e-3F), glm::vec3(1e-3F)};
  EXPECT_EQ(origin_near({0.2, -0.25, 0}, glm::dvec3(0), small), glm::dvec3(0));
  EXPECT_EQ(origin_near({30.0, 0.3, 0}, glm::dvec3(0), small), glm::dvec3(30.0, 0.25, 0));
  const scene::Bounds large{glm::vec3(-4), glm::vec3(4)};
  EXPECT_EQ(origin_near({1000, 0, 0}, glm::dvec3(0), large), glm::dvec3(0));
  // A point has no radius, and a bound above 1e19 m an infinite one.
  EXPECT_EQ(origin_near({0.5, 0, 0}, glm::dvec3(0), {glm::vec3(1), glm::vec3(1)}).x, 0.5);
  EXPECT_EQ(origin_near({1000, 0, 0}, glm::dvec3(0), {glm::vec3(-1e38F), glm::vec3(1e38F)}), glm::dvec3(0));
}

}  // namespace
}  // namespace gnomon::render_scene
