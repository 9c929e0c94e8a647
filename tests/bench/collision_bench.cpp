// Collision checks a second in the shelf cell: 12 boxes, gripper, a held box. One thread, CPU time.
//
//   collision_bench

#include <algorithm>
#include <random>
#include <string>

#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/shelf_cell.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr Eigen::Index kConfigurations = 2000;
constexpr double kSpread_rad = 0.1;

/// Configurations around the free starts; without those that collide if only free ones are wanted.
Eigen::MatrixXd configurations_near_start(const kinematics::Chain& chain,
                                          collision::CollisionWorld& world,
                                          const Eigen::MatrixXd& starts, bool only_free) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal(0, kSpread_rad);
  Eigen::MatrixXd found(chain.dof(), kConfigurations);
  for (Eigen::Index i = 0, count = 0; count < kConfigurations; ++i) {
    const Eigen::VectorXd q =
        starts.col(i % starts.cols()) +
        Eigen::VectorXd::NullaryExpr(chain.dof(), [&] { return normal(generator); });
    if (!only_free || !world.collides(q))
      found.col(count++) = q;
  }
  return found;
}

/// Checks a second of FCL, one configuration after the other.
double fcl_rate(collision::CollisionWorld& world, const Eigen::MatrixXd& asked) {
  std::size_t colliding = 0;
  const double taken_s = least_s(5, thread_cpu_s, [&] {
    for (Eigen::Index i = 0; i < asked.cols(); ++i)
      colliding += world.find_contact(asked.col(i)) ? 1U : 0U;
  });
  return static_cast<double>(asked.cols()) / taken_s;
}

/// Asks for all, `together` at once; what comes after a colliding one is asked again.
std::size_t count_colliding(collision::CollisionWorld& world, const Eigen::MatrixXd& asked,
                            Eigen::Index together) {
  std::size_t colliding = 0;
  for (Eigen::Index first = 0; first < asked.cols();) {
    const Eigen::Index count = std::min(together, asked.cols() - first);
    const Eigen::Index free = world.free_ahead(asked.middleCols(first, count));
    colliding += free < count ? 1U : 0U;
    first += std::min(free + 1, count);
  }
  return colliding;
}

void check(const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  std::mt19937_64 generator(kSeed);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  collision::CollisionWorld world(chain, model_shapes(robot), cell.surroundings);
  const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
  for (const bool only_free : {true, false}) {
    const Eigen::MatrixXd asked = configurations_near_start(chain, world, starts, only_free);
    const Reference fcl{"FCL", fcl_rate(world, asked)};
    for (const Eigen::Index together : {1, 16}) {
      std::size_t colliding = 0;
      const double taken_s =
          least_s(20, thread_cpu_s, [&] { colliding = count_colliding(world, asked, together); });
      Figure figure{
          .name = robot + (only_free ? ", free" : ", near a start") +
                  (together > 1 ? ", side by side" : ""),
          .value = static_cast<double>(asked.cols()) / taken_s,
          .unit = "checks/s",
          .better = Better::Higher,
          .reference = fcl,
          .note = std::to_string(100 * colliding / static_cast<std::size_t>(kConfigurations)) +
                  " % colliding"};
      if (only_free && together > 1)
        figure.ratio_budget = 10;
      print(figure);
    }
  }
}

}  // namespace
}  // namespace kinship::bench

int main() {
  for (const char* robot : {"panda", "iiwa14", "ur10e"})
    kinship::bench::check(robot);
}
