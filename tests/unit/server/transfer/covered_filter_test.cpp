#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "robots/geometry/fitted_shape.hpp"
#include "server/transfer/collision_filter.hpp"
#include "server/transfer/scene_filter.hpp"
#include "server/transfer/target_robot.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::transfer::covered_filter_test {
namespace {

constexpr std::uint64_t kSeed = 81;

/// A mesh of two legs along a link and across it: a solid around it has much air in it.
geometry::LinkShape bent_link(int link, double leg_m) {
  const Eigen::Matrix3Xd along = test::BoxMesh({0.4, 0.06, 0.06}).triangles(),
                         across = test::BoxMesh({0.06, leg_m, 0.06}).triangles();
  Eigen::Matrix3Xd corners(3, along.cols() + across.cols());
  corners << along, across;
  corners.colwise() += Eigen::Vector3d(-0.45, -0.03, -0.03);
  const geometry::FittedMesh fitted = geometry::fit_mesh(corners).value_or_throw();
  return {link, fitted.fitted.shape, fitted.fitted.T_points_shape, true, fitted.triangles};
}

/// The columns that a filter rejects.
std::vector<Eigen::Index> rejected(const ConfigurationFilter& filter, const Eigen::MatrixXd& qs) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index next = 0; next < qs.cols(); ++next) {
    next += filter(qs.rightCols(qs.cols() - next));
    if (next < qs.cols())
      columns.push_back(next);
  }
  return columns;
}

class CoveredFilter : public testing::Test {
 protected:
  CoveredFilter() {
    for (int link = 1; link <= kJoints; ++link)
      meshes_.shapes.push_back(bent_link(link, link % 2 == 0 ? 0.3 : 0.15));
    std::mt19937_64 generator(kSeed);
    for (Eigen::Index i = 0; i < qs_.cols(); ++i)
      qs_.col(i) = test::random_configuration(chain_, generator);
  }
  /// With boxes around the meshes that do not compare these links.
  geometry::RobotShapes boxes(std::vector<std::pair<int, int>> unfiltered) const {
    geometry::RobotShapes boxes = meshes_;
    for (geometry::LinkShape& shape : boxes.shapes)
      shape.triangles = nullptr;
    boxes.never_colliding = std::move(unfiltered);
    return boxes;
  }

  static constexpr int kJoints = 5;
  const kinematics::Chain chain_ = collision::test_support::toy_chain(kJoints);
  geometry::RobotShapes meshes_;
  Eigen::MatrixXd qs_ = Eigen::MatrixXd(kJoints, 3000);
};

TEST_F(CoveredFilter, AnswersAsTheMeshesDoAlsoForPairsThatTheSolidsDoNotCompare) {
  const std::vector<Eigen::Index> exact = rejected(self_filter(TargetRobot(chain_, meshes_)), qs_);
  EXPECT_GT(exact.size(), 100U);
  EXPECT_LT(exact.size(), 2900U);
  for (const auto& unfiltered : {std::vector<std::pair<int, int>>{{1, 3}, {2, 5}}, {{0, 5}}}) {
    const geometry::RobotShapes covers = boxes(unfiltered);
    const TargetRobot covered(chain_, meshes_, &covers);
    EXPECT_EQ(covered.covers->uncovered.has_value(), unfiltered.size() > 1);
    EXPECT_EQ(rejected(self_filter(covered), qs_), exact);
    if (unfiltered.size() > 1)
      EXPECT_NE(rejected(collision_filter(covered.covers->solids), qs_), exact)
          << "the solids alone are another filter";
  }
}

TEST_F(CoveredFilter, AnswersAsTheMeshesDoAmongObjects) {
  const RecordedScene scene{
      {{"wall", BoxShape{{0.05, 2, 2}}, Eigen::Isometry3d(Eigen::Translation3d(1.2, 0, 0))}},
      {{"can", SphereShape{0.05}}},
      {}};
  const geometry::RobotShapes covers = boxes({});
  const TargetRobot covered(chain_, meshes_, &covers);
  const Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  const auto exact = rejected(scene_filter(covered.solids, scene, base).keep, qs_);
  EXPECT_GT(exact.size(), 100U);
  EXPECT_EQ(rejected(scene_filter(covered.solids, scene, base, &covered.covers->solids).keep, qs_),
            exact);
}

}  // namespace
}  // namespace kinship::transfer::covered_filter_test
