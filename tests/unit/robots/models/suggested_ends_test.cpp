#include "robots/models/suggested_ends.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::models::suggested_ends_test {
namespace {

std::filesystem::path urdf_of(const std::string& model) {
  return std::filesystem::path(test::source_dir()) / "robots/models" / model / "robot.urdf";
}

TEST(SuggestedEnds, OfEachArmThatComesAlongAreOnesThatMoveAllItsJoints) {
  for (const std::string model : {"panda", "ur10e", "iiwa14", "sawyer"}) {
    RobotArguments arguments{.source = urdf_of(model)};
    const LinksOfFile links = complete_ends(arguments).value_or_throw();
    EXPECT_TRUE(links.is_suggested);
    ASSERT_FALSE(links.ends.empty()) << model;
    EXPECT_GE(links.ends[0].joints, 6U) << model;
    const std::string tip = describe_robot({.source = urdf_of(model).parent_path()})
                                .value_or_throw()
                                .description.tip_link;
    EXPECT_NE(std::ranges::find(links.ends[0].tips, tip), links.ends[0].tips.end())
        << model << ": " << tip << " is not among the tips";
  }
}

TEST(SuggestedEnds, WhatIsGivenStays) {
  RobotArguments arguments{.source = urdf_of("panda"), .base_link = "panda_link1"};
  ASSERT_TRUE(complete_ends(arguments));
  EXPECT_EQ(arguments.base_link, "panda_link1");
  EXPECT_FALSE(arguments.tip_link.empty());
  RobotArguments folder{.source = urdf_of("panda").parent_path()};
  EXPECT_FALSE(complete_ends(folder).value_or_throw().is_suggested);
  EXPECT_TRUE(folder.base_link.empty());
}

TEST(SuggestedEnds, AFileThatIsNotThereIsNamed) {
  RobotArguments arguments{.source = "/nowhere/arm.urdf"};
  const auto links = complete_ends(arguments);
  ASSERT_FALSE(links);
  EXPECT_NE(links.error().message.find("/nowhere/arm.urdf"), std::string::npos);
}

}  // namespace
}  // namespace kinship::models::suggested_ends_test
