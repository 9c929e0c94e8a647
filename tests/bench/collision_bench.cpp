// Collision checks a second in the shelf cell: 12 boxes, gripper, a held box. One thread, CPU time.
//
//   collision_bench

#include <random>
#include <string>
#include <vector>

#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/shelf_cell.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kConfigurations = 2000;
constexpr double kSpread_rad = 0.1;

/// Configurations around the free starts; without those that collide if only free ones are wanted.
std::vector<Eigen::VectorXd> configurations_near_start(const kinematics::Chain& chain,
                                                       collision::CollisionWorld& world,
                                                       const Eigen::MatrixXd& starts,
                                                       bool only_free) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal(0, kSpread_rad);
  std::vector<Eigen::VectorXd> found;
  for (Eigen::Index i = 0; found.size() < kConfigurations; ++i) {
    const Eigen::VectorXd q =
        starts.col(i % starts.cols()) +
        Eigen::VectorXd::NullaryExpr(chain.dof(), [&] { return normal(generator); });
    if (!only_free || !world.collides(q))
      found.push_back(q);
  }
  return found;
}

void check(const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  std::mt19937_64 generator(kSeed);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  collision::CollisionWorld world(chain, model_shapes(robot), cell.surroundings);
  const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
  for (const bool only_free : {true, false}) {
    const auto asked = configurations_near_start(chain, world, starts, only_free);
    std::size_t colliding = 0;
    const double taken_s = least_s(20, thread_cpu_s, [&] {
      colliding = 0;
      for (const Eigen::VectorXd& q : asked)
        colliding += world.collides(q) ? 1U : 0U;
    });
    Figure figure{.name = robot + (only_free ? ", free" : ", near a start"),
                  .value = static_cast<double>(asked.size()) / taken_s,
                  .unit = "checks/s",
                  .better = Better::Higher,
                  .note = std::to_string(100 * colliding / asked.size()) + " % colliding"};
    if (robot == "panda" && only_free)
      figure.budget = 3e6;
    print(figure);
  }
}

}  // namespace
}  // namespace kinship::bench

int main() {
  for (const char* robot : {"panda", "iiwa14", "ur10e"})
    kinship::bench::check(robot);
}
