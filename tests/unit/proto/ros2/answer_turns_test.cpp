#include "proto/ros2/answer_turns.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <string>

namespace {

thread_local bool has_no_memory = false;

}  // namespace

// Not inline: what a compiler sees of one half alone it takes for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  void* const memory = has_no_memory ? nullptr : std::malloc(bytes);  // NOLINT
  if (!memory)
    throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }  // NOLINT
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*bytes*/) noexcept {
  std::free(memory);  // NOLINT
}

namespace kinship::ros2 {
namespace {

using Turn = AnswerTurns::Turn;

AnswerTurns::Place place_of(const std::string& node, std::uint64_t number) {
  codec::Head head;
  head.sequence_number = number;
  return {node, head};
}

class AnswerTurnsTest : public testing::Test {
 protected:
  Turn answer(const AnswerTurns::Place& place, AnswerTurns::Answer answer = {}) {
    answer.bytes = answer.bytes == 0 ? 1 : answer.bytes;
    EXPECT_TRUE(turns_.begin(place));
    return turns_.take(place, answer, now_);
  }
  /// So many as may be sent at once.
  void use_up_rate(const std::string& node) {
    for (int i = 0; i < static_cast<int>(AnswerTurns::kRate.burst); ++i)
      EXPECT_EQ(answer(place_of(node, 0)), Turn::Now);
  }

  AnswerTurns turns_;
  AnswerTurns::TimePoint now_{std::chrono::hours(1)};
};

TEST_F(AnswerTurnsTest, AnswersBeyondTheRateOfTheirNodeAreSentInTurn) {
  use_up_rate("a");
  EXPECT_EQ(answer(place_of("a", 1)), Turn::Later);
  EXPECT_EQ(answer(place_of("a", 2)), Turn::Later);
  EXPECT_EQ(answer(place_of("b", 1)), Turn::Now);
  EXPECT_FALSE(turns_.begin(place_of("a", 1))) << "its answer waits";
  EXPECT_TRUE(turns_.due(now_).empty());
  now_ += std::chrono::milliseconds(11);
  EXPECT_EQ(turns_.due(now_).size(), 1U);
  EXPECT_TRUE(turns_.begin(place_of("a", 1)));
  EXPECT_FALSE(turns_.begin(place_of("a", 2)));
}

TEST_F(AnswerTurnsTest, AnAnswerForNowDoesNotWait) {
  use_up_rate("a");
  EXPECT_EQ(answer(place_of("a", 1), {.sample = {}, .may_wait = false}), Turn::Never);
  EXPECT_FALSE(turns_.holds_some());
  EXPECT_EQ(answer(place_of("a", 1)), Turn::Later) << "asked again, it is answered anew";
}

TEST_F(AnswerTurnsTest, AnswersOfParticipantsThatHaveGoneAreDropped) {
  use_up_rate("a");
  EXPECT_EQ(answer(place_of("a", 1), {.sample = {}, .participant = 1}), Turn::Later);
  EXPECT_EQ(answer(place_of("a", 2), {.sample = {}, .participant = 2}), Turn::Later);
  turns_.drop_if([](std::uint64_t participant) { return participant == 1; });
  EXPECT_TRUE(turns_.begin(place_of("a", 1)));
  EXPECT_FALSE(turns_.begin(place_of("a", 2)));
  turns_.drop_if([](std::uint64_t participant) { return participant == 2; });
  EXPECT_FALSE(turns_.holds_some());
}

TEST_F(AnswerTurnsTest, NumberAndBytesOfAnswersThatWaitAreBounded) {
  use_up_rate("a");
  for (std::uint64_t i = 0; i < AnswerTurns::kMaxHeldOfNode; ++i)
    EXPECT_EQ(answer(place_of("a", i)), Turn::Later);
  EXPECT_EQ(answer(place_of("a", AnswerTurns::kMaxHeldOfNode)), Turn::Never);
  use_up_rate("b");
  EXPECT_EQ(answer(place_of("b", 1), {.sample = {}, .bytes = AnswerTurns::kMaxHeldBytes}),
            Turn::Never);
  EXPECT_EQ(answer(place_of("b", 1), {.sample = {}, .bytes = AnswerTurns::kMaxHeldBytes / 2}),
            Turn::Later);
  EXPECT_EQ(answer(place_of("b", 2), {.sample = {}, .bytes = AnswerTurns::kMaxHeldBytes / 2}),
            Turn::Never);
}

TEST_F(AnswerTurnsTest, AQuestionEndsForWhoseAnswerThereIsNoMemory) {
  const AnswerTurns::Place place = place_of("a", 1);
  ASSERT_TRUE(turns_.begin(place));
  bool is_thrown = false;
  has_no_memory = true;
  try {
    static_cast<void>(turns_.take(place, {}, now_));
  } catch (const std::bad_alloc&) {
    is_thrown = true;
  }
  has_no_memory = false;
  EXPECT_TRUE(is_thrown);
  EXPECT_TRUE(turns_.begin(place)) << "sent again, it is handled anew";
}

}  // namespace
}  // namespace kinship::ros2
