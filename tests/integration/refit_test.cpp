// A distribution that is fitted again and again by kinshipd as a process, which is killed between.

#include <gtest/gtest.h>

#include <memory>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::refit_test {
namespace {

using std::chrono::seconds;

/// A Panda that reports its own sweeps and asks for what was made of them.
class Refit : public testing::Test {
 protected:
  Refit() {
    start();
    panda_ = client_.register_robot(test::model_description("panda")).value_or_throw().robot;
  }

  void start() {
    server_.reset();
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = folder_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  }
  void report(int paths) {
    std::vector<Attempt> attempts;
    for (int i = 0; i < paths; ++i)
      attempts.push_back(test::panda_attempt(panda_, "sweep", next_seed_++));
    for (const Receipt& receipt : client_.deliver(attempts).value_or_throw())
      ASSERT_EQ(receipt.status, ReceiptStatus::Stored) << receipt.message;
  }
  Distribution fetch(std::uint64_t generation) {
    FetchRequest request;
    request.task = "sweep";
    request.robot = panda_;
    request.profile = "default,components=3,pose_spacing=1";
    request.minimum_generation = generation;
    request.deadline = seconds(120);
    return client_.fetch(request).value_or_throw().distribution.value();
  }
  /// Of a generation that nothing of before has.
  Distribution next(const Distribution& before) { return fetch(before.sources[0].generation + 1); }

  std::string explained(const Digest& id) {
    return test::run_to_end("kinship",
                            {"--domain", std::to_string(domain_.number()), "--timeout", "60",
                             "distributions", "explain", "--distribution", id.hex()})
        .out;
  }

  const test::ReservedDomain domain_;
  const test::TemporaryDirectory folder_;
  std::unique_ptr<test::ServerProcess> server_;
  link::Client client_{
      {.domain = domain_.number(), .outbox = {}, .has_outbox = false, .timeout = seconds(60)}};
  Digest panda_;
  std::uint64_t next_seed_ = 1;
};

TEST_F(Refit, AServerThatWasKilledServesWhatItHadAndFitsFully) {
  report(10);
  const Distribution first = fetch(0);
  EXPECT_EQ(first.fit, (FitOrigin{0, 0, 10, 10, 10, "no earlier one in memory"}));
  report(5);
  const Distribution second = next(first);
  EXPECT_EQ(second.fit, (FitOrigin{1, 1, 15, 5, 5, ""}));
  const std::string text = explained(second.id);
  EXPECT_NE(text.find("fit           incremental from revision 1, 5 of 15 paths new\n"),
            std::string::npos)
      << text;

  server_->kill();
  start();
  const Distribution served = fetch(0);
  EXPECT_EQ(served.revision, 2U);
  EXPECT_EQ(served.fit, second.fit);
  ASSERT_TRUE(served.mixture && second.mixture);
  EXPECT_EQ(served.mixture->means(), second.mixture->means());
  report(1);
  const Distribution third = next(served);
  EXPECT_EQ(third.revision, 3U);
  EXPECT_EQ(third.fit, (FitOrigin{0, 0, 16, 16, 16, "no earlier one in memory"}));
  ASSERT_TRUE(third.mixture);
  const std::string last = explained(third.id);
  EXPECT_NE(last.find("fit           full (no earlier one in memory), 16 paths\n"),
            std::string::npos)
      << last;
}

}  // namespace
}  // namespace kinship::refit_test
