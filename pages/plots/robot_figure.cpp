#include "pages/plots/robot_figure.hpp"

#include <random>

#include "pages/page/json_text.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::plots {
namespace {

constexpr int kShownTries = 200;
constexpr std::uint64_t kShownSeed = 1;

Eigen::VectorXd random_configuration(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> part(0, 1);
  return chain.lower() + Eigen::VectorXd::NullaryExpr(chain.dof(), [&] {
                           return part(generator);
                         }).cwiseProduct(chain.upper() - chain.lower());
}

}  // namespace

RobotFigure robot_figure(const RobotSummary& summary, const RobotDescription& description,
                         const std::vector<StoredMesh>& contents) {
  RobotFigure figure{summary, drawn_robot(description, contents), {}};
  const kinematics::Chain& chain = figure.drawn.robot.chain;
  collision::CollisionWorld world(chain, figure.drawn.robot.shapes, {});
  const Eigen::VectorXd zero =
      Eigen::VectorXd::Zero(chain.dof()).cwiseMax(chain.lower()).cwiseMin(chain.upper());
  std::mt19937_64 generator(kShownSeed);
  for (int i = 0; i < kShownTries && figure.touches_itself; ++i) {
    const Eigen::VectorXd q = i == 0   ? zero
                              : i == 1 ? Eigen::VectorXd((chain.lower() + chain.upper()) / 2)
                                       : random_configuration(chain, generator);
    figure.touches_itself = world.collides(q);
    if (i == 0 || !figure.touches_itself)
      figure.shown = q;
  }
  return figure;
}

std::string to_json(const RobotFigure& figure) {
  return page::object({{"summary", json::to_json(figure.summary)},
                       {"robot", to_json(figure.drawn)},
                       {"shown", page::list(figure.shown, page::number)},
                       {"touches_itself", figure.touches_itself ? "true" : "false"}});
}

}  // namespace kinship::plots
