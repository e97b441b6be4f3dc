// SPDX-License-Identifier: MIT
#pragma once

#include "draw_engine.hh"
#include "draw_objects.hh"
#include "draw_target.hh"
#include "draw_view.hh"

#include "gpu_device.hh"

#include <limits>
#include <map>
#include <optional>
#include <span>

namespace gnomon::draw {

/** Base class of the data that an engine stores for a viewport, such as textures, framebuffers and passes. */
struct EngineViewportData {
  virtual ~EngineViewportData() = default;
  /** Destroy everything that depends on the size of the picture. The next sync creates it again. */
  virtual void resized() = 0;
};

/** The part of a sample that one call of Engine::draw_scene draws. \see Viewport::set_rows_max */
struct SamplePart {
  /** The first part of the sample draws depth and shadows, which the others need. */
  bool is_first = true;
  /** With its rows, the sample is whole. */
  bool is_last = true;
  /** Rows of pixels to be lit, counted from the first row of Viewport::drawn_region. There may be none. */
  int row = 0;
  int row_count = 0;
  /** \see Viewport::set_setup_max */
  int setup_max = 0;
};

/**
 * Draws a picture of a scene with one or more engines. Owns the depth texture that the engines share and the data that
 * each engine stores for this picture. Must be destroyed before its device.
 *
 * Engines draw a guard band of pixels around the picture, so that the pixel filter finds samples beyond its edges.
 *
 * Each draw adds one sample to the picture until the engines have drawn all their samples. The next draw starts the
 * picture again with its first sample if:
 * - the size or the engines change;
 * - the view changes, or an engine finds a change during sync(), unless the picture is_moving();
 * - a packet with samples of the picture was lost;
 * - the feedback of the device changes the picture;
 * - restart() was called, or set_region() with another region.
 */
class Viewport {
 public:
  /** \throws gpu::Error if a dimension of \a size_px is less than 1 or exceeds Limits::texture_size_max */
  Viewport(gpu::Device &device, glm::ivec2 size_px);

  /**
   * Update the engines with the objects that have changed since their last sync of this viewport. Call this after every
   * edit of the scene. \a objects must be the same buffer in each call.
   */
  void sync(std::span<Engine *const> engines, const ObjectBuffer &objects);
  /**
   * Draw the next sample, or its next part (set_rows_max), with \a engines, in order, and write the mean of all whole
   * samples to \a target. While the device is recording, the commands become part of the recording. Otherwise they are
   * submitted at once, and drawn a second time if the feedback of the device changes the picture.
   *
   * \throws gpu::Error if an engine was not synced since the viewport was made or resized, or its last sync failed; if
   * the scene was edited since, as engines find; if \a view or its inverse is not finite, if \a target cannot hold the
   * picture, or if the submission fails. If drawing or submitting fails, the next draw starts the picture again.
   */
  void draw(std::span<Engine *const> engines, const View &view, const Target &target = {});
  /**
   * Write the mean of the samples so far to \a target. Draws no sample. \a engines: of the last draw.
   * \throws gpu::Error as draw(), and if samples_drawn() is 0
   */
  void write(std::span<Engine *const> engines, const Target &target);
  /**
   * Draw samples in parts: each draw lights at most this number of rows of pixels, of drawn_size_px(). The first draw
   * of a sample draws its depth and shadows, too; with 0 rows, only these. A picture that is drawn in parts is bit for
   * bit that of whole samples. No limit at first. It does not apply to draws with several engines. \pre \a rows is at
   * least 0
   */
  void set_rows_max(int rows)
  {
    rows_max_ = rows;
  }
  static constexpr int no_rows_max = std::numeric_limits<int>::max();
  /**
   * Divide the set-up of a sample, which is the work before its rows, into parts, too: a draw with 0 rows draws at most
   * \a units set-up units. The engine defines a *set-up unit*: eevee's is one layer of a shadow, or some rows of a
   * large layer. Its depth pass is no unit, and belongs to the first part. No limit at first. \pre units >= 0
   */
  void set_setup_max(int units)
  {
    setup_max_ = units;
  }
  static constexpr int no_setup_max = std::numeric_limits<int>::max();
  /**
   * Called by the engine during draw_scene: this part has drawn \a unit_count set-up units. If \a left_count units are
   * left, the part lights no rows.
   */
  void set_setup(int unit_count, int left_count);
  /** Set-up units that the last part has drawn. */
  [[nodiscard]] int setup_count() const
  {
    return setup_count_;
  }
  /** Set-up units that are left of the sample that has begun. 0: none, or no sample has begun. */
  [[nodiscard]] int setup_left() const
  {
    return next_row_ ? setup_left_ : 0;
  }
  /** Whether a sample has begun that needs more set-up units before its rows. */
  [[nodiscard]] bool has_open_setup() const
  {
    return setup_left() > 0;
  }
  /** During draw_scene: the part of the sample to be drawn. */
  [[nodiscard]] const SamplePart &part() const
  {
    return part_;
  }
  /** During draw_scene, before something is lit: light all rows that are left, because pixels depend on each other. */
  void extend_part();
  /** The pixels of part(), as drawn_region(). Undefined if it has no rows. */
  [[nodiscard]] gpu::Rectangle part_region() const;
  /** Rows of a sample: those of drawn_region(). */
  [[nodiscard]] int row_count() const;
  /** Rows of the next sample that are not lit yet. */
  [[nodiscard]] int rows_left() const
  {
    return row_count() - next_row_.value_or(0);
  }
  /** Whether the first part of the next sample is drawn. */
  [[nodiscard]] bool has_begun_sample() const
  {
    return next_row_.has_value();
  }
  /** During draw_scene: whether write() calls it, to which no sample is added. */
  [[nodiscard]] bool is_writing() const
  {
    return is_writing_;
  }
  /**
   * Pass the feedback of a submitted packet to the \a engines that drew in it. Hosts that record packets call this
   * after the submission and before the packet is recorded again. Without a recording, draw() calls it.
   * \return true if the picture of that packet is final; false if the next draw starts the picture again
   */
  bool take_feedback(std::span<Engine *const> engines, const gpu::Feedback &feedback);
  /** Start the picture again with the next draw. */
  void restart()
  {
    samples_drawn_ = 0;
    next_row_.reset();
    restart_count_++;
  }
  /** During sync: an engine found a change of the picture. */
  void scene_changed()
  {
    if (!is_moving_) {
      restart();
    }
  }
  /**
   * Whether each sample may show other objects from another view (motion blur): neither starts the picture again, and
   * nothing is fitted to depths of earlier samples. false at first.
   */
  [[nodiscard]] bool is_moving() const
  {
    return is_moving_;
  }
  void set_moving(bool is_moving)
  {
    is_moving_ = is_moving;
  }
  /** Whether the drawn samples show \a view, and \a engines drew them. */
  [[nodiscard]] bool is_of(std::span<Engine *const> engines, const View &view) const;
  /** Increased whenever the picture is started again. */
  [[nodiscard]] std::uint64_t restart_count() const
  {
    return restart_count_;
  }
  /** Number of whole samples drawn since the picture was started. */
  [[nodiscard]] int samples_drawn() const
  {
    return samples_drawn_;
  }
  /** View of the picture, without the guard band, in the current or the last draw. */
  [[nodiscard]] const View &view() const
  {
    return view_;
  }
  /** Target of the current or the last draw. The framebuffer of the last draw may no longer exist. */
  [[nodiscard]] const Target &target() const
  {
    return target_;
  }

  [[nodiscard]] gpu::Device &device() const
  {
    return device_;
  }
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  /**
   * Width of the guard band at the vertical and at the horizontal edges. 0 along an axis for which the device's
   * textures have no room.
   */
  [[nodiscard]] glm::ivec2 guard_px() const
  {
    return guard_px_;
  }
  /** Size of the picture with its guard band: that of the textures which engines draw the scene into. */
  [[nodiscard]] glm::ivec2 drawn_size_px() const
  {
    return size_px_ + 2 * guard_px_;
  }
  /**
   * Draw only these pixels of the picture, and write only these to targets; an empty size selects the whole picture.
   * Culling, shadows and filters remain those of the whole picture, so that each pixel has the same value as in a whole
   * picture. Outside of the region, the engines' textures are undefined. resize() selects the whole picture again.
   * \throws gpu::Error if the region is not within the picture; nothing changes then
   */
  void set_region(const gpu::Rectangle &region);
  /** The pixels of the picture that are drawn. */
  [[nodiscard]] gpu::Rectangle region() const
  {
    return region_.is_whole() ? gpu::Rectangle{{0, 0}, size_px_} : region_;
  }
  /** The pixels of textures of drawn_size_px() that the region's pixels depend on, for PassActions::scissor. */
  [[nodiscard]] gpu::Rectangle drawn_region() const;
  /** The picture's \a view, widened by the guard band. Engine::draw_scene gets this view. */
  [[nodiscard]] View drawn_view(const View &view) const;
  /**
   * Depth texture of drawn_size_px(), which engines attach to their framebuffers. The first call creates it.
   * \throws gpu::Error if the device cannot create the texture
   */
  [[nodiscard]] const gpu::Texture &depth_texture();
  [[nodiscard]] bool has_depth_texture() const
  {
    return bool(depth_texture_);
  }

  /**
   * During draw_scene: true if draw() calls draw_scene a second time unless the feedback of this call is final. The
   * engine may then draw only the part that the feedback depends on.
   */
  [[nodiscard]] bool draws_until_final() const
  {
    return draws_until_final_;
  }

  /**
   * The data of \a engine. The first call creates it from \a inputs; remove_engine destroys it.
   * \pre Data is the same in each call
   */
  template <typename Data, typename... Inputs>
  Data &engine_data(const Engine &engine, Inputs &&...inputs)
  {
    std::unique_ptr<EngineViewportData> &data = engines_[engine.id()].data;
    if (!data) {
      data = std::make_unique<Data>(std::forward<Inputs>(inputs)...);
    }
    return static_cast<Data &>(*data);
  }
  /** Destroy the data of \a engine in this viewport. Does nothing if the engine has no data here. */
  void remove_engine(const Engine &engine)
  {
    engines_.erase(engine.id());
  }
  /**
   * Change the size of the picture and destroy everything that depends on it. Call sync() before the next draw.
   * \throws gpu::Error under the same conditions as the constructor; nothing changes then
   */
  void resize(glm::ivec2 size_px);

 private:
  /** \throws gpu::Error if \a target cannot take a region */
  void check_region(const Target &target) const;
  /** \throws gpu::Error if a call of sync() is missing */
  void check_synced(std::span<Engine *const> engines) const;
  /** \a is_until_final: \see draws_until_final */
  void draw_sample(std::span<Engine *const> engines, bool is_until_final);
  void draw_until_final(std::span<Engine *const> engines);
  void begin_part(std::size_t engine_count);
  void end_part();

  gpu::Device &device_;
  glm::ivec2 size_px_;
  glm::ivec2 guard_px_;
  gpu::Rectangle region_;
  gpu::Texture depth_texture_;
  /** View of the drawn samples. */
  View view_;
  /** Engine::id of the engines that drew the samples. */
  std::vector<std::uint64_t> drawn_by_;
  Target target_;
  int samples_drawn_ = 0;
  std::uint64_t restart_count_ = 0;
  bool is_moving_ = false;
  int rows_max_ = no_rows_max;
  int setup_max_ = no_setup_max;
  int setup_count_ = 0;
  int setup_left_ = 0;
  SamplePart part_;
  /** The first row of the next part of a sample that has begun. */
  std::optional<int> next_row_;
  bool is_writing_ = false;
  /** gpu::Device::loss_count when the last sample was drawn. */
  std::uint64_t loss_count_ = 0;
  /** Used by draw() without a recording. */
  gpu::Packet packet_;
  bool draws_until_final_ = false;
  struct EngineState {
    std::unique_ptr<EngineViewportData> data;
    /** ObjectBuffer::revision at the last sync; empty if there was none or if the last one failed. */
    std::optional<std::uint64_t> synced_revision;
    /** The last sync succeeded, and the size is the same since. */
    bool is_synced = false;
  };
  /** By Engine::id. */
  std::map<std::uint64_t, EngineState> engines_;
};

}  // namespace gnomon::draw
