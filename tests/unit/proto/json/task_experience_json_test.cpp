#include "proto/json/task_experience_json.hpp"

#include <gtest/gtest.h>

namespace kinship::json::task_experience_json_test {
namespace {

TEST(TaskExperienceJson, HasPathsWithTheirPosesAndARevisionThatNoReaderRounds) {
  TaskExperience experience;
  experience.revision = 0xfedcba9876543210;
  experience.paths_known = 9;
  PosePath path;
  path.source.bytes.fill(0xab);
  path.path = Uuid::parse("00112233-4455-6677-8899-aabbccddeeff").value();
  path.poses = {Eigen::Isometry3d::Identity(), Eigen::Isometry3d(Eigen::Translation3d(1, 2.5, -3))};
  experience.paths = {path};
  EXPECT_EQ(to_json(experience),
            R"({"revision":"fedcba9876543210","paths_known":9,"paths":[)"
            R"({"path":"00112233-4455-6677-8899-aabbccddeeff","source":")" +
                path.source.hex() +
                R"(","poses":[[0.0,0.0,0.0,0.0,0.0,0.0,1.0],[1.0,2.5,-3.0,0.0,0.0,0.0,1.0]]}]})");
  EXPECT_EQ(to_json(TaskExperience{.revision = 1, .paths_known = 0, .paths = {}}),
            R"({"revision":"0000000000000001","paths_known":0,"paths":[]})");
}

}  // namespace
}  // namespace kinship::json::task_experience_json_test
