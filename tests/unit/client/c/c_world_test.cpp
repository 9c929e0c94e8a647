// Worlds of the C library: edges that are proven, what they are refused with, and in which words.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "client/c/kinship.h"
#include "proto/types/pose.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/places.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

extern "C" int a_proof_is_asked_for_in_c(kinship_world* world, const double* q, size_t dof);

namespace kinship::c_world_test {
namespace {

constexpr size_t kDof = 7;
constexpr double kTurn = 0.525;  // to both sides: steps of 0.05 look at -0.025 and 0.025
using Configuration = std::array<double, kDof>;

Configuration turned(double base_rad) { return {base_rad, 0.5, 0, -1.5, 0, 2, 0.785}; }

void expect_refused(kinship_code code, const std::string& text) {
  EXPECT_EQ(code, KINSHIP_INVALID_INPUT);
  EXPECT_NE(std::string(kinship_error_text()).find(text), std::string::npos)
      << "no '" << text << "' in: " << kinship_error_text();
}

/// A Panda that holds a thin rod, and a plate of paper where the rod's end passes.
class CWorld : public testing::Test {
 protected:
  CWorld() {
    file_.size = sizeof file_;
    file_.source = folder_.c_str();
    objects_[0] = {sizeof(kinship_object), "rod", KINSHIP_CYLINDER, 1, {0.003, 0.4, 0},
                   {0, 0, 0.2, 0, 0, 0, 1}};
    objects_[1] = {sizeof(kinship_object), "plate", KINSHIP_BOX, 0, {0.05, 0.0002, 0.05},
                   {0, 0, 0, 0, 0, 0, 1}};
    Eigen::Isometry3d T_base_end = kinematics::T_base_transfer(
        test::model_chain("panda"), Eigen::Map<const Eigen::VectorXd>(turned(0).data(), kDof));
    T_base_end.translation() += T_base_end.linear() * Eigen::Vector3d(0, 0, 0.38);
    for (Eigen::Index i = 0; i < 3; ++i)
      objects_[1].pose[i] = T_base_end.translation()[i];
    surroundings_.size = sizeof surroundings_;
    surroundings_.objects = objects_;
    surroundings_.object_count = 2;
    proof_.size = sizeof proof_;
  }
  void TearDown() override { kinship_world_free(world_); }

  void make_world() {
    size_t dof = 0;
    ASSERT_EQ(kinship_world_create(&file_, &surroundings_, &world_, &dof), KINSHIP_OK)
        << kinship_error_text();
    EXPECT_EQ(dof, kDof);
  }
  kinship_code prove(const Configuration& from, const Configuration& to,
                     double clearance_m = KINSHIP_CLEARANCE_M) {
    return kinship_world_edge_free(world_, from.data(), to.data(), kDof, clearance_m, &proof_);
  }

  const std::string folder_ = test::source_dir() + "/robots/models/panda";
  kinship_robot_file file_{};
  kinship_object objects_[2]{};
  kinship_surroundings surroundings_{};
  kinship_world* world_ = nullptr;
  kinship_proof proof_{};
};

TEST_F(CWorld, AnEdgeThroughAPlateIsRefusedThatStepsMiss) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  EXPECT_STREQ(kinship_world_warning(world_), "");
  for (double base_rad = -kTurn; base_rad < kTurn + 1e-9; base_rad += 0.05) {
    int is_free = 0;
    ASSERT_EQ(kinship_world_is_free(world_, turned(base_rad).data(), kDof, &is_free), KINSHIP_OK);
    EXPECT_EQ(is_free, 1) << base_rad;
  }
  ASSERT_EQ(prove(turned(-kTurn), turned(kTurn)), KINSHIP_OK) << kinship_error_text();
  ASSERT_EQ(proof_.is_free, 0);
  EXPECT_NEAR(proof_.share, 0.5, 0.01);
  const std::string first = proof_.first, second = proof_.second;
  EXPECT_EQ(std::minmax(first, second), std::minmax<std::string>("plate", "rod"));
  EXPECT_LE(proof_.clearance_m, KINSHIP_CLEARANCE_M);
  EXPECT_EQ(proof_.least_clearance_m, proof_.clearance_m);
  EXPECT_EQ(proof_.edge, 0U);
  int is_free = 1;
  EXPECT_EQ(kinship_world_is_free(world_, turned(0).data(), kDof, &is_free), KINSHIP_OK);
  EXPECT_EQ(is_free, 0);
}

TEST_F(CWorld, AnEdgeBesideThePlateIsFree) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  ASSERT_EQ(prove(turned(0.1), turned(kTurn)), KINSHIP_OK) << kinship_error_text();
  EXPECT_EQ(proof_.is_free, 1);
  EXPECT_EQ(proof_.first, nullptr);
  EXPECT_EQ(proof_.second, nullptr);
  EXPECT_GT(proof_.least_clearance_m, KINSHIP_CLEARANCE_M);
  EXPECT_EQ(proof_.size, sizeof proof_);
}

TEST_F(CWorld, NamesStayUntilTheWorldIsFreed) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  ASSERT_EQ(prove(turned(-kTurn), turned(kTurn)), KINSHIP_OK);
  ASSERT_EQ(proof_.is_free, 0);
  const kinship_proof before = proof_;
  const std::string name = before.first;
  ASSERT_EQ(prove(turned(kTurn), turned(0.1)), KINSHIP_OK);
  ASSERT_EQ(prove(turned(kTurn), turned(-kTurn)), KINSHIP_OK);
  EXPECT_EQ(before.first, name);
}

TEST_F(CWorld, OfAPathTheFirstEdgeThatIsNotFreeIsTold) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  std::vector<double> waypoints;
  const auto add = [&](const Configuration& q) {
    waypoints.insert(waypoints.end(), q.begin(), q.end());
  };
  for (int i = 0; i < 50; ++i) {  // more edges than are asked about at once
    add(turned(0.1));
    add(turned(kTurn));
  }
  const auto prove_path = [&] {
    return kinship_world_path_free(world_, waypoints.data(), waypoints.size() / kDof, kDof,
                                   KINSHIP_CLEARANCE_M, &proof_);
  };
  ASSERT_EQ(prove_path(), KINSHIP_OK) << kinship_error_text();
  EXPECT_EQ(proof_.is_free, 1);
  add(turned(-kTurn));
  add(turned(kTurn));
  ASSERT_EQ(prove_path(), KINSHIP_OK) << kinship_error_text();
  EXPECT_EQ(proof_.is_free, 0);
  EXPECT_EQ(proof_.edge, 99U);
}

TEST_F(CWorld, FarFromEverythingNoClearanceIsMeasured) {
  surroundings_.object_count = 0;
  ASSERT_NO_FATAL_FAILURE(make_world());
  ASSERT_EQ(prove(turned(0), turned(0)), KINSHIP_OK) << kinship_error_text();
  EXPECT_EQ(proof_.is_free, 1);
  EXPECT_EQ(proof_.least_clearance_m, std::numeric_limits<double>::infinity());
}

TEST_F(CWorld, WhatMayTouchAndWhereTheBaseStandsCount) {
  const char* const allowed[] = {"rod", "plate"};
  surroundings_.allowed_collisions = allowed;
  surroundings_.allowed_collision_pairs = 1;
  ASSERT_NO_FATAL_FAILURE(make_world());
  ASSERT_EQ(prove(turned(-kTurn), turned(kTurn)), KINSHIP_OK);
  EXPECT_EQ(proof_.is_free, 1);
  kinship_world_free(world_);
  surroundings_.allowed_collision_pairs = 0;
  const double T_task_base[7] = {0, 0, 1, 0, 0, 0, 1};
  surroundings_.T_task_base = T_task_base;
  ASSERT_NO_FATAL_FAILURE(make_world());
  ASSERT_EQ(prove(turned(-kTurn), turned(kTurn)), KINSHIP_OK);
  EXPECT_EQ(proof_.is_free, 1);
}

TEST_F(CWorld, WithoutSurroundingsARobotCanTouchOnlyItself) {
  ASSERT_EQ(kinship_world_create(&file_, nullptr, &world_, nullptr), KINSHIP_OK)
      << kinship_error_text();
  ASSERT_EQ(prove(turned(-kTurn), turned(kTurn)), KINSHIP_OK);
  EXPECT_EQ(proof_.is_free, 1);
  Configuration folded = turned(0);
  folded[1] = 1.7;
  folded[3] = -3;
  ASSERT_EQ(prove(turned(0), folded), KINSHIP_OK);
  ASSERT_EQ(proof_.is_free, 0);
  EXPECT_EQ(std::string(proof_.first).substr(0, 6), "panda_");
}

TEST_F(CWorld, WhatIsNoEdgeIsRefusedWithNameValueAndLimit) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  const Configuration q = turned(0.1);
  expect_refused(prove(q, q, 0), "clearance_m is 0 m, must be from 1e-05 to 0.1 m");
  expect_refused(prove(q, q, 0.2), "clearance_m is 0.2 m, must be from 1e-05 to 0.1 m");
  expect_refused(prove(q, q, std::nan("")), "clearance_m is nan");
  Configuration no_number = q;
  no_number[3] = std::numeric_limits<double>::infinity();
  expect_refused(prove(q, no_number), "to[3] is inf, must be finite");
  expect_refused(prove(no_number, q), "from[3] is inf, must be finite");
  Configuration far = q;
  far[0] = 1e300;
  expect_refused(prove(q, far), "may move by");
  int is_free = 0;
  expect_refused(kinship_world_is_free(world_, no_number.data(), kDof, &is_free), "q[3] is inf");
  expect_refused(kinship_world_is_free(world_, q.data(), 6, &is_free), "dof is 6, must be 7");
  expect_refused(kinship_world_is_free(world_, q.data(), kDof, nullptr), "is_free is NULL");
  expect_refused(kinship_world_path_free(world_, q.data(), 1, kDof, 0.001, &proof_),
                 "count is 1, must be 2 to ");
  expect_refused(kinship_world_path_free(world_, nullptr, 2, kDof, 0.001, &proof_),
                 "waypoints is NULL");
  expect_refused(kinship_world_edge_free(world_, q.data(), nullptr, kDof, 0.001, &proof_),
                 "to is NULL");
  expect_refused(kinship_world_edge_free(world_, q.data(), q.data(), kDof, 0.001, nullptr),
                 "proof is NULL");
  expect_refused(kinship_world_edge_free(nullptr, q.data(), q.data(), kDof, 0.001, &proof_),
                 "world is NULL");
  proof_.size = 0;
  expect_refused(prove(q, q), "proof: its size is 0");
}

TEST_F(CWorld, WhatIsNoWorldIsRefused) {
  expect_refused(kinship_world_create(nullptr, nullptr, &world_, nullptr), "file is NULL");
  expect_refused(kinship_world_create(&file_, nullptr, nullptr, nullptr), "world is NULL");
  const char* const allowed[] = {"rod", "saucer"};
  surroundings_.allowed_collisions = allowed;
  surroundings_.allowed_collision_pairs = 1;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr), "'saucer'");
  EXPECT_EQ(world_, nullptr);
  surroundings_.allowed_collision_pairs = 0;
  objects_[1].sizes[1] = -1;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr),
                 "object 'plate': box extent of -1 m is not between 0 and 1000 m");
  kinship_object twice[2] = {objects_[0], objects_[0]};
  twice[0].is_held = twice[1].is_held = 0;
  surroundings_.objects = twice;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr),
                 "object 'rod': two in surroundings->objects have this name");
  surroundings_.objects = objects_;
  objects_[1].name = nullptr;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr),
                 "a name in surroundings->objects is NULL");
  surroundings_.objects = nullptr;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr),
                 "surroundings->objects is NULL");
  EXPECT_STREQ(kinship_world_warning(nullptr), "");
  kinship_world_free(nullptr);
}

TEST_F(CWorld, ObstaclesOutOfReachAreWarnedOf) {
  objects_[1].pose[0] = 700;  // mm
  ASSERT_NO_FATAL_FAILURE(make_world());
  EXPECT_EQ(std::string(kinship_world_warning(world_)).find("'plate' is "), 0U)
      << kinship_world_warning(world_);
}

TEST_F(CWorld, LinksThatAreDrawnOnlyNeedAWord) {
  const test::TemporaryDirectory directory;
  const std::string source = (directory / "arm.urdf").string();
  std::ofstream(source)
      << "<robot name='arm'><link name='base'/><link name='tool'><visual><geometry><box "
         "size='0.1 0.1 0.1'/></geometry></visual></link><joint name='j' type='revolute'><parent "
         "link='base'/><child link='tool'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' "
         "effort='1' velocity='1'/></joint></robot>";
  file_.source = source.c_str();
  file_.base_link = "base";
  file_.tip_link = "tool";
  surroundings_.object_count = 0;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr), "'tool'");
  const char* const names[] = {"tool", nullptr};
  file_.without_collision = names;
  file_.without_collision_count = 2;
  expect_refused(kinship_world_create(&file_, &surroundings_, &world_, nullptr),
                 "a text in file->without_collision is NULL");
  file_.without_collision_count = 1;
  EXPECT_EQ(kinship_world_create(&file_, &surroundings_, &world_, nullptr), KINSHIP_OK)
      << kinship_error_text();
  kinship_world_free(world_);
  file_.without_collision_count = 0;
  file_.collision_from_visual = 1;
  ASSERT_EQ(kinship_world_create(&file_, &surroundings_, &world_, nullptr), KINSHIP_OK)
      << kinship_error_text();
}

TEST_F(CWorld, MeshesKeepTheirTriangles) {
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "box.stl") << test::BoxMesh({0.1, 0.1, 0.1}).text_stl();
  const std::string source = (directory / "arm.urdf").string();
  std::ofstream(source)
      << "<robot name='arm'><link name='base'/><link name='tool'><collision><origin xyz='0.5 0 "
         "0'/><geometry><mesh filename='box.stl'/></geometry></collision></link><joint name='j' "
         "type='revolute'><parent link='base'/><child link='tool'/><axis xyz='0 0 1'/><limit "
         "lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  file_.source = source.c_str();
  file_.base_link = "base";
  file_.tip_link = "tool";
  surroundings_.objects = objects_ + 1;
  surroundings_.object_count = 1;
  std::ranges::copy(std::array{0.5, 0.0, 0.0}, objects_[1].pose);
  size_t dof = 0;
  ASSERT_EQ(kinship_world_create(&file_, &surroundings_, &world_, &dof), KINSHIP_OK)
      << kinship_error_text();
  EXPECT_EQ(dof, 1U);
  const double from = -1, to = 1;
  ASSERT_EQ(kinship_world_edge_free(world_, &from, &to, 1, 0.001, &proof_), KINSHIP_OK)
      << kinship_error_text();
  EXPECT_EQ(proof_.is_free, 0);
  EXPECT_LT(proof_.share, 0.5);
}

TEST_F(CWorld, ThreadsMayShareOne) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([this] {
      for (int times = 0; times < 20; ++times) {
        kinship_proof proof{};
        proof.size = sizeof proof;
        EXPECT_EQ(kinship_world_edge_free(world_, turned(-kTurn).data(), turned(kTurn).data(), kDof,
                                          KINSHIP_CLEARANCE_M, &proof),
                  KINSHIP_OK);
        EXPECT_EQ(proof.is_free, 0);
      }
    });
  for (std::thread& thread : threads)
    thread.join();
}

TEST_F(CWorld, IsAskedInC) {
  ASSERT_NO_FATAL_FAILURE(make_world());
  EXPECT_EQ(a_proof_is_asked_for_in_c(world_, turned(0.1).data(), kDof), 1);
  EXPECT_EQ(a_proof_is_asked_for_in_c(world_, turned(0).data(), kDof), 0);
}

}  // namespace
}  // namespace kinship::c_world_test
