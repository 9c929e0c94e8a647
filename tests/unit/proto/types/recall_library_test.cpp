#include "proto/types/recall_library.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "proto/types/limits.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::recall_library_test {
namespace {

constexpr std::uint64_t kSeed = 32;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Two anchors, two queries, three paths, two modes: 12 bits; three joints.
RecallLibrary library_of_three_paths() {
  test::RandomValues values(kSeed);
  RecallLibrary library;
  library.revision = 7;
  library.search_checks = 900;
  library.try_checks = 9;
  library.anchors = {"shelf", "table"};
  for (int i = 0; i < 2; ++i)
    library.queries.push_back({.report = Uuid::random(),
                               .start = values.matrix(3, 1),
                               .goal = values.matrix(3, 1),
                               .T_task_anchors = {values.pose(), values.pose()}});
  for (const std::uint32_t query : {0U, 1U, 1U})
    library.paths.push_back({query, values.matrix(3, kRecallWaypoints)});
  library.modes = {{0, kTaskFrame}, {2, kFirstAnchor + 1}};
  library.solves = {0b0010'0001, 0b1000};
  library.reaches = {0b0010'0011, 0b1010};
  return library;
}

TEST(RecallLibrary, OfTheServerIsValidAndSoIsNone) {
  EXPECT_FALSE(validate(library_of_three_paths()));
  RecallLibrary none;
  none.revision = 1;
  EXPECT_FALSE(validate(none));
  test::RandomValues values(kSeed);
  for (Eigen::Index dof = 1; dof <= static_cast<Eigen::Index>(kMaxDof); ++dof)
    EXPECT_FALSE(validate(values.recall_library(dof))) << dof;
}

TEST(RecallLibrary, BitsLieQueryByQueryAndPathByPath) {
  const RecallLibrary library = library_of_three_paths();
  std::vector<std::size_t> solved;
  for (std::size_t query = 0; query < 2; ++query)
    for (std::size_t path = 0; path < 3; ++path)
      for (std::size_t mode = 0; mode < 2; ++mode) {
        EXPECT_EQ(library.bit(query, path, mode), 6 * query + 2 * path + mode);
        if (bit_of(library.solves, library.bit(query, path, mode)))
          solved.push_back(library.bit(query, path, mode));
      }
  EXPECT_EQ(solved, (std::vector<std::size_t>{0, 5, 11}));
}

using Break = void (*)(RecallLibrary&);
struct Case {
  Break breaks;
  const char* message;
};

const std::vector<Case> kCases = {
    {[](auto& library) { library.revision = 0; }, "recall: revision 0"},
    {[](auto& library) { library.search_checks = -1; }, "recall: search_checks: -1 is negative"},
    {[](auto& library) { library.search_checks = kNan; },
     "recall: search_checks: nan is not finite"},
    {[](auto& library) { library.try_checks = -2; }, "recall: try_checks: -2 is negative"},
    {[](auto& library) { library.try_checks = kNan; }, "recall: try_checks: nan is not finite"},
    {[](auto& library) { library.anchors.resize(3, "box"); }, "recall: anchors: 3 exceeds 2"},
    {[](auto& library) { library.anchors[1] = ""; }, "recall: anchor: is empty"},
    {[](auto& library) { library.anchors[1] = std::string(129, 'a'); },
     "recall: anchor: 129 bytes exceed 128"},
    {[](auto& library) { library.queries.resize(257); }, "recall: queries: 257 exceeds 256"},
    {[](auto& library) { library.paths.resize(513); }, "recall: paths: 513 exceeds 512"},
    {[](auto& library) { library.modes.resize(17); }, "recall: modes: 17 exceeds 16"},
    {[](auto& library) { library.modes[1].blend = 3; },
     "recall: mode 1: blend: 3 is not between 0 and 2"},
    {[](auto& library) { library.modes[0].frame = 4; },
     "recall: mode 0: frame: 4 is not between 0 and 3"},
    {[](auto& library) { library.solves.pop_back(); }, "recall: solves: 1 bytes are not 2"},
    {[](auto& library) { library.solves.push_back(0); }, "recall: solves: 3 bytes are not 2"},
    {[](auto& library) { library.reaches.clear(); }, "recall: reaches: 0 bytes are not 2"},
    {[](auto& library) { library.reaches.push_back(0); }, "recall: reaches: 3 bytes are not 2"},
    {[](auto& library) { library.queries[0].start.resize(0); },
     "recall: query 0: dof: 0 is not between 1 and 32"},
    {[](auto& library) { library.queries[0].start = Eigen::VectorXd::Zero(33); },
     "recall: query 0: dof: 33 is not between 1 and 32"},
    {[](auto& library) { library.queries[1].start = Eigen::Vector2d(0, 1); },
     "recall: query 1: start: 2 joints are not 3"},
    {[](auto& library) { library.queries[1].goal = Eigen::Vector4d::Zero(); },
     "recall: query 1: goal: 4 joints are not 3"},
    {[](auto& library) { library.queries[1].start[2] = kNan; },
     "recall: query 1: start: not finite"},
    {[](auto& library) { library.queries[0].goal[0] = std::numeric_limits<double>::infinity(); },
     "recall: query 0: goal: not finite"},
    {[](auto& library) { library.queries[1].T_task_base.translation().x() = 1001; },
     "recall: query 1: T_task_base: pose: coordinate 1001 m exceeds 1000 m; these are probably "
     "millimetres"},
    {[](auto& library) { library.queries[1].T_task_anchors.pop_back(); },
     "recall: query 1: 1 poses of 2 anchors"},
    {[](auto& library) { library.queries[0].T_task_anchors[1].matrix()(0, 0) = kNan; },
     "recall: query 0: T_task_anchors: pose: number 4 of 7 is not finite"},
    {[](auto& library) { library.paths[2].query = 2; }, "recall: path 2: query 2 of 2"},
    {[](auto& library) { library.paths[1].waypoints.conservativeResize(2, Eigen::NoChange); },
     "recall: path 1: 2 x 32 waypoints are not 3 x 32"},
    {[](auto& library) { library.paths[1].waypoints.conservativeResize(Eigen::NoChange, 31); },
     "recall: path 1: 3 x 31 waypoints are not 3 x 32"},
    {[](auto& library) { library.paths[2].waypoints(2, 31) = kNan; },
     "recall: path 2: not finite as float"},
    {[](auto& library) { library.paths[0].waypoints(0, 0) = 1e300; },
     "recall: path 0: not finite as float"},
    {[](auto& library) { library.paths[0].waypoints(0, 0) = -10001; },
     "recall: path 0: a joint is beyond 10000"},
    {[](auto& library) { library.queries[1].goal[2] = 1e308; },
     "recall: query 1: goal: a joint is beyond 10000"}};

TEST(RecallLibrary, EachRuleIsNamedWhereItIsBroken) {
  for (const Case& each : kCases) {
    RecallLibrary library = library_of_three_paths();
    each.breaks(library);
    const auto error = validate(library);
    ASSERT_TRUE(error) << each.message;
    EXPECT_EQ(error->message, each.message);
  }
}

}  // namespace
}  // namespace kinship::recall_library_test
