#include "client/link/mesh_upload.hpp"

#include <gtest/gtest.h>

#include <map>

#include "client/link/outbox.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/store_epoch.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::mesh_upload_test {
namespace {

constexpr std::uint64_t kSeed = 37;

TriangleMesh mesh_of(double size_m) {
  Eigen::Matrix3Xd corners(3, 3);
  corners << 0, size_m, 0, 0, 0, size_m, 0, 0, 0;
  return TriangleMesh::from_corners(corners).value_or_throw();
}

/// With 100 meshes of a triangle each.
RobotDescription robot() {
  RobotDescription description;
  description.label = "r";
  description.urdf = "<robot/>";
  description.base_link = "a";
  description.tip_link = "b";
  for (int i = 1; i <= 100; ++i) {
    description.meshes.push_back(
        {"a", MeshRole::Both, Eigen::Isometry3d::Identity(), {}, 0, mesh_of(i).digest()});
    description.contents.push_back(mesh_of(i).content());
  }
  return description;
}

/// A server that has what it was sent.
class Server {
 public:
  bool takes_meshes = true, has_room = true;
  int requests = 0;
  std::size_t most_contents = 0;
  std::map<Digest, MeshContent> contents;

  Result<RegisterReply> answer(const RobotDescription& asked) {
    most_contents = std::max(most_contents, asked.contents.size());
    if (has_room)
      for (const MeshContent& content : asked.contents)
        contents.emplace(TriangleMesh::read(content)->digest(), content);
    RegisterReply reply;
    reply.status = requests++ == 0 ? RegisterStatus::Registered : RegisterStatus::Known;
    if (takes_meshes)
      for (const LinkMesh& mesh : asked.meshes)
        if (!contents.contains(mesh.content))
          reply.wanted.push_back({mesh.content});
    return reply;
  }
};

FindContent all_of(const RobotDescription& description) {
  std::map<Digest, MeshContent> contents;
  for (const MeshContent& content : description.contents)
    contents.emplace(TriangleMesh::read(content)->digest(), content);
  return [contents](const Digest& digest) {
    const auto found = contents.find(digest);
    return found == contents.end() ? std::nullopt : std::optional(found->second);
  };
}

Result<RegisterReply> upload(Server& server, const RobotDescription& description,
                             const FindContent& find) {
  return register_with_meshes(description, find,
                              [&](const RobotDescription& part) { return server.answer(part); });
}

TEST(MeshUpload, SendsWhatIsWantedInMessagesThatHoldIt) {
  Server server;
  const Result<RegisterReply> reply = upload(server, robot(), all_of(robot()));
  EXPECT_TRUE(reply->wanted.empty());
  EXPECT_EQ(reply->status, RegisterStatus::Registered) << "as the first request";
  EXPECT_EQ(server.contents.size(), 100U);
  EXPECT_EQ(server.most_contents, kMaxContentsARequest);
  EXPECT_EQ(server.requests, 3);
  EXPECT_TRUE(upload(server, robot(), all_of(robot())));
  EXPECT_EQ(server.requests, 4) << "nothing is wanted any more";
}

TEST(MeshUpload, AServerThatKnowsOfNoMeshesGetsNone) {
  Server server;
  server.takes_meshes = false;
  EXPECT_TRUE(upload(server, robot(), all_of(robot())));
  EXPECT_EQ(server.requests, 1);
  EXPECT_EQ(server.most_contents, 0U);
}

TEST(MeshUpload, EndsWhereItDoesNotGetOn) {
  Server full;
  full.has_room = false;
  EXPECT_EQ(upload(full, robot(), all_of(robot()))->wanted.size(), 100U);
  EXPECT_EQ(full.requests, 2);
  Server server;
  EXPECT_EQ(upload(server, robot(), [](const Digest&) { return std::nullopt; })->wanted.size(),
            100U);
  EXPECT_EQ(server.requests, 1);
  RobotDescription wordy = robot();
  wordy.urdf.assign(kMaxUrdfBytes, ' ');  // leaves no room for a content
  EXPECT_EQ(upload(server, wordy, all_of(robot()))->wanted.size(), 100U);
}

TEST(MeshUpload, ARobotIsRegisteredAlsoIfItsMeshesDoNotGetThrough) {
  Server server;
  const RobotDescription described = robot();
  const Result<RegisterReply> reply =
      register_with_meshes(described, all_of(described), [&](const RobotDescription& part) {
        return part.contents.empty() ? server.answer(part)
                                     : Result<RegisterReply>(Error{ErrorCode::Unavailable, "gone"});
      });
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, RegisterStatus::Registered);
  EXPECT_EQ(reply->wanted.size(), 100U);
}

TEST(MeshOutbox, KeepsContentsUntilAServerHasThem) {
  const test::TemporaryDirectory directory;
  const RobotDescription described = robot();
  Digest digest;
  digest.bytes[0] = 1;
  {
    Outbox outbox(directory.path());
    outbox.keep_robot(digest, described);
    RobotDescription without = described;  // of a client without the meshes
    without.meshes.clear();
    without.contents.clear();
    outbox.keep_robot(digest, without);
  }
  Outbox outbox(directory.path());  // after a crash
  const RobotDescription kept = outbox.robot(digest).value_or_throw();
  EXPECT_EQ(kept.meshes.size(), 100U);
  EXPECT_TRUE(kept.contents.empty());
  EXPECT_EQ(outbox.robots_with_contents(), std::vector<Digest>{digest});
  Server server;
  EXPECT_TRUE(upload(server, kept, [&](const Digest& each) {
                return outbox.content(each);
              })->wanted.empty());
  outbox.drop_contents(kept);
  EXPECT_FALSE(outbox.content(mesh_of(1).digest()));
  EXPECT_TRUE(outbox.robots_with_contents().empty());
}

TEST(MeshOutbox, ForgetsMeshesThatAreToStayHere) {
  const test::TemporaryDirectory directory;
  Outbox outbox(directory.path());
  Digest digest;
  digest.bytes[0] = 1;
  outbox.keep_robot(digest, robot());
  outbox.forget_meshes(digest);
  EXPECT_TRUE(outbox.robot(digest)->meshes.empty());
  EXPECT_FALSE(outbox.content(mesh_of(1).digest()));
  RobotDescription without = robot();
  without.meshes.clear();
  without.contents.clear();
  outbox.keep_robot(digest, without);
  EXPECT_TRUE(outbox.robot(digest)->meshes.empty());
}

/// Keeps a robot with one mesh.
void keep(Outbox& outbox, const Digest& digest, double size_m) {
  RobotDescription description = robot();
  description.meshes.resize(1);
  description.meshes.front().content = mesh_of(size_m).digest();
  description.contents = {mesh_of(size_m).content()};
  outbox.keep_robot(digest, description);
}

TEST(MeshOutbox, AContentThatAnotherRobotNamesStays) {
  const test::TemporaryDirectory directory;
  Outbox outbox(directory.path());
  outbox.note_store(next_epoch({}), {});
  test::RandomValues values(kSeed);
  const Attempt attempt = values.attempt(5);
  const Digest twin = values.digest(), other = values.digest(), third = values.digest();
  keep(outbox, attempt.robot, 1);
  keep(outbox, twin, 1);
  outbox.forget_meshes(twin);
  EXPECT_TRUE(outbox.content(mesh_of(1).digest()));
  EXPECT_EQ(outbox.robots_with_contents(), std::vector<Digest>{attempt.robot});

  keep(outbox, twin, 1);
  keep(outbox, other, 2);
  keep(outbox, third, 2);
  outbox.add(attempt);
  outbox.note_store(next_epoch({}), {});  // a store never seen
  EXPECT_TRUE(outbox.content(mesh_of(1).digest())) << "of a robot with a report";
  EXPECT_FALSE(outbox.content(mesh_of(2).digest())) << "of two robots without";
}

TEST(MeshOutbox, AStoreNeverSeenGetsContentsOfRobotsWithReportsAlone) {
  const test::TemporaryDirectory directory;
  Outbox outbox(directory.path());
  outbox.note_store(next_epoch({}), {});
  test::RandomValues values(kSeed);
  const Attempt attempt = values.attempt(5);
  keep(outbox, attempt.robot, 1);
  keep(outbox, values.digest(), 2);
  outbox.add(attempt);
  outbox.note_store(next_epoch({}), {});
  EXPECT_EQ(outbox.robots_with_contents(), std::vector<Digest>{attempt.robot});
}

}  // namespace
}  // namespace kinship::link::mesh_upload_test
