#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "client/c/kinship.h"
#include "client/c/kinship_planning.h"
#include "client/guided/plan_problem.hpp"
#include "client/link/client.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/scene.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/recall/recall_guide.hpp"
#include "robots/recall/recall_trust.hpp"

/// Definitions of the handles of kinship.h; their names follow C.
// NOLINTBEGIN(readability-identifier-naming)
struct kinship_client {
  explicit kinship_client(const kinship::link::ClientOptions& options) : line(options) {}
  kinship::link::Client line;

  void keep(const kinship::kinematics::Chain& chain) {
    const std::scoped_lock lock(mutex);
    chains.insert_or_assign(chain.digest(), chain);
  }
  /// \throws Failure(NotFound) if the client did not register the robot.
  kinship::kinematics::Chain chain_of(const kinship::Digest& robot) {
    const std::scoped_lock lock(mutex);
    const auto found = chains.find(robot);
    if (found == chains.end())
      throw kinship::Failure(kinship::ErrorCode::NotFound,
                             "robot " + robot.short_hex() + " was not registered by this client");
    return found->second;
  }

 private:
  std::mutex mutex;                                              // guards the chains
  std::map<kinship::Digest, kinship::kinematics::Chain> chains;  // of robots that it registered
};

struct kinship_distribution {
  std::shared_ptr<const kinship::Distribution> value;  // with a mixture; shared with the follower
};

struct kinship_follower {
  std::unique_ptr<kinship::link::Follower> value;
  std::optional<kinship::kinematics::Chain> chain = {};  // with recall
  std::atomic<bool> had_paths = false;                   // to recall
};

struct kinship_recall {
  kinship_recall(const kinship::kinematics::Chain& chain, const kinship::RecallLibrary& library,
                 const std::optional<Eigen::Isometry3d>& asked_for = {})
      : guide(chain, library), T_task_base(asked_for.value_or(Eigen::Isometry3d::Identity())) {}
  const kinship::recall::RecallGuide guide;
  const Eigen::Isometry3d T_task_base;  // that it is for
  std::mutex mutex;                     // guards the trust
  kinship::recall::RecallTrust trust;
};

struct kinship_sampler {
  explicit kinship_sampler(const kinship::Distribution& distribution)
      : value(distribution), limits(distribution.limits) {}
  kinship::mixture::DistributionSampler value;
  Eigen::Matrix2Xd limits;
};

struct kinship_world {
  kinship_world(const kinship::models::LoadedRobot& robot,
                const kinship::collision::RobotSolids& solids,
                const kinship::collision::Surroundings& surroundings, std::string its_warning)
      : dof(static_cast<std::size_t>(robot.chain.dof())),
        warning(std::move(its_warning)),
        world(solids, surroundings),
        prover(world) {}
  const std::size_t dof;
  const std::string warning;
  std::mutex mutex;  // guards what follows
  kinship::collision::CollisionWorld world;
  kinship::collision::EdgeProver prover;
  std::set<std::string> names;  // that proofs have told, at most one a body
};

struct kinship_planner {
  explicit kinship_planner(const kinship::models::LoadedRobot& loaded)
      : robot(std::make_shared<const kinship::guided::PlannedRobot>(loaded.chain, loaded.shapes)),
        limit_slack(loaded.limit_slack) {}
  const std::shared_ptr<const kinship::guided::PlannedRobot> robot;
  const std::optional<double> limit_slack;  // of the robot's files
};

struct kinship_plan {
  std::shared_ptr<const kinship::guided::PlannedRobot> robot;
  kinship::Problem problem;
  kinship::guided::PlanSettings settings;
  kinship::guided::PlannedProblem planned;
};
// NOLINTEND(readability-identifier-naming)

namespace kinship::c_library {

constexpr std::size_t kMaxWaypoints = std::size_t{1} << 24U;  // the contract's limit is lower

/// \param numbers  x y z qx qy qz qw. \param name  of the argument, for messages.
/// \throws Failure(InvalidInput) if they are no pose.
Eigen::Isometry3d read_pose(const double* numbers, const char* name);

/// \throws Failure(InvalidInput) if it is NULL.
Digest read_robot(const kinship_robot* robot, const char* name);

std::string text_or_empty(const char* text);

/// \param names  2 n, pair by pair. \throws Failure(InvalidInput) if one is NULL.
std::vector<std::pair<std::string, std::string>> read_pairs(const char* const* names,
                                                            std::size_t pairs, const char* name);

/// A structure's members on a scene.
struct SceneMembers {
  const kinship_object* objects;
  std::size_t object_count;
  const char* const* allowed_collisions;
  std::size_t allowed_collision_pairs;
};

/// A scene of the caller; what is held is given in the transfer frame, and names no link yet.
struct GivenScene {
  Scene scene;
  std::vector<AttachedObject> held;
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
};

/// \param name  of the structure, for messages.
/// \throws Failure(InvalidInput) if a member is NULL, of another size, or no shape or pose.
GivenScene read_scene(const SceneMembers& given, const std::string& name);

/// The same with a placement: what is held hangs on the tip link.
collision::Surroundings read_surroundings(const kinship_surroundings& given,
                                          const kinematics::Chain& chain);

/// \return  dof x count. \throws Failure(InvalidInput) if one is NULL or not finite.
Eigen::MatrixXd read_columns(const double* numbers, Eigen::Index dof, std::size_t count,
                             const std::string& name);

/// The robot in files, with its meshes' triangles. Links that move may be without solids.
/// \throws Failure that names the argument or file.
models::LoadedRobot read_robot_file(const kinship_robot_file& given);

}  // namespace kinship::c_library
