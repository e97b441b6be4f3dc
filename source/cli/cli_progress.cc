// SPDX-License-Identifier: MIT
#include "cli_progress.hh"

#include "cli.hh"
#include "cli_system.hh"

namespace gnomon::cli {

Progress::Progress(bool has_lines, int picture_count, int sample_count)
    : has_lines_(has_lines),
      is_terminal_(stderr_is_terminal()),
      picture_count_(picture_count),
      sample_count_(sample_count)
{
  show_part(0.0);
}

void Progress::drawn(int picture, int samples_drawn)
{
  const bool is_last = samples_drawn == sample_count_;
  if (is_terminal_ && sample_count_ != 1) {
    print_message("\r\033[K");
    if (!is_last) {
      print_message("{}{} samples", samples_drawn, sample_count_ > 0 ? fmt::format("/{}", sample_count_) : "");
    }
  }
  // The last sample is counted when the picture is written.
  if (sample_count_ > 0 && !is_last) {
    show_part((picture + double(samples_drawn) / sample_count_) / picture_count_);
  }
}

void Progress::written(int picture, double seconds_left)
{
  if (is_terminal_ && picture_count_ > 1) {
    const bool is_last = picture + 1 == picture_count_;
    print_message("\r\033[Kpicture {}/{}, {:.0f} s left{}", picture + 1, picture_count_, seconds_left,
                  is_last ? "\r\033[K" : "");
  }
  show_part(double(picture + 1) / picture_count_);
}

void Progress::show_part(double part)
{
  const auto tenths = std::int64_t(part * 1000.0);
  if (has_lines_ && tenths > shown_) {
    shown_ = tenths;
    print_message("PROGRESS {}.{}%\n", tenths / 10, tenths % 10);
  }
}

}  // namespace gnomon::cli
