// What a server says and is told where a client asks for too much: when to come again, and how
// large a request is before it is read.

#include <gtest/gtest.h>

#include <string>

#include "proto/codec/admin_codec.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "proto/codec/request_size.hpp"
#include "tests/support/panda_experience.hpp"

namespace kinship::codec::busy_codec_test {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

template <typename Reply>
milliseconds comes_back(milliseconds time) {
  Reply reply;
  reply.retry_after = time;
  return decode(encode({}, reply).value_or_throw().wire).value_or_throw().retry_after;
}

TEST(BusyCodec, TheTimeToComeAgainComesBackAndIsAMinuteAtMost) {
  EXPECT_EQ(comes_back<RegisterReply>(milliseconds(1500)), milliseconds(1500));
  EXPECT_EQ(comes_back<ReportReply>(milliseconds(1500)), milliseconds(1500));
  EXPECT_EQ(comes_back<AdminReply>(milliseconds(1500)), milliseconds(1500));
  EXPECT_EQ(comes_back<ReportReply>(hours(10)), milliseconds(60'000));
  EXPECT_EQ(comes_back<AdminReply>(milliseconds(-3)), milliseconds(0));
  auto message = encode({}, ReportReply{}).value_or_throw();
  message.wire.retry_after_ms = 0xFFFFFFFF;  // whoever says so
  EXPECT_EQ(decode(message.wire)->retry_after, milliseconds(60'000));
  message.wire.message = nullptr;  // an older server
  message.wire.retry_after_ms = 0;
  EXPECT_EQ(decode(message.wire)->message, "");
}

TEST(BusyCodec, ARequestsSizeIsToldFromItsMessage) {
  ReportRequest report;
  EXPECT_EQ(size_of(encode({}, report).value_or_throw().wire).attempts, 0U);
  const std::size_t empty = size_of(encode({}, report).value_or_throw().wire).bytes;
  for (std::uint64_t i = 0; i < 3; ++i)
    report.attempts.push_back(test::panda_attempt(Digest{}, "sweep", i));
  const RequestSize three = size_of(encode({}, report).value_or_throw().wire);
  EXPECT_EQ(three.attempts, 3U);
  EXPECT_GE(three.bytes, empty + 3 * 7 * 4 * sizeof(double));
  EXPECT_LE(three.bytes, empty + 3 * 1000);

  RobotDescription robot;
  robot.label = "panda";
  robot.base_link = "base";
  robot.tip_link = "tip";
  robot.urdf = std::string(100'000, ' ');
  EXPECT_GE(size_of(encode({}, robot).value_or_throw().wire).bytes, 100'000U);
  FetchRequest fetch;
  fetch.task = "sweep";
  EXPECT_GT(size_of(encode({}, fetch).value_or_throw().wire).bytes, 0U);
  EXPECT_GT(size_of(encode({}, AdminRequest{}).value_or_throw().wire).bytes, 0U);
  // Whoever asks may send more than any rule allows: that is looked at later.
  std::string text(100'000, 'x');
  kinship_wire_FetchRequest long_fetch{};
  long_fetch.task = long_fetch.profile = text.data();
  EXPECT_GE(size_of(long_fetch).bytes, 2 * text.size());
  kinship_wire_AdminRequest long_admin{};
  long_admin.argument = long_admin.robot = long_admin.task = long_admin.cursor = text.data();
  EXPECT_GE(size_of(long_admin).bytes, 4 * text.size());
  EXPECT_EQ(size_of(kinship_wire_ReportRequest{}).attempts, 0U) << "a shorter message";
}

}  // namespace
}  // namespace kinship::codec::busy_codec_test
