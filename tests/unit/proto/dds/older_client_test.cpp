// Messages that are shorter than the server's, from a client of an older contract.

#include <gtest/gtest.h>

#include <chrono>
#include <optional>

#include "proto/dds/replier.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"

namespace kinship::dds::older_client_test {
namespace {

TEST(OlderClient, AttemptWithoutARecordIsRefusedByName) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number(), .role = Role::Server});
  WaitLoop loop(participant);
  std::optional<ReportRequest> received;
  const Replier<codec::ReportConversation> replier(
      participant, loop,
      [&](const ReportRequest& request, const Answer<codec::ReportConversation>& answer) {
        received = request;
        answer({});
        loop.stop();
      });
  const test::ChildProcess client({KINSHIP_OLDER_CLIENT, std::to_string(domain.number()),
                                   cyclone_configuration({.domain = domain.number()})});
  const auto end = WaitLoop::Clock::now() + std::chrono::seconds(30);
  loop.run([&] {
    if (WaitLoop::Clock::now() >= end)
      loop.stop();
    return end;
  });
  ASSERT_TRUE(received) << "nothing came";
  EXPECT_TRUE(received->attempts.empty());
  ASSERT_EQ(received->refused.size(), 1U);
  EXPECT_EQ(received->refused[0].report_uuid.bytes[0], 7);
  EXPECT_EQ(received->refused[0].message, "record: is missing");
}

}  // namespace
}  // namespace kinship::dds::older_client_test
