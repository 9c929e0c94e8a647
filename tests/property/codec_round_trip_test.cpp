// Decoding what was encoded gives the same value.

#include <gtest/gtest.h>

#include "proto/codec/admin_codec.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/publication_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/event_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::codec_round_trip_test {
namespace {

constexpr std::uint64_t kSeed = 31;
constexpr int kCases = 200;
constexpr double kPoseTolerance = 1e-12;
const Head kHead{Uuid{}, 7};

/// Poses pass as quaternions and come back within rounding; after this check they are made equal,
/// so that the rest can be compared exactly, as JSON.
void expect_same_pose(const std::optional<Eigen::Isometry3d>& written,
                      std::optional<Eigen::Isometry3d>& read) {
  ASSERT_EQ(read.has_value(), written.has_value());
  if (!written)
    return;
  EXPECT_TRUE(read->isApprox(*written, kPoseTolerance));
  read = written;
}

/// The same for the poses of a scene; its content says whether they are the same.
void expect_same_scene(const std::optional<RecordedScene>& written,
                       std::optional<RecordedScene>& read) {
  ASSERT_EQ(read.has_value(), written.has_value());
  if (!written)
    return;
  EXPECT_EQ(content_digest(*read), content_digest(*written));
  ASSERT_EQ(read->objects.size(), written->objects.size());
  for (std::size_t i = 0; i < written->objects.size(); ++i)
    read->objects[i].T_task_object = written->objects[i].T_task_object;
  ASSERT_EQ(read->held.size(), written->held.size());
  for (std::size_t i = 0; i < written->held.size(); ++i)
    read->held[i].T_transfer_object = written->held[i].T_transfer_object;
  ASSERT_EQ(read->constraint.has_value(), written->constraint.has_value());
  if (!written->constraint)
    return;
  EXPECT_EQ(read->constraint->bounds, written->constraint->bounds);
  read->constraint = written->constraint;
}

TEST(CodecRoundTrip, BatchOfAttemptsComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    ReportRequest written;
    for (int n = values.below(10); n > 0; --n) {
      Attempt& attempt = written.attempts.emplace_back(values.attempt());
      if (values.coin())
        attempt.scene = values.recorded_scene();
      if (values.coin())
        attempt.search = values.search_record(attempt.path ? attempt.path->dof() : 7);
    }
    const auto message = encode(kHead, written);
    ASSERT_TRUE(message) << message.error().message;
    EXPECT_EQ(head_of(message->wire), kHead);
    auto read = decode(message->wire).value_or_throw();
    ASSERT_EQ(read.attempts.size(), written.attempts.size());
    EXPECT_TRUE(read.refused.empty());
    for (std::size_t n = 0; n < written.attempts.size(); ++n) {
      expect_same_pose(written.attempts[n].T_task_base, read.attempts[n].T_task_base);
      expect_same_scene(written.attempts[n].scene, read.attempts[n].scene);
      if (written.attempts[n].search) {
        ASSERT_TRUE(read.attempts[n].search);
        expect_same_pose(written.attempts[n].search->T_task_goal,
                         read.attempts[n].search->T_task_goal);
      }
      EXPECT_EQ(json::to_json(read.attempts[n]), json::to_json(written.attempts[n]));
    }
  }
}

TEST(CodecRoundTrip, SceneComesBackFromAFileWithTheSameContent) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    Attempt written = values.attempt(3);
    written.scene = values.recorded_scene();
    const auto read = json::attempt_from_json(json::to_json(written)).value_or_throw().attempt;
    ASSERT_TRUE(read.scene);
    EXPECT_EQ(content_digest(*read.scene), content_digest(*written.scene));
    EXPECT_EQ(scene_bytes(*read.scene), scene_bytes(*written.scene));
  }
}

TEST(CodecRoundTrip, SearchRecordComesBackFromAFileAsItWas) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    Attempt written = values.attempt(3);
    written.search = values.search_record(written.path ? written.path->dof() : 7);
    written.T_task_base.reset();
    written.search->T_task_goal.reset();  // poses come back within rounding
    const std::string text = json::to_json(written);
    const auto read = json::attempt_from_json(text).value_or_throw().attempt;
    EXPECT_EQ(json::to_json(read), text);
    EXPECT_EQ(search_bytes(*read.search), search_bytes(*written.search));
  }
}

TEST(CodecRoundTrip, RobotDescriptionComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const RobotDescription written = values.robot_description();
    auto read = decode(encode(kHead, written).value_or_throw().wire).value_or_throw();
    EXPECT_TRUE(read.T_tip_transfer.isApprox(written.T_tip_transfer, kPoseTolerance));
    read.T_tip_transfer = written.T_tip_transfer;
    ASSERT_EQ(read.meshes.size(), written.meshes.size());
    for (std::size_t mesh = 0; mesh < read.meshes.size(); ++mesh) {
      Eigen::Isometry3d& T_link_mesh = read.meshes[mesh].T_link_mesh;
      EXPECT_TRUE(T_link_mesh.isApprox(written.meshes[mesh].T_link_mesh, kPoseTolerance));
      T_link_mesh = written.meshes[mesh].T_link_mesh;
    }
    EXPECT_EQ(json::to_json(read), json::to_json(written));
  }
}

TEST(CodecRoundTrip, DistributionComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    FetchReply written;
    written.distribution = values.distribution();
    written.status =
        has_mixture(written.distribution->state) ? FetchStatus::Ready : FetchStatus::Failed;
    if (values.coin())
      written.rehearsal = values.rehearsal();
    const auto message = encode(kHead, written);
    ASSERT_TRUE(message) << message.error().message;
    auto read = decode(message->wire).value_or_throw();
    EXPECT_EQ(read.status, written.status);
    EXPECT_EQ(read.rehearsal, written.rehearsal);
    expect_same_pose(written.distribution->T_task_base, read.distribution->T_task_base);
    EXPECT_EQ(json::to_json(*read.distribution), json::to_json(*written.distribution));
  }
}

TEST(CodecRoundTrip, FetchRequestComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    FetchRequest written;
    written.task = values.name(128);
    written.robot = values.digest();
    written.profile = values.name(256);
    written.minimum_generation = values.count();
    written.deadline = std::chrono::milliseconds(values.below(3'600'001));
    written.selection = values.selection();
    written.follow = std::chrono::seconds(values.below(86'401));
    written.experience_bytes = static_cast<std::uint32_t>(1 + values.below(kMaxExperienceBytes));
    written.rehearsed = values.coin();
    written.known_recall = values.count();
    if (values.coin())
      written.T_task_goal = values.pose();
    written.to_configuration = values.coin();
    const auto read = decode(encode(kHead, written).value_or_throw().wire).value_or_throw();
    EXPECT_EQ(read.selection, written.selection);
    EXPECT_EQ(read.follow, written.follow);
    EXPECT_EQ(read.rehearsed, written.rehearsed);
    EXPECT_EQ(read.known_recall, written.known_recall);
    EXPECT_EQ(read.to_configuration, written.to_configuration);
    ASSERT_EQ(read.T_task_goal.has_value(), written.T_task_goal.has_value());
    if (read.T_task_goal)
      EXPECT_TRUE(read.T_task_goal->isApprox(*written.T_task_goal, 1e-12));
    EXPECT_EQ(read.deadline, written.deadline);
    EXPECT_EQ(read.task + read.profile, written.task + written.profile);
    EXPECT_EQ(read.minimum_generation, written.minimum_generation);
  }
}

TEST(CodecRoundTrip, PublicationsComeBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const Announcement written = values.announcement();
    const auto read = decode(encode(written).value_or_throw().wire).value_or_throw();
    EXPECT_EQ(read.distribution_id, written.distribution_id);
    EXPECT_EQ(read.task, written.task);
    EXPECT_EQ(read.robot, written.robot);
    EXPECT_EQ(read.revision, written.revision);
    EXPECT_EQ(read.store_epoch, written.store_epoch);
    const Event event = values.event();
    EXPECT_EQ(json::to_json(decode(encode(event).value_or_throw().wire).value_or_throw()),
              json::to_json(event));
  }
}

}  // namespace
}  // namespace kinship::codec::codec_round_trip_test
