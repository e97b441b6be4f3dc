// SPDX-License-Identifier: MIT
#include "eevee_budgeted_picture.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Most samples of one call, which bound it where samples take no time. */
constexpr int samples_per_call_max = 64;

std::int64_t pixel_count(glm::ivec2 size_px)
{
  return std::int64_t(size_px.x) * std::int64_t(size_px.y);
}

double system_seconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Settings preview_settings(Settings settings, int shadow_divisor)
{
  // The picture that the preview stands for has this light.
  settings.emissive_point_count = settings.emissive_points();
  settings.sample_count = 1;
  settings.noise_threshold = 0.0F;
  settings.sample_first = settings.sample_end = 0;
  settings.has_probe = settings.has_surfaces = settings.is_timed = false;
  ShadowSettings &shadow = settings.shadow;
  const auto divided = [&](int size_px) { return std::max(1, size_px / shadow_divisor); };
  shadow.cube_size_px = divided(shadow.cube_size_px);
  shadow.map_size_px = divided(shadow.map_size_px);
  shadow.esm.size_px = divided(shadow.esm.size_px);
  // Its depths would be read back, and the picture drawn twice.
  shadow.is_fitted_to_depth = false;
  return settings;
}

}  // namespace

std::string BudgetReport::text() const
{
  const std::string samples = sample_count == 0 ? fmt::format("{} samples", samples_drawn)
                                                : fmt::format("{}/{} samples", samples_drawn, sample_count);
  if (kind != Kind::Preview) {
    return fmt::format("{}, {:.1f} of {:.1f} ms", samples, 1e3 * seconds, 1e3 * budget_seconds);
  }
  const std::string why = whole_seconds ? fmt::format("a whole sample takes about {:.0f} ms", 1e3 * *whole_seconds)
                                        : "the time of a whole sample is not known yet";
  return fmt::format("preview, {}x{} of {}x{} px, shadows 1/{}, {:.1f} of {:.1f} ms: {}", drawn_size_px.x,
                     drawn_size_px.y, size_px.x, size_px.y, shadow_divisor, 1e3 * seconds, 1e3 * budget_seconds, why);
}

BudgetedPicture::BudgetedPicture(render_scene::RenderScene &scene, Engine &engine, draw::Viewport &viewport,
                                 Clock clock)
    : scene_(scene), engine_(engine), viewport_(viewport), clock_(clock ? std::move(clock) : system_seconds)
{
}

void BudgetedPicture::begin(double budget_seconds)
{
  // Also false for NaN.
  if (!(budget_seconds >= BudgetController::budget_min && budget_seconds <= BudgetController::budget_max)) {
    throw gpu::Error("eevee: a budget of {} s is not in [{}, {}]", budget_seconds, BudgetController::budget_min,
                     BudgetController::budget_max);
  }
  budget_ = budget_seconds;
  begun_ = clock_();
}

double BudgetedPicture::spent() const
{
  return clock_() - begun_;
}

template <typename Work>
double BudgetedPicture::time_of(Work &&work)
{
  const double before = clock_();
  work();
  viewport_.device().finish();
  return clock_() - before;
}

bool BudgetedPicture::is_of(const draw::View &view) const
{
  const std::array<draw::Engine *, 1> engines = {&engine_};
  return viewport_.is_of(engines, view);
}

bool BudgetedPicture::has_samples(const draw::View &view) const
{
  return viewport_.samples_drawn() > 0 && is_of(view);
}

bool BudgetedPicture::draw(const draw::View &view, const draw::Target &target)
{
  const bool is_shown = shown_ == viewport_.restart_count() && shown_view_ == view;
  const int samples_before = has_samples(view) ? viewport_.samples_drawn() : 0;
  has_drawn_preview_ = false;
  // If this fails, no picture is shown.
  shown_.reset();
  try {
    if (is_shown || has_samples(view)) {
      stalled_calls_ = has_samples(view) ? 0 : stalled_calls_ + 1;
      if (stalled_calls_ <= stalled_calls_max || !draw_better(view)) {
        refine(view);
      }
    }
    else {
      stalled_calls_ = 0;
      draw_first(view);
    }
    if (!has_samples(view) && !has_preview_) {
      // A picture that was shown is lost.
      draw_part(view, draw::Viewport::no_rows_max);
    }
  }
  catch (...) {
    viewport_.set_rows_max(draw::Viewport::no_rows_max);
    viewport_.set_setup_max(draw::Viewport::no_setup_max);
    throw;
  }
  viewport_.set_rows_max(draw::Viewport::no_rows_max);
  const bool is_preview = !has_samples(view);
  shown_ = viewport_.restart_count();
  shown_view_ = view;
  is_preview_shown_ = is_preview;
  if (target) {
    write(target);
  }
  const bool is_complete = !is_preview && engine_.is_complete(viewport_);
  report_ = {
      .kind = is_preview    ? BudgetReport::Kind::Preview
              : is_complete ? BudgetReport::Kind::Complete
                            : BudgetReport::Kind::Refining,
      .is_new = !is_shown || has_drawn_preview_ || (is_preview ? 0 : viewport_.samples_drawn()) != samples_before,
      .size_px = viewport_.size_px(),
      .drawn_size_px = is_preview ? preview_->size_px() : viewport_.size_px(),
      .shadow_divisor = is_preview ? preview_settings_->second : 1,
      .samples_drawn = is_preview ? 0 : viewport_.samples_drawn(),
      .sample_count = engine_.settings().sample_count,
      .budget_seconds = budget_,
      .seconds = spent(),
      .whole_seconds = controller_.whole_seconds(pixel_count(viewport_.size_px()))};
  return is_complete;
}

void BudgetedPicture::write(const draw::Target &target)
{
  // If this fails, no picture is shown.
  const std::optional<std::uint64_t> shown = std::exchange(shown_, std::nullopt);
  if (!shown) {
    throw gpu::Error("eevee: there is no picture to write: BudgetedPicture::draw must come before write");
  }
  const std::array<draw::Engine *, 1> engines = {is_preview_shown_ ? preview_engine_.get() : &engine_};
  draw::Target written = target;
  written.size_px = draw::size_in(target, viewport_.size_px());
  controller_.add_write(time_of([&] { (is_preview_shown_ ? *preview_ : viewport_).write(engines, written); }));
  shown_ = shown;
}

void BudgetedPicture::draw_first(const draw::View &view)
{
  const glm::ivec2 size_px = viewport_.size_px();
  const BudgetController::FirstPlan plan = controller_.plan_first(budget_, pixel_count(size_px));
  has_preview_ = !plan.is_whole;
  if (has_preview_) {
    draw_preview(view, plan, true);
    return;
  }
  draw_part(view, 0, spent());
  // Surfaces that transmit light are drawn in one part.
  if (!has_samples(view)) {
    draw_part(view, draw::Viewport::no_rows_max);
  }
}

bool BudgetedPicture::draw_better(const draw::View &view)
{
  BudgetController::FirstPlan plan = preview_plan_;
  if (plan.level > 0) {
    plan.level--;
  }
  else if (plan.shadow_divisor > 1) {
    plan.shadow_divisor /= 2;
  }
  else {
    return false;
  }
  stalled_calls_ = 0;
  const bool is_lit = viewport_.has_begun_sample() && !viewport_.has_open_setup() && is_of(view);
  if (is_lit && viewport_.rows_left() <= int(viewport_.row_count() * std::exp2(-plan.level))) {
    draw_part(view, viewport_.rows_left());
  }
  else {
    draw_preview(view, plan, false);
  }
  return true;
}

void BudgetedPicture::draw_preview(const draw::View &view, const BudgetController::FirstPlan &plan, bool is_planned)
{
  preview_plan_ = plan;
  has_drawn_preview_ = true;
  const glm::ivec2 size_px = BudgetController::size_at(plan.level, viewport_.size_px());
  std::array<draw::Engine *, 1> engines{};
  // The time of edits, which was spent before, is a part of the set-up.
  const double before = spent();
  const double setup = before + time_of([&] {
                         const std::pair<std::uint64_t, int> from(engine_.settings_revision(), plan.shadow_divisor);
                         if (preview_settings_ != from) {
                           const Settings settings = preview_settings(engine_.settings(), plan.shadow_divisor);
                           if (preview_engine_) {
                             preview_engine_->set_settings(settings);
                           }
                           else {
                             preview_ = std::make_unique<draw::Viewport>(viewport_.device(), size_px);
                             preview_engine_ = std::make_unique<Engine>(engine_, settings);
                           }
                           preview_settings_ = from;
                         }
                         engines = {preview_engine_.get()};
                         preview_->resize(size_px);
                         preview_->sync(engines, scene_.objects());
                         preview_->restart();
                         preview_->set_rows_max(0);
                         preview_->draw(engines, view);
                       });
  const double rows = time_of([&] {
    preview_->set_rows_max(draw::Viewport::no_rows_max);
    preview_->draw(engines, view);
  });
  if (is_planned) {
    controller_.add_preview(setup, rows, pixel_count(size_px));
  }
  else {
    controller_.skip_preview();
  }
}

void BudgetedPicture::draw_part(const draw::View &view, int rows, double spent_before)
{
  const bool is_setup = rows == 0;
  const bool is_first = !has_samples(view);
  const bool has_begun = viewport_.has_open_setup() && is_of(view);
  const int rows_before = viewport_.rows_left();
  const int samples_before = is_first ? 0 : viewport_.samples_drawn();
  const std::array<draw::Engine *, 1> engines = {&engine_};
  const double seconds = time_of([&] {
    viewport_.set_rows_max(rows);
    viewport_.draw(engines, view);
  });
  const bool is_whole = viewport_.samples_drawn() > samples_before;
  if (is_setup) {
    setup_seconds_ = seconds + (has_begun ? setup_seconds_ : spent_before);
    // Where something transmits light, all rows were lit, too.
    if (has_begun && !is_whole) {
      controller_.add_shadow_parts(seconds, viewport_.setup_count());
    }
    else if (viewport_.has_open_setup()) {
      controller_.add_beginning(seconds);
    }
    if (!viewport_.has_open_setup()) {
      controller_.add_setup(setup_seconds_, is_first);
    }
    return;
  }
  const int drawn = rows_before - (is_whole ? 0 : viewport_.rows_left());
  controller_.add_rows(seconds, pixel_count({viewport_.drawn_size_px().x, drawn}));
}

bool BudgetedPicture::draw_setup(const draw::View &view, bool has_drawn)
{
  int parts = draw::Viewport::no_setup_max;
  if (viewport_.has_open_setup() && is_of(view)) {
    parts = controller_.plan_shadow_parts(budget_, spent(), setup_parts_, !has_drawn);
    if (parts == 0) {
      return false;
    }
  }
  else if (!controller_.fits_setup(budget_, spent(), !has_samples(view))) {
    if (has_drawn && !controller_.fits_beginning(budget_, spent())) {
      return false;
    }
    parts = 0;
  }
  const bool is_begun = viewport_.has_open_setup() && is_of(view);
  viewport_.set_setup_max(parts);
  draw_part(view, 0);
  // Another viewport may have taken the layers of this sample.
  setup_parts_ = is_begun ? std::max(setup_parts_, viewport_.setup_left()) : viewport_.setup_left();
  viewport_.set_setup_max(draw::Viewport::no_setup_max);
  return true;
}

void BudgetedPicture::refine(const draw::View &view)
{
  bool has_drawn = false;
  const int samples_before = has_samples(view) ? viewport_.samples_drawn() : 0;
  while (!has_samples(view) ||
         (!engine_.is_complete(viewport_) && viewport_.samples_drawn() < samples_before + samples_per_call_max)) {
    if (!viewport_.has_begun_sample() || viewport_.has_open_setup() || !is_of(view)) {
      if (!draw_setup(view, has_drawn)) {
        return;
      }
      has_drawn = true;
      continue;
    }
    const int rows = controller_.plan_rows(budget_, spent(), viewport_.drawn_size_px().x, viewport_.rows_left(),
                                           viewport_.row_count(), !has_drawn);
    if (rows == 0) {
      return;
    }
    draw_part(view, rows);
    has_drawn = true;
  }
}

}  // namespace gnomon::eevee
