// What a server found by planning recorded queries again, in a fetch.

#include <gtest/gtest.h>

#include <limits>

#include "proto/codec/fetch_codec.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec::rehearsal_codec_test {
namespace {

Rehearsal found() {
  return {.guide = Guide::RetreatWays,
          .is_complete = true,
          .queries = 20,
          .left_out = 3,
          .processor_time_s = 4.5,
          .costs = {{Guide::None, 20, 18, 1500.5, 900, 0.004},
                    {Guide::RetreatWays, 20, 20, 400, 310, 0.001}},
          .message = "every query was planned"};
}

FetchReply reply_with(const Rehearsal& rehearsal) {
  FetchReply reply;
  reply.status = FetchStatus::Pending;
  reply.rehearsal = rehearsal;
  return reply;
}

std::string fault_of(const Rehearsal& rehearsal) {
  return encode({}, reply_with(rehearsal)).error().message;
}

TEST(RehearsalCodec, WaitingForItNeedsExperience) {
  FetchRequest request;
  request.task = "shelf_pick";
  request.rehearsed = true;
  EXPECT_EQ(encode({}, request).error().message, "rehearsed: without experience_bytes");
  request.experience_bytes = 1;
  auto message = encode({}, request).value_or_throw();
  EXPECT_TRUE(decode(message.wire).value_or_throw().rehearsed);
  message.wire.experience_bytes = 0;
  EXPECT_EQ(decode(message.wire).error().message, "rehearsed: without experience_bytes");
  message.wire.rehearsed = false;
  EXPECT_FALSE(decode(message.wire).value_or_throw().rehearsed);
}

TEST(RehearsalCodec, ItComesBackAndNoneIsNone) {
  auto message = encode({}, reply_with(found())).value_or_throw();
  EXPECT_EQ(decode(message.wire).value_or_throw().rehearsal, found());
  EXPECT_EQ(message.wire.rehearsal._buffer[0].guide, 3U) << "retreat 1 + ways 2";
  message.wire.rehearsal._buffer = nullptr;  // of an older server
  EXPECT_FALSE(decode(message.wire).value_or_throw().rehearsal);
  message = encode({}, reply_with({})).value_or_throw();
  EXPECT_EQ(decode(message.wire).value_or_throw().rehearsal, Rehearsal{});
}

TEST(RehearsalCodec, ThereAreSixteenGuides) {
  auto message = encode({}, reply_with(found())).value_or_throw();
  kinship_wire_Rehearsal& wire = message.wire.rehearsal._buffer[0];
  wire.guide = 16;
  EXPECT_EQ(decode(message.wire).error().message,
            "guide of a rehearsal: 16 is not between 0 and 15");
  wire.guide = 7;
  EXPECT_EQ(decode(message.wire).value_or_throw().rehearsal->guide, Guide::RetreatWaysMixture);
  wire.guide = 15;
  EXPECT_EQ(decode(message.wire).value_or_throw().rehearsal->guide, Guide::All);
  wire.costs._buffer[1].guide = 16;
  EXPECT_EQ(decode(message.wire).error().message,
            "guide of costs of a rehearsal: 16 is not between 0 and 15");
}

TEST(RehearsalCodec, NumbersMustBePossible) {
  Rehearsal rehearsal = found();
  rehearsal.processor_time_s = -1;
  EXPECT_EQ(fault_of(rehearsal), "processor_time_s of a rehearsal: -1 is negative");
  rehearsal = found();
  rehearsal.costs[1].mean_checks = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault_of(rehearsal), "mean_checks of costs of a rehearsal: nan is not finite");
  rehearsal = found();
  rehearsal.costs[0].solved = 21;
  EXPECT_EQ(fault_of(rehearsal), "rehearsal: none: 21 solved of 20");
  auto message = encode({}, reply_with(found())).value_or_throw();
  message.wire.rehearsal._buffer[0].costs._buffer[1].median_checks = -2;
  EXPECT_EQ(decode(message.wire).error().message,
            "median_checks of costs of a rehearsal: -2 is negative");
}

TEST(RehearsalCodec, ListsAndTextsAreBounded) {
  Rehearsal rehearsal = found();
  rehearsal.costs.resize(kMaxGuideCosts + 1);
  EXPECT_EQ(fault_of(rehearsal), "costs of a rehearsal: 17 exceeds 16");
  rehearsal = found();
  rehearsal.message = std::string(kMaxMessageBytes + 1, 'x');
  EXPECT_EQ(fault_of(rehearsal), "message of a rehearsal: 2049 bytes exceed 2048");
  auto message = encode({}, reply_with(found())).value_or_throw();
  message.wire.rehearsal._buffer[0].costs._length = 17;
  EXPECT_EQ(decode(message.wire).error().message, "costs of a rehearsal: 17 exceeds 16");
}

}  // namespace
}  // namespace kinship::codec::rehearsal_codec_test
