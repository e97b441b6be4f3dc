// SPDX-License-Identifier: MIT
#pragma once

#include "draw_objects.hh"
#include "draw_view.hh"
#include "draw_visible.hh"

#include "gpu_device.hh"

#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/**
 * A Pass contains ShadingGroups, and a ShadingGroup contains draw calls.
 *
 * A pass is built once, as plain data, on any thread. Pass::record then appends it to a gpu::CommandList for a View,
 * any number of times. Binding names are resolved when they are bound, not when they are recorded. A binding is either
 * **by value** (copied when it is bound) or **by reference** (`_ref`: the group keeps a pointer and reads the value at
 * each Pass::record). Bindings by reference allow one pass to draw, for example, the shadow maps of many lamps. A pass
 * knows what it has bound by value: Pass::is_current.
 */
namespace gnomon::draw {

/** A texture and a sampler, to be bound to a texture slot. */
struct TextureBinding {
  gpu::ResourceId texture = 0;
  gpu::ResourceId sampler = 0;
};

/** Numbers of instances that Pass::record has drawn, and of calls that it has culled. */
struct RecordCounts {
  /** Drawn instances: one for each call and each procedural call, and all instances of instance calls. */
  std::uint64_t drawn = 0;
  /** Calls that were not drawn because their culling volume is outside of the view. */
  std::uint64_t culled = 0;
};

/**
 * Draws a batch once for each added instance. Instances may change between records. Lives as long as its group. A
 * shader that includes draw_object_lib.glsl defines DRAW_INSTANCES.
 */
class InstanceCall {
 public:
  /** Add an instance. \a value: gpu::DrawInstance::value; the shader defines its meaning */
  void add(ObjectIndex object, std::uint32_t value = 0)
  {
    instances_.push_back({object, value});
  }
  void clear();

 private:
  friend class ShadingGroup;
  friend class Pass;
  explicit InstanceCall(const gpu::BatchRange &batch) : batch_(batch) {}

  gpu::BatchRange batch_;
  std::vector<gpu::DrawInstance> instances_;
};

/**
 * Draw calls that share a shader and bindings. They are drawn in this order: calls, instance calls, calls and instance
 * calls of batches in buffers of the host (gpu::HostBatch), procedural calls.
 * Pass::group creates groups; a group lives until Pass::clear or the end of the pass. The shader and values bound by
 * reference must live until the last record; batches and bound resources until the last submission.
 *
 * Binding a name that the shader does not read has no effect and is not an error, because the compiler may have removed
 * the name. Binding a name again replaces its value.
 */
class ShadingGroup {
 public:
  void bind_uniform(std::string_view name, const gpu::Buffer &block);
  void bind_uniform_ref(std::string_view name, const gpu::BufferRange *block);
  void bind_storage(std::string_view name, const gpu::Buffer &block);
  void bind_storage_ref(std::string_view name, const gpu::BufferRange *block);
  void bind_texture(std::string_view name, const gpu::Texture &texture, const gpu::Sampler &sampler);
  void bind_texture_ref(std::string_view name, const TextureBinding *binding);

  /** Set a member of the push-constant block. \pre T has the member's type: int, float, a vector or a matrix */
  template <typename T>
  void constant(std::string_view name, const T &value)
  {
    if (Constant *constant = constant_entry(name, sizeof(T))) {
      constant->reference = nullptr;
      std::memcpy(constant_bytes_.data() + constant->offset_bytes, &value, sizeof(T));
    }
  }
  template <typename T>
  void constant_ref(std::string_view name, const T *value)
  {
    if (Constant *constant = constant_entry(name, sizeof(T))) {
      constant->reference = value;
    }
  }

  /** Add bits to the state of the pass for this group. */
  void state_enable(gpu::State state)
  {
    state_ = state_ | state;
  }

  /**
   * Draw the batch once with its own matrix. Adds an object to the pass's ObjectBuffer. Pass::clear does not remove
   * this object. \pre the pass has an ObjectBuffer
   */
  void call(const gpu::Batch &batch, const glm::mat4 &world_from_object);
  /**
   * Draw the batch once for an object of the pass's ObjectBuffer. Pass::record culls the call with the volume that the
   * object has at that time.
   */
  void call(const gpu::Batch &batch, ObjectIndex object = object_identity);
  /** The same for a range of a batch, from Batch::range(). */
  void call(const gpu::BatchRange &batch, ObjectIndex object);
  /**
   * Draw the batch once. Pass::record culls the call with \a volume instead of the object's volume, unless the radius
   * of \a volume is negative.
   */
  void call(const gpu::Batch &batch, ObjectIndex object, const CullingVolume &volume);
  /** Draw the batch for instances that the caller adds to the returned call. They are not culled. */
  InstanceCall &instances(const gpu::Batch &batch);
  /** Draw triangles without vertex attributes. The vertex shader computes their vertices. */
  void call_procedural(std::uint32_t triangle_count = 1, std::uint32_t instance_count = 1);

 private:
  friend class Pass;

  struct Binding {
    gpu::BindingKind kind;
    int slot;
    std::string name;
    std::variant<gpu::BufferRange, TextureBinding, const gpu::BufferRange *, const TextureBinding *> value;
    [[nodiscard]] bool is_reference() const
    {
      return value.index() >= 2;
    }
  };
  struct Constant {
    std::string name;
    std::uint32_t offset_bytes;
    std::size_t size_bytes;
    /** nullptr: the value is in constant_bytes_. */
    const void *reference = nullptr;
  };
  /** Kept as small as possible, because reading the calls takes most of the time of a record. */
  struct Call {
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::int32_t base_vertex = 0;
    ObjectIndex object = object_identity;
    /** Index in volumes_. */
    std::uint32_t volume = object_volume;
  };
  struct HostCall {
    Call call;
    gpu::ResourceId host_batch = 0;
  };
  /** Call::volume of a call that is culled with the volume of its object. */
  static constexpr std::uint32_t object_volume = ~std::uint32_t(0);
  struct ProceduralCall {
    std::uint32_t triangle_count;
    std::uint32_t instance_count;
  };

  ShadingGroup(const gpu::Shader &shader, ObjectBuffer *objects);

  template <typename Value>
  void bind(gpu::BindingKind kind, std::string_view name, const Value &value);
  /** The entry of the constant \a name, created by the first call; nullptr if the shader has no such constant. */
  [[nodiscard]] Constant *constant_entry(std::string_view name, std::size_t size_bytes);
  void record_bindings(gpu::CommandList &list) const;
  /** \see Pass::is_current */
  [[nodiscard]] bool is_current(const gpu::Device &device) const;
  void add_call(const gpu::BatchRange &batch, ObjectIndex object, std::uint32_t volume);
  [[nodiscard]] bool is_visible(const Call &call, const View &view, const VisibleObjects &visible) const
  {
    return call.volume == object_volume ? !objects_ || visible.contains(call.object)
                                        : view.touches(volumes_[call.volume]);
  }
  /** Appends a draw to the list, but no command. \a may_extend: the call may be added to the last draw */
  void append(const Call &call, bool may_extend, gpu::CommandList &list) const;
  static void append(const InstanceCall &call, gpu::CommandList &list);
  /** Appends the draws of the visible calls to the list, but no commands. \return the number of instances */
  std::uint64_t collect_calls(const View &view, const VisibleObjects &visible, gpu::CommandList &list) const;
  /** The same for instance calls. */
  std::uint64_t collect_instances(gpu::CommandList &list) const;
  /** Whether record_host_calls would draw. */
  [[nodiscard]] bool has_host_draws(const View &view, const VisibleObjects &visible) const;
  /** Appends the draws and commands of visible calls of batches in buffers of the host. */
  RecordCounts record_host_calls(const View &view, const VisibleObjects &visible, gpu::CommandList &list) const;
  /** Appends the command for the draws from \a first on, if there are any. \a objects: CommandList::bind_instances */
  static void record_draws(std::size_t first, std::size_t end, gpu::ResourceId objects, gpu::CommandList &list);
  [[nodiscard]] gpu::ResourceId object_buffer() const
  {
    return objects_ ? objects_->buffer().id() : 0;
  }

  const gpu::Shader &shader_;
  ObjectBuffer *objects_;
  gpu::State state_ = gpu::State::None;
  std::vector<Binding> bindings_;
  std::vector<Constant> constants_;
  /** Content of the push-constant block. */
  std::vector<std::byte> constant_bytes_;
  std::vector<Call> calls_;
  /** Calls of batches in buffers of the host. */
  std::vector<HostCall> host_calls_;
  /** Volumes that were given with calls. */
  std::vector<CullingVolume> volumes_;
  /** A deque, because callers hold references to its elements. */
  std::deque<InstanceCall> instance_calls_;
  std::deque<InstanceCall> host_instance_calls_;
  std::vector<ProceduralCall> procedural_calls_;
};

/** Shading groups that are drawn in order with a common state. */
class Pass {
 public:
  /** \a objects: the objects of the calls; nullptr: all calls use object_identity. Must outlive the pass. */
  Pass(std::string name, gpu::State state, ObjectBuffer *objects = nullptr);

  /** Append a group. Groups are drawn in the order of their creation. */
  ShadingGroup &group(const gpu::Shader &shader);
  /** Remove all groups and calls. The name and the state stay. */
  void clear();

  /**
   * Append the commands that draw the pass for \a view to \a list. Omits calls that are culled, and groups whose calls
   * are all culled. \a without: bits to remove from the state, for this record only. One thread at a time may record
   * a pass.
   * \pre called between begin_pass and end_pass of \a list, and after ObjectBuffer::upload of the pass's objects
   */
  RecordCounts record(const View &view, gpu::CommandList &list, gpu::State without = gpu::State::None) const;
  /** The same. Updates \a visible, which several passes of the same objects may share, if the pass has calls. */
  RecordCounts record(const View &view, VisibleObjects &visible, gpu::CommandList &list,
                      gpu::State without = gpu::State::None) const;

  [[nodiscard]] const std::string &name() const
  {
    return name_;
  }
  /** Draw the groups in the order of these indices, counted as they were made; an index may be missing. */
  void set_order(std::vector<std::uint32_t> order)
  {
    order_ = std::move(order);
  }

  /** Whether its calls draw objects. */
  [[nodiscard]] bool has_objects() const
  {
    return objects_ != nullptr;
  }
  [[nodiscard]] bool is_empty() const
  {
    return groups_.empty();
  }
  /**
   * Whether all buffers, textures and samplers that were bound by value still exist. Otherwise the pass must be built
   * again. No other resource gets their ids.
   */
  [[nodiscard]] bool is_current(const gpu::Device &device) const;
  /** Text of the groups and calls. \a device supplies the names of resources. Does not depend on the backend. */
  [[nodiscard]] std::string serialize(const gpu::Device &device) const;

 private:
  RecordCounts record_group(const ShadingGroup &group, const View &view, const VisibleObjects &visible,
                            gpu::CommandList &list, gpu::State without) const;

  std::string name_;
  gpu::State state_;
  ObjectBuffer *objects_;
  std::deque<ShadingGroup> groups_;
  /** The visible objects of the last record for a view. Kept so that no record allocates memory, and that the same view
   * is tested once. */
  mutable VisibleObjects visible_;
  /** Empty: the order in which they were made. */
  std::optional<std::vector<std::uint32_t>> order_;
};

}  // namespace gnomon::draw
