// SPDX-License-Identifier: MIT
#pragma once

#include "draw_objects.hh"
#include "draw_view.hh"

#include "gpu_device.hh"

#include <cstring>
#include <deque>
#include <string>
#include <variant>

/**
 * Pass > ShadingGroup > call.
 *
 * A pass is recorded once, as plain data, on any thread, and drawn as often as wanted, each time for a View, by
 * Pass::record, which appends to a gpu::CommandList. Names are resolved when they are bound, never when drawn.
 * Each binding is **by value** (copied now) or **by reference** (`_ref`: a pointer is kept, and what it points to is
 * read at each record, so that one pass draws one lamp after another).
 */
namespace gnomon::draw {

/** What is bound to a texture slot. */
struct TextureBinding {
  gpu::ResourceId texture = 0;
  gpu::ResourceId sampler = 0;
};

/** What Pass::record did with a pass's calls. */
struct RecordCounts {
  /** Instances drawn: each call's own, and those of instance calls; a procedural call is one. */
  std::uint64_t drawn = 0;
  /** Instances left out, as the view does not touch their volume. */
  std::uint64_t culled = 0;
};

/** Instances of a batch that may be added and removed after the call was made. Lives as long as its pass. */
class InstanceCall {
 public:
  /** One more instance: an object, and a value for the shader to interpret. */
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
 * Calls that share a shader and bindings. Drawn in this order: calls, instances, procedural calls. Made by Pass::group;
 * lives as long as its pass. The shader must live until the last record; what is bound by value until the last
 * submission.
 *
 * A name that the shader does not read is no error and binds nothing: the compiler may have dropped it.
 */
class ShadingGroup {
 public:
  void bind_uniform(std::string_view name, const gpu::Buffer &block);
  void bind_uniform_ref(std::string_view name, const gpu::BufferRange *block);
  void bind_storage(std::string_view name, const gpu::Buffer &block);
  void bind_storage_ref(std::string_view name, const gpu::BufferRange *block);
  void bind_texture(std::string_view name, const gpu::Texture &texture, const gpu::Sampler &sampler);
  void bind_texture_ref(std::string_view name, const TextureBinding *binding);

  /** A member of the push-constant block. \pre T is as large as the member: int, float, vectors, matrices. */
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

  /** Bits in addition to the pass's. */
  void state_enable(gpu::State state)
  {
    state_ = state_ | state;
  }

  /** Draw the batch once, with a matrix. \pre the pass has an ObjectBuffer. */
  void call(const gpu::Batch &batch, const glm::mat4 &world_from_object);
  /**
   * The same with an object of the pass's ObjectBuffer. Left out for views that do not touch the volume that the object
   * has there when the pass is recorded.
   */
  void call(const gpu::Batch &batch, ObjectIndex object = object_identity);
  /** Left out for views that do not touch \a volume. */
  void call(const gpu::Batch &batch, ObjectIndex object, const CullingVolume &volume);
  /** Instances to be added until the pass is recorded, and changed between records. */
  InstanceCall &instances(const gpu::Batch &batch);
  /** \a count triangles whose vertices the shader makes up. */
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
    /** nullptr: by value, in constant_bytes_. */
    const void *reference = nullptr;
  };
  /** What is drawn: no more than a draw costs. */
  struct Call {
    gpu::BatchRange batch;
    ObjectIndex object = object_identity;
    CullingVolume volume;
  };
  struct ProceduralCall {
    std::uint32_t triangle_count;
    std::uint32_t instance_count;
  };

  ShadingGroup(const gpu::Shader &shader, ObjectBuffer *objects);

  template <typename Value>
  void bind(gpu::BindingKind kind, std::string_view name, const Value &value);
  /** Of the name, made at the first ask; nullptr where the shader has none. */
  [[nodiscard]] Constant *constant_entry(std::string_view name, std::size_t size_bytes);
  void record_bindings(gpu::CommandList &list) const;
  /** Appends to the list's draws, not to its commands. */
  RecordCounts collect_draws(const View &view, gpu::CommandList &list) const;

  const gpu::Shader &shader_;
  ObjectBuffer *objects_;
  gpu::State state_ = gpu::State::None;
  std::vector<Binding> bindings_;
  std::vector<Constant> constants_;
  /** The whole push-constant block. */
  std::vector<std::byte> constant_bytes_;
  std::vector<Call> calls_;
  /** Deque: the caller holds references. */
  std::deque<InstanceCall> instance_calls_;
  std::vector<ProceduralCall> procedural_calls_;
};

class Pass {
 public:
  /** \a objects: where calls with a matrix put it; nullptr where there are none. Must outlive the pass. */
  Pass(std::string name, gpu::State state, ObjectBuffer *objects = nullptr);

  /** A new group, drawn after those before it. */
  ShadingGroup &group(const gpu::Shader &shader);
  /** Forget groups and calls; the name and state stay. */
  void clear();

  /**
   * Append what \a view sees of the pass: to be called between begin_pass and end_pass of \a list. State bits in
   * \a without are left off this time. Of a group whose calls draw nothing, nothing is
   * appended.
   */
  RecordCounts record(const View &view, gpu::CommandList &list, gpu::State without = gpu::State::None) const;

  [[nodiscard]] const std::string &name() const
  {
    return name_;
  }
  [[nodiscard]] bool is_empty() const
  {
    return groups_.empty();
  }
  /** What was recorded, as text; resources by the names \a device has for them. The same on every backend. */
  [[nodiscard]] std::string serialize(const gpu::Device &device) const;

 private:
  std::string name_;
  gpu::State state_;
  ObjectBuffer *objects_;
  std::deque<ShadingGroup> groups_;
};

}  // namespace gnomon::draw
