// SPDX-License-Identifier: MIT
#include "trace.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

namespace gnomon::trace {
namespace {

TEST(Trace, RecordsNothingBeforeItsStart)
{
  {
    const Span span("early");
  }
  start();
  EXPECT_TRUE(events().empty());
}

TEST(Trace, ASpanThatBeganBeforeTheStartIsNotRecorded)
{
  start();
  {
    const Span span("old");
    start();
    // Longer than from the first start to the span.
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (const Event &event : events()) {
    EXPECT_NE(event.name, "old");
  }
}

TEST(Trace, InnerSpansLieWithinOuterOnes)
{
  start();
  {
    const Span outer("outer");
    const Span inner("inner", std::string("of ") + "a file");
  }
  const std::vector<Event> all = events();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].name, "inner");
  EXPECT_EQ(all[0].detail, "of a file");
  EXPECT_EQ(all[1].name, "outer");
  EXPECT_GE(all[1].start_s, 0.0);
  EXPECT_GE(all[0].start_s, all[1].start_s);
  EXPECT_LE(all[0].start_s + all[0].duration_s, all[1].start_s + all[1].duration_s);
  EXPECT_EQ(all[0].thread, all[1].thread);
}

TEST(Trace, ThreadsHaveNumbersOfTheirOwn)
{
  start();
  constexpr int count = 4;
  constexpr int span_count = 200;
  std::vector<std::thread> threads;
  for (int i = 0; i < count; i++) {
    threads.emplace_back([] {
      for (int span = 0; span < span_count; span++) {
        const Span work("work");
      }
    });
  }
  for (std::thread &thread : threads) {
    thread.join();
  }
  const std::vector<Event> all = events();
  ASSERT_EQ(all.size(), std::size_t(count) * span_count);
  std::set<int> numbers;
  for (const Event &event : all) {
    numbers.insert(event.thread);
  }
  EXPECT_EQ(numbers.size(), std::size_t(count));
}

TEST(Trace, ProcessTimeGrowsWithWork)
{
  const double before = process_seconds();
  volatile double sum = 0.0;
  for (int i = 0; i < 1000000; i++) {
    sum = sum + double(i);
  }
  EXPECT_GT(process_seconds(), before);
}

}  // namespace
}  // namespace gnomon::trace
