// SPDX-License-Identifier: MIT
#include "measure_page.hh"
#include "measure_report.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::measure {

namespace {

/** Factor that makes differences visible. */
constexpr float difference_scale = 8.0F;

struct FrontPoint {
  const TechniqueReport *technique;
  const PictureReport *picture;
};

/** The pictures on the front, the fastest first. */
std::vector<FrontPoint> front(const SceneReport &scene)
{
  std::vector<FrontPoint> points;
  for (const TechniqueReport &technique : scene.techniques) {
    for (const PictureReport &picture : technique.pictures) {
      if (picture.is_on_front) {
        points.push_back({&technique, &picture});
      }
    }
  }
  std::ranges::sort(points, {}, [](const FrontPoint &point) { return median(point.picture->seconds); });
  return points;
}

std::string name_of(const TechniqueReport &technique, const PictureReport &picture)
{
  return fmt::format("{}, {} {}", label(technique.technique), picture.sample_count,
                     picture.sample_count == 1 ? "sample" : "samples");
}

Chart error_against_time(const SceneReport &scene)
{
  Chart chart{scene.name + ": error against time", {"seconds, including shadows"}, {"RMSE"}, {}};
  ChartSeries marked{"Pareto front", {}, true, true};
  for (const FrontPoint &point : front(scene)) {
    marked.points.push_back(
        {median(point.picture->seconds), point.picture->error.rmse, name_of(*point.technique, *point.picture)});
  }
  chart.series.push_back(std::move(marked));
  for (const TechniqueReport &technique : scene.techniques) {
    if (chart.series.size() == 1 || chart.series.back().name != technique.technique.name) {
      chart.series.push_back({technique.technique.name, {}, false, false});
    }
    for (const PictureReport &picture : technique.pictures) {
      chart.series.back().points.push_back({median(picture.seconds), picture.error.rmse, name_of(technique, picture)});
    }
  }
  return chart;
}

Chart visibility_against_time(const SceneReport &scene)
{
  Chart chart{scene.name + ": wrong pixels of the lamps' shadows against the time to draw them",
              {"device seconds of the shadows"},
              {"share of wrong pixels"},
              {}};
  for (const TechniqueReport &technique : scene.techniques) {
    if (technique.technique.size_px == 0) {
      continue;
    }
    if (chart.series.empty() || chart.series.back().name != technique.technique.name) {
      chart.series.push_back({technique.technique.name, {}, true, false});
    }
    chart.series.back().points.push_back({step_seconds(technique, "shadows"), all_lamps(technique.lamps).wrong_fraction,
                                          fmt::format("{} px", technique.technique.size_px)});
  }
  return chart;
}

Table front_table(const SceneReport &scene)
{
  Table table{{"on the front", "ms", "± %", "RMSE", "relative MSE", "p99", "FLIP", "MiB", "gnomon render"}, {}};
  for (const FrontPoint &point : front(scene)) {
    const auto &[technique, picture] = point;
    table.rows.push_back(
        {name_of(*technique, *picture), fmt::format("{:.1f}", 1e3 * median(picture->seconds)),
         fmt::format("{:.1f}", 100.0 * spread(picture->seconds)), fmt::format("{:.5f}", picture->error.rmse),
         fmt::format("{:.3g}", picture->error.relative_mse), fmt::format("{:.4f}", picture->error.p99),
         fmt::format("{:.4f}", picture->error.flip), fmt::format("{:.1f}", double(technique->memory_bytes) / 0x1p20),
         fmt::format("{} --samples {}", technique->technique.options, picture->sample_count)});
  }
  return table;
}

Table technique_table(const SceneReport &scene)
{
  Table table{{"technique", "shadows ms", "sample ms", "MiB", "wrong %", "mean error %", "leak", "acne",
               "edge offset, texels", "95 %", "largest", "lost shadows", "non-finite", "RMSE at 1", "4", "16", "64"},
              {}};
  for (const TechniqueReport &one : scene.techniques) {
    const reference::VisibilityError e = all_lamps(one.lamps);
    const double shadows = step_seconds(one, "shadows");
    std::size_t non_finite = e.non_finite_count;
    for (const PictureReport &picture : one.pictures) {
      non_finite += picture.error.non_finite_count;
    }
    std::vector<std::string> row = {label(one.technique),
                                    fmt::format("{:.1f}", 1e3 * shadows),
                                    fmt::format("{:.1f}", 1e3 * (step_seconds(one, "") - shadows)),
                                    fmt::format("{:.1f}", double(one.memory_bytes) / 0x1p20),
                                    fmt::format("{:.4f}", 100.0 * e.wrong_fraction),
                                    fmt::format("{:.4f}", 100.0 * e.mean_absolute_error),
                                    std::to_string(e.leak_count),
                                    std::to_string(e.acne_count),
                                    fmt::format("{}", e.edge_offset_median),
                                    fmt::format("{}", e.edge_offset_p95),
                                    fmt::format("{}", e.edge_offset_max),
                                    std::to_string(one.lost_shadow_count),
                                    std::to_string(non_finite)};
    for (const int sample_count : {1, 4, 16, 64}) {
      const auto found = std::ranges::find(one.pictures, sample_count, &PictureReport::sample_count);
      row.push_back(found == one.pictures.end() ? "" : fmt::format("{:.5f}", found->error.rmse));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table lamp_table(const SceneReport &scene)
{
  Table table{{"technique", "lamp", "facing pixels", "wrong %", "mean error %", "leak", "acne", "edge offset, texels",
               "95 %", "largest"},
              {}};
  for (const TechniqueReport &one : scene.techniques) {
    for (const LampError &lamp : one.lamps) {
      const reference::VisibilityError &e = lamp.error;
      table.rows.push_back({label(one.technique), lamp.lamp, std::to_string(e.facing_count),
                            fmt::format("{:.4f}", 100.0 * e.wrong_fraction),
                            fmt::format("{:.4f}", 100.0 * e.mean_absolute_error), std::to_string(e.leak_count),
                            std::to_string(e.acne_count), fmt::format("{}", e.edge_offset_median),
                            fmt::format("{}", e.edge_offset_p95), fmt::format("{}", e.edge_offset_max)});
    }
  }
  return table;
}

Table convergence_table(const SceneReport &scene)
{
  Table table{{"technique", "order of wrong pixels in the size", "order of RMSE in the samples"}, {}};
  const auto order = [](const std::optional<double> &one) { return one ? fmt::format("{:.2f}", *one) : "–"; };
  for (const Convergence &one : convergence(scene)) {
    table.rows.push_back({one.technique, order(one.visibility_by_size), order(one.rmse_by_samples)});
  }
  return table;
}

Comparison front_pictures(const RunReport &run, const SceneReport &scene, const ReadPicture &read,
                          const MakePng &make_png)
{
  const std::vector<glm::vec4> reference = read(reference_file(scene));
  Comparison comparison{scene.name + ": pictures of the front, left and right of the pointer", {}};
  const auto add = [&](const std::string &name, const std::vector<glm::vec4> &pixels) {
    comparison.pictures.push_back({name, make_png(run.size_px, display_bytes(pixels))});
  };
  std::vector<std::pair<std::string, std::vector<glm::vec4>>> differences;
  for (const FrontPoint &point : front(scene)) {
    const std::string name = name_of(*point.technique, *point.picture);
    const std::vector<glm::vec4> pixels =
        read(picture_file(scene, point.technique->technique, point.picture->sample_count));
    add(name, pixels);
    if (comparison.pictures.size() == 1) {
      add("reference", reference);
    }
    differences.emplace_back(fmt::format("difference × {}: {}", difference_scale, name),
                             difference(pixels, reference, difference_scale));
  }
  for (const auto &[name, pixels] : differences) {
    add(name, pixels);
  }
  return comparison;
}

}  // namespace

std::string to_html(const RunReport &run, const ReadPicture &read, const MakePng &make_png)
{
  Page page("Gnomon: error against run time");
  page.paragraph(fmt::format("{} ({}), {}. {}, {}. {}x{} pixels, {} rounds, --specular {}, {:.0f} s in all.",
                             run.program, run.commit, run.date, run.machine, run.device, run.size_px.x, run.size_px.y,
                             run.rounds, specular_text(run), run.seconds));
  page.paragraph(
      "Each technique is measured once a round. Times are medians over the rounds, ± half the interquartile range. A "
      "picture's time runs from its first draw to its last pixel and includes drawing its shadows, but no compilation. "
      "RMSE, relative MSE, p99 and FLIP compare with ray tracing through the same pixel filter. Wrong: the visibility "
      "of a lamp at a pixel and the exact visibility are on different sides of one half. Leak and acne: wrong pixels "
      "without an edge of the exact shadow nearby.");
  for (const SceneReport &scene : run.scenes) {
    page.heading(scene.name);
    page.paragraph(fmt::format("{}. The reference's own noise is {:.5f} (RMSE); it took {:.0f} s.", scene.path.string(),
                               scene.reference_noise, scene.reference_seconds));
    if (!scene.world.empty()) {
      page.paragraph("World: " + scene.world);
    }
    for (const std::string &warning : scene.warnings) {
      page.paragraph("Warning: " + warning);
    }
    page.chart(error_against_time(scene));
    page.table(front_table(scene));
    page.compare(front_pictures(run, scene, read, make_png));
    page.chart(visibility_against_time(scene));
    page.table(convergence_table(scene));
    page.table(technique_table(scene));
    page.table(lamp_table(scene));
  }
  return page.html();
}

}  // namespace gnomon::measure
