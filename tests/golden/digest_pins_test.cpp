// The digests that identify robots, reports, paths, scenes and distributions.

#include <gtest/gtest.h>

#include "proto/types/profile_text.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/store/values/prepared_attempt.hpp"
#include "tests/golden/every_value.hpp"
#include "tests/golden/pins.hpp"
#include "tests/support/robots.hpp"

namespace kinship::digest_pins_test {
namespace {

TEST(DigestPins, Robots) {
  std::string lines;
  for (const char* const name :
       {"iiwa14", "iiwa14_lift", "iiwa7", "panda", "panda_lift", "planar_5r_a", "planar_5r_b",
        "planar_7r_c", "sara_like", "sawyer", "ur10e"})
    lines += std::string(name) + " " + test::model_chain(name).digest().hex() + "\n";
  test::expect_pinned("digest/robots.txt", lines);
}

void add_attempt(const std::string& name, const Attempt& attempt, std::string& lines) {
  const Result<store::PreparedAttempt> prepared = store::prepare(attempt);
  ASSERT_TRUE(prepared) << prepared.error().message;
  lines += name + " body " + prepared->body.hex() + "\n";
  if (prepared->path)
    lines += name + " path " + prepared->path->content.hex() + "\n";
  if (prepared->scene)
    lines += name + " scene " + prepared->scene->content.hex() + "\n";
}

TEST(DigestPins, Attempts) {
  std::string lines;
  Attempt unconstrained = test::every_attempt();
  unconstrained.scene->constraint.reset();
  add_attempt("attempt", unconstrained, lines);
  add_attempt("unsolved", test::every_unsolved_attempt(), lines);
  add_attempt("constrained", test::every_attempt(), lines);
  test::expect_pinned("digest/attempts.txt", lines);
}

/// One changed option each: the first of some values that is allowed.
std::vector<std::string> profiles() {
  std::vector<std::string> texts = {"default", "paper"};
  for (const std::string& option : profile_options())
    for (const char* const value : {"0.0625", "7", "0", "kde"})
      if (profile_from_text("default," + option + "=" + value)) {
        texts.push_back("default," + option + "=" + value);
        if (option != "take_over" && option != "estimator")
          break;
      }
  return texts;
}

TEST(DigestPins, Distributions) {
  std::string lines;
  const auto add = [&lines](const std::string& name, const FetchRequest& request) {
    const Result<fitting::DistributionKey> key = fitting::make_key(request);
    ASSERT_TRUE(key) << key.error().message;
    lines += name + " " + identify(*key).hex() + "\n";
  };
  FetchRequest request = test::every_fetch_request();
  for (const std::string& profile : profiles()) {
    request.profile = profile;
    add(profile, request);
  }
  request.profile = "default";
  request.T_task_base.reset();
  add("no placement", request);
  request.selection = {};
  add("no selection", request);
  request.selection.weighting = Weighting::Sources;
  add("weighting", request);
  test::expect_pinned("digest/distributions.txt", lines);
}

}  // namespace
}  // namespace kinship::digest_pins_test
