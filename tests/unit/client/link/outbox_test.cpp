#include "client/link/outbox.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "client/link/durable_file.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/store_epoch.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::outbox_test {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t kSeed = 35;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

void age(const fs::path& path, std::chrono::hours hours) {
  fs::last_write_time(path, fs::file_time_type::clock::now() - hours);
}

class OutboxTest : public testing::Test {
 protected:
  fs::path report_file(const char* part, const Attempt& attempt) const {
    return folder.path() / part / (attempt.report_uuid.text() + ".json");
  }

  test::TemporaryDirectory folder;
  test::RandomValues values{kSeed};
  Outbox outbox{folder.path()};
};

TEST_F(OutboxTest, KeepsAnAttemptForTheNextProcess) {
  Attempt attempt = values.attempt();
  attempt.T_task_base.reset();  // poses come back within rounding only
  outbox.add(attempt);
  const Outbox next(folder.path());
  ASSERT_EQ(next.pending(), std::vector{attempt.report_uuid});
  EXPECT_EQ(json::to_json(next.read(attempt.report_uuid).value_or_throw()), json::to_json(attempt));
}

TEST_F(OutboxTest, LeftOverTemporaryFilesAreIgnoredAndPurgedAfterADay) {
  const fs::path fresh = folder.path() / "pending" / "a.json.kinship-0123abcd.part";
  const fs::path old = folder.path() / "pending" / "b.json.kinship-4567cdef.part";
  write_text(fresh, "{");
  write_text(old, "{");
  age(old, std::chrono::hours(25));
  EXPECT_EQ(outbox.pending_count(), 0U);
  outbox.age(std::chrono::hours(0));
  EXPECT_TRUE(fs::exists(fresh));
  EXPECT_FALSE(fs::exists(old));
}

TEST_F(OutboxTest, OldestComesFirst) {
  const Attempt first = values.attempt();
  const Attempt second = values.attempt();
  const Attempt third = values.attempt();
  for (const Attempt* attempt : {&second, &third, &first})
    outbox.add(*attempt);
  age(report_file("pending", first), std::chrono::hours(3));
  age(report_file("pending", second), std::chrono::hours(2));
  EXPECT_EQ(outbox.pending(),
            (std::vector{first.report_uuid, second.report_uuid, third.report_uuid}));
}

TEST_F(OutboxTest, ReportsOfOneMomentStayInTheirOrder) {
  std::vector<Uuid> added;
  for (int i = 0; i < 100; ++i) {
    const Attempt attempt = values.attempt();
    outbox.add(attempt);
    added.push_back(attempt.report_uuid);
  }
  EXPECT_EQ(outbox.pending(), added);
}

TEST_F(OutboxTest, RejectedReportIsKeptWithItsReason) {
  const Attempt attempt = values.attempt();
  outbox.add(attempt);
  outbox.reject(attempt.report_uuid, "robot unknown");
  EXPECT_EQ(outbox.pending_count(), 0U);
  EXPECT_TRUE(fs::exists(report_file("rejected", attempt)));
  EXPECT_EQ(
      read_file(folder.path() / "rejected" / (attempt.report_uuid.text() + ".reason.txt"), 100),
      "robot unknown\n");
}

TEST_F(OutboxTest, DamagedFilesAreNamed) {
  const Attempt attempt = values.attempt();
  outbox.add(attempt);
  const fs::path path = report_file("pending", attempt);
  const std::string whole = read_file(path, 10'000'000);
  write_text(path, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(outbox.read(attempt.report_uuid).error().message.find("damaged file: "), 0U);
  const Uuid other = Uuid::random();
  write_text(folder.path() / "pending" / (other.text() + ".json"), whole);
  EXPECT_EQ(outbox.read(other).error().message,
            "damaged file: report_uuid is not that of its name");
  EXPECT_EQ(outbox.read(Uuid::random()).error().code, ErrorCode::NotFound);
}

TEST_F(OutboxTest, SentReportsAreKeptForSevenToFourteenDaysOfSending) {
  const auto day = std::chrono::hours(24);
  const Attempt first = values.attempt();
  const Attempt second = values.attempt();
  const auto send = [&](const Attempt& attempt) {
    outbox.add(attempt);
    outbox.mark_sent(attempt.report_uuid);
  };
  send(first);
  outbox.age(6 * day);
  send(second);
  outbox.age(day);
  EXPECT_TRUE(fs::exists(report_file("sent_before", first)));
  Outbox(folder.path()).age(7 * day - std::chrono::seconds(1));  // remembered across processes
  EXPECT_TRUE(fs::exists(report_file("sent_before", first)));
  EXPECT_TRUE(fs::exists(report_file("sent_before", second)));
  outbox.age(std::chrono::seconds(1));
  EXPECT_EQ(files_in(folder.path() / "sent_before"), 0U);
  EXPECT_EQ(files_in(folder.path() / "sent"), 0U);
}

TEST_F(OutboxTest, ClockThatJumpsByAYearDeletesNoSentReport) {
  constexpr auto kYear = std::chrono::hours(24 * 365);
  std::vector<Attempt> attempts;
  for (const auto jump : {-kYear, std::chrono::hours(0), kYear}) {
    for (const bool is_sent_before_the_jump : {true, false}) {
      const Attempt& attempt = attempts.emplace_back(values.attempt());
      outbox.add(attempt);
      if (is_sent_before_the_jump)
        outbox.mark_sent(attempt.report_uuid);
      // The clock was wrong by this when the file was written.
      age(report_file(is_sent_before_the_jump ? "sent" : "pending", attempt), jump);
      if (!is_sent_before_the_jump)
        outbox.mark_sent(attempt.report_uuid);
    }
  }
  for (int hour = 0; hour < 24 * 7 - 1; ++hour)
    Outbox(folder.path()).age(std::chrono::hours(1));
  for (const Attempt& attempt : attempts)
    EXPECT_TRUE(fs::exists(report_file("sent", attempt)));
}

TEST_F(OutboxTest, DamagedAgeKeepsWhatWasSentForLonger) {
  const Attempt attempt = values.attempt();
  outbox.add(attempt);
  outbox.mark_sent(attempt.report_uuid);
  outbox.age(std::chrono::hours(24 * 6));
  write_text(folder.path() / "sent_age_ms", "");
  outbox.age(std::chrono::hours(24 * 6));
  EXPECT_TRUE(fs::exists(report_file("sent", attempt)));
}

TEST_F(OutboxTest, FoldersThatAKilledProcessTookAwayAreMadeAnew) {
  const Attempt attempt = values.attempt();
  outbox.add(attempt);
  fs::rename(folder.path() / "sent", folder.path() / "sent_before" / "gone");
  outbox.age(std::chrono::hours(0));
  outbox.mark_sent(attempt.report_uuid);
  EXPECT_TRUE(fs::exists(report_file("sent", attempt)));
}

TEST_F(OutboxTest, ChangedStoreEpochOffersSentReportsAgain) {
  std::vector<Uuid> uuids;
  const Uuid epoch = Uuid::random();
  EXPECT_FALSE(outbox.has_receipts());
  EXPECT_FALSE(outbox.note_store(epoch, {}));
  EXPECT_TRUE(outbox.has_receipts());
  for (int i = 0; i < 2; ++i) {  // the first one is in sent_before by then
    const Attempt attempt = values.attempt();
    outbox.add(attempt);
    outbox.mark_sent(attempt.report_uuid);
    outbox.age(std::chrono::hours(24 * (7 - i)));
    uuids.push_back(attempt.report_uuid);
  }
  EXPECT_FALSE(outbox.note_store(epoch, {}));
  EXPECT_EQ(outbox.pending_count(), 0U);
  EXPECT_TRUE(Outbox(folder.path()).note_store(next_epoch(epoch), {}));  // across processes
  EXPECT_EQ(outbox.pending(), uuids);
}

TEST_F(OutboxTest, RemembersTheNewestMarkOfTheStore) {
  EXPECT_TRUE(outbox.known_token().empty());
  const Uuid epoch = Uuid::random();
  const ConsistencyToken first(40, 0xab), second(64, 0x01);
  outbox.note_store(epoch, first);
  EXPECT_EQ(Outbox(folder.path()).known_token(), first);
  outbox.note_store(epoch, {});  // from a server that gives none
  EXPECT_EQ(outbox.known_token(), first);
  outbox.note_store(epoch, second);
  EXPECT_EQ(outbox.known_token(), second);
  for (const char* const damaged : {"", "abc", "xyxy\n"}) {
    write_text(folder.path() / "consistency_token", damaged);
    EXPECT_TRUE(outbox.known_token().empty()) << damaged;
  }
}

TEST_F(OutboxTest, KeepsTheLatestDescriptionOfARobot) {
  const Digest robot = values.digest();
  EXPECT_EQ(outbox.robot(robot).error().code, ErrorCode::NotFound);
  RobotDescription description = values.robot_description();
  outbox.keep_robot(robot, description);
  description.label = "renamed";
  outbox.keep_robot(robot, description);
  const RobotDescription kept = Outbox(folder.path()).robot(robot).value_or_throw();
  EXPECT_EQ(kept.label, "renamed");
  EXPECT_EQ(kept.urdf, description.urdf);
  write_text(folder.path() / "robots" / (robot.hex() + ".json"), "{\"label\":");
  EXPECT_NE(outbox.robot(robot).error().message.find(robot.hex() + ".json: damaged file: "),
            std::string::npos);
}

TEST_F(OutboxTest, SolidsAroundMeshesAreKeptUntilAnotherUrdfComes) {
  const Digest robot = values.digest();
  RobotDescription description = values.robot_description();
  description.mesh_solids = {{{"arm", SphereShape{0.1}}}, {}};
  outbox.keep_robot(robot, description);
  description.mesh_solids = {};
  description.label = "renamed";
  outbox.keep_robot(robot, description);
  EXPECT_EQ(outbox.robot(robot)->mesh_solids.solids.size(), 1U);
  EXPECT_EQ(outbox.robot(robot)->label, "renamed");
  description.urdf += " ";
  outbox.keep_robot(robot, description);
  EXPECT_TRUE(outbox.robot(robot)->mesh_solids.solids.empty());
}

TEST_F(OutboxTest, MissingFolderIsReportedByName) {
  fs::remove_all(folder.path() / "pending");
  try {
    outbox.add(values.attempt());
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find("pending"), std::string::npos);
  }
}

TEST(DefaultOutboxFolder, FollowsTheXdgSpecification) {
  setenv("HOME", "/home/u", 1);
  setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(default_outbox_folder(0, "127.0.0.1"), "/state/kinship/outbox/domain-0@127.0.0.1");
  setenv("XDG_STATE_HOME", "relative", 1);
  EXPECT_EQ(default_outbox_folder(7, "a/b"), "/home/u/.local/state/kinship/outbox/domain-7@a_b");
  unsetenv("XDG_STATE_HOME");
  unsetenv("HOME");
  EXPECT_THROW(default_outbox_folder(0, "127.0.0.1"), Failure);
}

}  // namespace
}  // namespace kinship::link::outbox_test
