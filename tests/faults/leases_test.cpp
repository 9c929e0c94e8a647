#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>

#include "proto/dds/publication.hpp"
#include "tests/faults/bystander.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test::leases_test {
namespace {

using std::chrono::seconds;

/// As many leases as the server keeps, of a day each, do not end another client's of a minute.
TEST(FleetLeases, OfOneClientDoNotEndAnothers) {
  const ReservedDomain domain;
  const TemporaryDirectory directory;
  ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  Bystander bystander(domain.number(), directory / "outbox");
  FetchRequest request;
  request.task = "sweep";
  request.robot = bystander.panda();
  request.follow = seconds(60);
  const Digest followed =
      bystander.client().fetch(request).value_or_throw().distribution.value().id;
  std::promise<void> announced;
  std::atomic<bool> is_announced = false;
  const dds::Participant participant({.domain = domain.number()});
  const dds::Subscriber<codec::AnnouncementPublication> announcements(
      participant,
      {.on_sample =
           [&](const Announcement& announcement) {
             if (announcement.distribution_id == followed && !is_announced.exchange(true))
               announced.set_value();
           },
       .on_server = {}});

  Program neighbour("../tests/faults_fleet",
                    {"neighbour", "long-leases", std::to_string(domain.number())},
                    directory / "neighbour.log");
  EXPECT_EQ(neighbour.read_line(), "ready");
  EXPECT_EQ(neighbour.read_line(), "done 4096");
  for (std::uint64_t i = 100; i < 120; ++i)
    bystander.client().report(panda_attempt(bystander.panda(), "sweep", i));
  EXPECT_EQ(announced.get_future().wait_for(seconds(40)), std::future_status::ready);
  EXPECT_EQ(server.terminate(), 0);
}

}  // namespace
}  // namespace kinship::test::leases_test
