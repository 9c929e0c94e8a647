// What somebody hears who sees every packet of a session of two clients with kinshipd.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "tests/integration/secured_site.hpp"
#include "tests/support/loopback_capture.hpp"

namespace kinship::eavesdropper_test {
namespace {

using namespace std::chrono_literals;
using Messages = std::vector<test::CapturedMessage>;
using test::Site;

constexpr const char* kTask = "shelf_of_the_secret_part";
constexpr const char* kPlanner = "a_planner_of_the_house";

/// The bytes of numbers, as they are in memory and on the wire.
std::string bytes_of(const Eigen::VectorXd& numbers) {
  std::string bytes(static_cast<std::size_t>(numbers.size()) * sizeof(double), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

/// What must not be heard, by name: several pieces of each, as messages are sent in pieces.
using Secrets = std::map<std::string, std::vector<std::string>>;

class KinshipdEavesdropper : public test::SecuredSite {
 protected:
  void SetUp() override {
    if (!capture_)
      GTEST_SKIP() << "this process may not capture packets";
  }

  /// Registers, reports, fetches; then a reader, in a process of its own, looks at all of it.
  /// \return what was sent of it that nobody else should know.
  Secrets hold_session(const Site& site, const std::filesystem::path& reader) const {
    const RobotDescription panda = test::model_description("panda");
    Secrets secrets = {
        {"label of the robot", {panda.label}}, {"task", {kTask}}, {"planner", {kPlanner}}};
    for (std::size_t at = 0; at + 64 < panda.urdf.size(); at += 512)
      secrets["URDF"].push_back(panda.urdf.substr(at, 32));
    for (std::uint64_t i = 0; i < 6; ++i) {
      Attempt attempt = test::panda_attempt(site.panda(), kTask, i);
      attempt.record.planner = kPlanner;
      site.client().report(attempt);
      for (const auto& waypoint : attempt.path->waypoints().colwise())
        secrets["waypoints"].push_back(bytes_of(waypoint.head(2)));
    }
    EXPECT_EQ(site.client().flush(30s).accepted, 6U);
    FetchRequest request;
    request.task = kTask;
    request.robot = site.panda();
    request.deadline = 30s;
    const FetchReply reply = site.client().fetch(request).value_or_throw();
    for (const auto& mean : reply.distribution->mixture->means().colwise())
      secrets["distribution"].push_back(bytes_of(mean.head(2)));
    EXPECT_EQ(site.kinship(reader, "robots show " + panda.label + " --json").code, 0);
    EXPECT_EQ(site.kinship(reader, "paths list --json").code, 0);
    return secrets;
  }

  const std::optional<test::LoopbackCapture> capture_ = test::LoopbackCapture::start();
};

bool has(const Messages& messages, const std::string& piece) {
  return std::ranges::any_of(messages, [&](const test::CapturedMessage& message) {
    return message.bytes.find(piece) != std::string::npos;
  });
}

TEST_F(KinshipdEavesdropper, HearsNamesOfClientsAndTopicsAndNothingElse) {
  {
    const Site site = open_site();
    const Secrets secrets = hold_session(site, {});
    const Messages sent = capture_->take();
    for (const auto& [what, pieces] : secrets)
      EXPECT_TRUE(std::ranges::any_of(pieces, [&](const auto& piece) { return has(sent, piece); }))
          << what << ": " << pieces.size() << " pieces";
  }
  const auto reader = add({.name = "rita", .role = AccessRole::Reader});
  capture_->take();
  const Site site = secured_site();
  const Secrets secrets = hold_session(site, reader);
  const Messages sent = capture_->take();
  for (const auto& [what, pieces] : secrets)
    for (const std::string& piece : pieces)
      EXPECT_FALSE(has(sent, piece)) << what;
  // Permissions and certificates travel in clear: docs/operations.md says so.
  for (const char* const known : {"client_anna", "client_rita", "kinship/report/request"})
    EXPECT_TRUE(has(sent, known)) << known;
}

}  // namespace
}  // namespace kinship::eavesdropper_test
