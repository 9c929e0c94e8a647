#include "robots/collision/fitted_links.hpp"

#include <gtest/gtest.h>

#include <random>

#include "robots/collision/collision_world.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/geometry/known_shapes.hpp"
#include "robots/geometry/mesh_cover.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::fitted_links_test {
namespace {

using test_support::toy_chain;

constexpr std::uint64_t kSeed = 10;

/// A mesh of two legs along a link and across it, so that a solid around it has much air in it.
geometry::LinkShape bent_link(int link, double leg_m) {
  const Eigen::Matrix3Xd along = test::BoxMesh({0.4, 0.06, 0.06}).triangles();
  Eigen::Matrix3Xd across = test::BoxMesh({0.06, leg_m, 0.06}).triangles();
  Eigen::Matrix3Xd corners(3, along.cols() + across.cols());
  corners << along, across;
  corners.colwise() += Eigen::Vector3d(-0.45, -0.03, -0.03);
  const geometry::FittedMesh fitted = geometry::fit_mesh(corners).value_or_throw();
  return {link, fitted.fitted.shape, fitted.fitted.T_points_shape, true, fitted.triangles};
}

geometry::RobotShapes bent_arm(int joints) {
  geometry::RobotShapes shapes;
  for (int link = 1; link <= joints; ++link)
    shapes.shapes.push_back(bent_link(link, link % 2 == 0 ? 0.3 : 0.15));
  return shapes;
}

/// As a server that cannot read the meshes has it.
geometry::RobotShapes as_known(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                               const FittedRobot& fitted) {
  geometry::RobotShapes known = with_solids(shapes, fitted.mesh_solids, chain);
  for (const auto& [first, second] : fitted.mesh_solids.unfiltered)
    known.never_colliding.emplace_back(
        std::minmax(chain.find_link(first), chain.find_link(second)));
  return known;
}

TEST(FittedLinks, SolidsAreNeverApartWhereTheMeshesTouch) {
  const kinematics::Chain chain = toy_chain(4);
  const geometry::RobotShapes meshes = bent_arm(4);
  const MeshSolids covered = geometry::cover_links(meshes, chain).value_or_throw();
  geometry::RobotShapes solids = with_solids(meshes, covered, chain);
  // So that neither leaves out what touches always.
  geometry::RobotShapes exact = meshes;
  exact.never_colliding = solids.never_colliding = {{0, 0}};
  Surroundings cell;
  cell.scene.objects = {{"wall", BoxShape{{0.05, 2, 2}}, test_support::shift(1.2)}};
  CollisionWorld of_meshes(chain, exact, cell), of_solids(chain, solids, cell);
  std::mt19937_64 generator(kSeed);
  int collisions = 0, lost = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const auto touching = of_meshes.find_contacts(q);
    const auto held = of_solids.find_contacts(q);
    for (const auto& names : touching)
      EXPECT_TRUE(held.contains(names)) << names.first << ", " << names.second;
    collisions += touching.empty() ? 0 : 1;
    lost += touching.empty() && !held.empty() ? 1 : 0;
  }
  EXPECT_GT(collisions, 500);
  EXPECT_LT(collisions, 2900);
  EXPECT_LT(lost, (3000 - collisions) / 4);
}

struct MeshAndSolids {
  Solid mesh;
  std::vector<std::pair<Solid, Eigen::Isometry3d>> solids;  ///< and where they are in the mesh
};

/// A few long triangles anywhere: what is left of them where a mesh is cut counts.
MeshAndSolids random_mesh(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const Eigen::Matrix3Xd corners =
      Eigen::Matrix3Xd::NullaryExpr(3, 3 * 6, [&] { return normal(generator); });
  MeshAndSolids both{Solid(BoxShape{Eigen::Vector3d::Constant(20)}, &corners), {}};
  for (const geometry::FittedShape& fitted : geometry::cover_mesh(corners))
    both.solids.emplace_back(Solid(fitted.shape), fitted.T_points_shape);
  return both;
}

TEST(FittedLinks, WhatTouchesAMeshTouchesOneOfItsSolids) {
  std::mt19937_64 generator(kSeed);
  const Eigen::Matrix3Xd box = test::BoxMesh({0.3, 0.3, 0.3}).triangles();
  const Solid other(BoxShape{{0.6, 0.6, 0.6}}, &box);
  int touches = 0, misses = 0, approximate = 0;
  for (int i = 0; i < 60; ++i) {
    const MeshAndSolids both = random_mesh(generator);
    for (int k = 0; k < 100; ++k) {
      const Eigen::Isometry3d T_other = test::random_pose(1.5, generator);
      const bool exact = touch(both.mesh, Eigen::Isometry3d::Identity(), other, T_other);
      const bool held = std::ranges::any_of(both.solids, [&](const auto& solid) {
        return touch(solid.first, solid.second, other, T_other);
      });
      EXPECT_TRUE(held || !exact) << i << ", " << k;
      touches += exact ? 1 : 0;
      approximate += held && !exact ? 1 : 0;
      misses += held ? 0 : 1;
    }
  }
  EXPECT_GT(touches, 200);
  EXPECT_GT(misses, 1000);
  EXPECT_GT(approximate, 0);
}

TEST(FittedLinks, TrianglesThatTravelledFindEverySelfCollision) {
  const kinematics::Chain chain = toy_chain(5);
  const geometry::RobotShapes meshes = bent_arm(5);
  geometry::RobotShapes travelled = meshes;
  for (geometry::LinkShape& shape : travelled.shapes) {
    const MeshContent content =
        TriangleMesh::from_corners(*shape.triangles).value_or_throw().content();
    const geometry::FittedMesh fitted =
        geometry::fit_mesh(TriangleMesh::read(content)->corners()).value_or_throw();
    shape.shape = fitted.fitted.shape;
    shape.T_link_shape = shape.T_link_shape * fitted.fitted.T_points_shape;
    shape.triangles = fitted.triangles;
  }
  const FittedRobot fitted = fit_robot(chain, meshes).value_or_throw();
  CollisionWorld exact(chain, meshes, {}), of_travelled(chain, travelled, {}),
      of_solids(chain, as_known(chain, meshes, fitted), {});
  std::mt19937_64 generator(kSeed);
  int colliding = 0, found = 0, found_by_solids = 0, lost = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const bool collides = exact.collides(q), seen = of_travelled.collides(q);
    colliding += collides ? 1 : 0;
    found += collides && seen ? 1 : 0;
    lost += !collides && seen ? 1 : 0;
    found_by_solids += collides && of_solids.collides(q) ? 1 : 0;
  }
  EXPECT_GT(colliding, 100);
  EXPECT_EQ(found, colliding);
  EXPECT_EQ(lost, 0);
  EXPECT_LE(found_by_solids, colliding);
}

TEST(FittedLinks, TheFilterLosesFewFreeConfigurationsAndFindsCollisions) {
  const kinematics::Chain chain = toy_chain(5);
  const geometry::RobotShapes meshes = bent_arm(5);
  const FittedRobot fitted = fit_robot(chain, meshes).value_or_throw();
  CollisionWorld exact(chain, meshes, {}), filter(chain, as_known(chain, meshes, fitted), {});
  std::mt19937_64 generator(kSeed);
  int free = 0, lost = 0, colliding = 0, found = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const bool left_out = filter.collides(q);
    ++(exact.collides(q) ? colliding : free);
    (exact.collides(q) ? found : lost) += left_out ? 1 : 0;
  }
  EXPECT_GT(free, 200);
  EXPECT_LT(lost, 0.08 * free) << "of which 5 % are allowed in other configurations";
  EXPECT_GT(found, colliding / 4);
}

TEST(FittedLinks, APairThatTouchesOnlyAsSolidsIsGivenUp) {
  // One solid around a frame that the second link goes through: a box full of air.
  const kinematics::Chain chain = toy_chain(3);
  geometry::RobotShapes meshes = bent_arm(3);
  geometry::RobotShapes solids = meshes;
  for (geometry::LinkShape& shape : solids.shapes)
    shape.triangles = nullptr;
  solids.shapes[0].shape = SphereShape{2};
  const FilterAgreement agreement = choose_filtered_pairs(chain, meshes, solids);
  EXPECT_NE(std::ranges::find(agreement.unfiltered, std::pair(1, 3)), agreement.unfiltered.end());
  EXPECT_LE(static_cast<double>(agreement.lost), 0.05 * static_cast<double>(agreement.free));
}

TEST(FittedLinks, ARobotWithoutMeshesNeedsNoSolids) {
  const FittedRobot fitted = fit_robot(toy_chain(3), test_support::toy_shapes(3)).value_or_throw();
  EXPECT_TRUE(fitted.mesh_solids.solids.empty());
  EXPECT_TRUE(fitted.mesh_solids.unfiltered.empty());
}

}  // namespace
}  // namespace kinship::collision::fitted_links_test
