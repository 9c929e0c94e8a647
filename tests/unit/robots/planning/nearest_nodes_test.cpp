#include "robots/planning/nearest_nodes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "robots/planning/nearest_scan.hpp"
#include "robots/planning/tree.hpp"

namespace kinship::planning::nearest_nodes_test {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr Eigen::Index kMany = 1'000'000;  // so many may be scanned: no boxes are made

/// Configurations as a planner makes them: in steps from one of those there are, some a second
/// time.
class Growth {
 public:
  explicit Growth(Eigen::Index dof) : dof_(dof), nodes_(1, Eigen::VectorXd::Zero(dof)) {}

  const std::vector<Eigen::VectorXd>& nodes() const { return nodes_; }
  Eigen::VectorXd anywhere() {
    return Eigen::VectorXd::NullaryExpr(dof_, [&] { return joint_(generator_); });
  }
  Eigen::VectorXd known() { return nodes_[generator_() % nodes_.size()]; }
  const Eigen::VectorXd& next() {
    const bool repeats = generator_() % 5 == 0;
    const bool goes_on = generator_() % 8 != 0;
    if (!goes_on)
      direction_ = anywhere().normalized();
    const Eigen::VectorXd from = goes_on ? nodes_.back() : known();
    nodes_.push_back(repeats ? known() : Eigen::VectorXd(from + 0.05 * direction_));
    return nodes_.back();
  }

 private:
  Eigen::Index dof_;
  std::mt19937_64 generator_{kSeed};
  std::uniform_real_distribution<double> joint_{-3, 3};
  std::vector<Eigen::VectorXd> nodes_;
  Eigen::VectorXd direction_ = Eigen::VectorXd::Unit(dof_, 0);
};

/// The first of the nearest, in single precision as the class says.
Eigen::Index nearest_of(const std::vector<Eigen::VectorXd>& nodes, const Eigen::VectorXd& q) {
  const Eigen::ArrayXf wanted = q.cast<float>();
  const auto squared = [&](const Eigen::VectorXd& node) {
    float sum = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const float difference = static_cast<float>(node[i]) - wanted[i];
      sum += difference * difference;
    }
    return sum;
  };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (squared(nodes[i]) < squared(nodes[nearest]))
      nearest = i;
  return static_cast<Eigen::Index>(nearest);
}

/// One of those there are, each again after some time.
std::size_t growth_index(int i, std::size_t count) {
  return static_cast<std::size_t>(i) * 7 % count;
}

TEST(NearestNodes, BoxesAndScanFindTheFirstOfTheNearest) {
  for (const Eigen::Index dof : {1, 2, 5, 7}) {
    Growth growth(dof);
    NearestNodes scan(dof, kMany), boxes(dof, 60), at_once(dof, 1);
    for (int i = 0; i < 3000; ++i) {
      const Eigen::VectorXd q = i == 0 ? growth.nodes().front() : growth.next();
      scan.add(q);
      boxes.add(q);
      at_once.add(q);
      if (i % 7 != 0)
        continue;
      // What is known lies at distance 0, often more than once.
      for (const Eigen::VectorXd& wanted : {growth.anywhere(), growth.known()}) {
        const Eigen::Index nearest = nearest_of(growth.nodes(), wanted);
        ASSERT_EQ(scan.find(wanted), nearest) << "dof " << dof << ", " << i;
        ASSERT_EQ(boxes.find(wanted), nearest) << "dof " << dof << ", " << i;
        ASSERT_EQ(at_once.find(wanted), nearest) << "dof " << dof << ", " << i;
      }
    }
  }
}

TEST(NearestNodes, WhatIsKnownOfTheFirstOnesIsBroughtUpToDate) {
  Growth growth(6);
  NearestNodes scan(6, kMany), boxes(6, 60);
  std::vector<Eigen::VectorXd> wanted;
  std::vector<NearestNode> in_scan, in_boxes;
  for (int i = 0; i < 1500; ++i) {
    const Eigen::VectorXd q = i == 0 ? growth.nodes().front() : growth.next();
    scan.add(q);
    boxes.add(q);
    if (i % 50 == 0) {
      wanted.push_back(i % 100 == 0 ? growth.anywhere() : growth.known());
      in_scan.emplace_back();
      in_boxes.emplace_back();
    }
    const std::size_t one = growth_index(i, wanted.size());
    scan.update(wanted[one], in_scan[one]);
    boxes.update(wanted[one], in_boxes[one]);
    const Eigen::Index nearest = nearest_of(growth.nodes(), wanted[one]);
    ASSERT_EQ(in_scan[one].index, nearest) << i;
    ASSERT_EQ(in_boxes[one].index, nearest) << i;
    ASSERT_EQ(in_boxes[one].squared, in_scan[one].squared) << i;
    ASSERT_EQ(in_boxes[one].looked_at, i + 1);
  }
}

TEST(NearestNodes, EveryInstructionSetFindsTheSame) {
  std::vector<NearestScan> scans = {scan_nearest_sse2};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2"))
    scans.push_back(scan_nearest_avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    scans.push_back(scan_nearest_avx512);
#endif
  Growth growth(7);
  Eigen::ArrayXXf nodes =
      Eigen::ArrayXXf::Constant(1008, 7, std::numeric_limits<float>::infinity());
  for (Eigen::Index i = 0; i < 1000; ++i)
    nodes.row(i) = growth.next().cast<float>().transpose().array();
  for (int i = 0; i < 500; ++i) {
    const Eigen::VectorXf wanted = (i % 2 == 0 ? growth.anywhere() : growth.known()).cast<float>();
    const long first = i / kScanBlock * kScanBlock;
    const float infinity = std::numeric_limits<float>::infinity();
    ScanResult expected{infinity, 0};
    scans.front()({nodes.data(), nodes.rows(), 7}, first, 1000, wanted.data(), expected);
    for (const NearestScan scan : scans) {
      ScanResult found{infinity, 0};
      scan({nodes.data(), nodes.rows(), 7}, first, 1000, wanted.data(), found);
      EXPECT_EQ(found.squared, expected.squared);
      EXPECT_EQ(found.index, expected.index);
    }
  }
}

TEST(NearestNodes, ATreeBeyondTheScanFindsTheSame) {
  Growth growth(6);
  NearestNodes scan(6, kMany);
  Tree tree(6);
  scan.add(growth.nodes().front());
  tree.add(growth.nodes().front(), -1);
  for (Eigen::Index i = 1; i < 3 * NearestNodes::kScanned; ++i) {
    scan.add(growth.next());
    tree.add(growth.nodes().back(), i - 1);
  }
  Tree moved = std::move(tree);
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd wanted = i % 2 == 0 ? growth.anywhere() : growth.known();
    EXPECT_EQ(moved.nearest(wanted), scan.find(wanted));
  }
}

}  // namespace
}  // namespace kinship::planning::nearest_nodes_test
