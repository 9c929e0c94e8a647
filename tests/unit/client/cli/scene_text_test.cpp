#include "client/cli/scene_text.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace kinship::cli::scene_text_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TaskSpaceRegion unbounded() {
  TaskSpaceRegion region;
  region.bounds.row(0).setConstant(-kInfinity);
  region.bounds.row(1).setConstant(kInfinity);
  return region;
}

TEST(RegionText, NamesTheCoordinatesThatHaveABound) {
  TaskSpaceRegion region = unbounded();
  region.bounds.col(2) << 0.25, kInfinity;
  region.bounds.col(3) << -0.15, 0.15;
  region.bounds.col(4) << 0, 0;
  EXPECT_EQ(region_text(region),
            "stays within a task space region: z 0.25..inf m, roll -0.15..0.15 rad, pitch 0..0 "
            "rad");
}

TEST(RegionText, SaysThatNothingIsBounded) {
  EXPECT_EQ(region_text(unbounded()), "stays within a task space region without bounds");
}

TEST(PrintScene, HasALineForTheConstraintIfThereIsOne) {
  const auto printed = [](const RecordedScene& scene) {
    std::ostringstream out;
    print_scene(scene, out);
    return out.str();
  };
  RecordedScene scene;
  EXPECT_EQ(printed(scene), "scene       0 objects, 0 held\n");
  scene.constraint = unbounded();
  scene.constraint->bounds.col(5) << -1, 1;
  EXPECT_EQ(printed(scene),
            "scene       0 objects, 0 held\n"
            "constraint  stays within a task space region: yaw -1..1 rad\n");
}

}  // namespace
}  // namespace kinship::cli::scene_text_test
