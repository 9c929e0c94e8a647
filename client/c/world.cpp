#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "proto/types/number_text.hpp"
#include "robots/geometry/geometry_doubts.hpp"

namespace kinship::c_library {
namespace {

static_assert(KINSHIP_CLEARANCE_M == collision::EdgeProofOptions{}.clearance_m);

/// A sentence a line.
std::string doubts_of(const models::LoadedRobot& robot, const collision::RobotSolids& solids,
                      const collision::Surroundings& surroundings) {
  std::string lines;
  const auto add = [&](const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences)
      lines += (lines.empty() ? "" : "\n") + sentence;
  };
  add(robot.warnings);
  add(geometry::find_doubts(robot.chain, robot.shapes));
  if (std::string touching = collision::describe_always_touching(solids); !touching.empty())
    add({std::move(touching)});
  add(geometry::find_scene_doubts(robot.chain, robot.shapes, surroundings.T_task_base,
                                  surroundings.scene, surroundings.attached));
  return lines;
}

/// \return  dof x count. \param numbers  one configuration after the other.
/// \throws Failure(InvalidInput) that names an array that is NULL, not finite or of a wrong size.
Eigen::Map<const Eigen::MatrixXd> read_configurations(const kinship_world& world,
                                                      const double* numbers, std::size_t count,
                                                      std::size_t dof, const std::string& name) {
  require(numbers, name.c_str());
  if (dof != world.dof)
    throw Failure(invalid_input("dof is " + std::to_string(dof) + ", must be " +
                                std::to_string(world.dof) + ", the joints of the world's robot"));
  const Eigen::Map<const Eigen::MatrixXd> read(numbers, static_cast<Eigen::Index>(dof),
                                               static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count * dof; ++i)
    if (!std::isfinite(numbers[i]))
      throw Failure(invalid_input(name + "[" + std::to_string(i) + "] is " +
                                  number_text(numbers[i]) + ", must be finite"));
  return read;
}

/// The edges up to the first that is not free.
/// \param waypoints  dof x n, n at least 2.
kinship_proof prove(kinship_world& world, const Eigen::Ref<const Eigen::MatrixXd>& waypoints,
                    double clearance_m) {
  constexpr Eigen::Index kTogether = 64;  // cost less than one after the other
  kinship_proof known{};
  known.is_free = 1;
  known.least_clearance_m = std::numeric_limits<double>::infinity();
  const std::scoped_lock lock(world.mutex);
  for (Eigen::Index from = 0; from < waypoints.cols() - 1; from += kTogether) {
    const Eigen::Index count = std::min(kTogether, waypoints.cols() - 1 - from);
    auto edge = static_cast<std::size_t>(from);
    for (const collision::EdgeProof& proof :
         world.prover.prove_all(waypoints.middleCols(from, count),
                                waypoints.middleCols(from + 1, count), {clearance_m})) {
      known.least_clearance_m = std::min(known.least_clearance_m, proof.least_clearance_m);
      if (!proof.is_free()) {
        known.is_free = 0;
        known.edge = edge;
        known.share = proof.refutation->share;
        known.first = world.names.insert(proof.refutation->first).first->c_str();
        known.second = world.names.insert(proof.refutation->second).first->c_str();
        known.clearance_m = proof.refutation->clearance_m;
        return known;
      }
      ++edge;
    }
  }
  return known;
}

}  // namespace
}  // namespace kinship::c_library

using namespace kinship::c_library;

kinship_code kinship_world_create(const kinship_robot_file* file,
                                  const kinship_surroundings* surroundings, kinship_world** world,
                                  size_t* dof) {
  return guarded([&] {
    require(world, "world");
    *world = nullptr;
    const kinship::models::LoadedRobot robot = read_robot_file(read_structure(file, "file"));
    if (const auto error = kinship::geometry::find_faults(robot.chain, robot.shapes))
      return remember(*error);
    const auto around =
        surroundings == nullptr
            ? kinship::collision::Surroundings{}
            : read_surroundings(read_structure(surroundings, "surroundings"), robot.chain);
    const kinship::collision::RobotSolids solids(robot.chain, robot.shapes);
    *world = new kinship_world(robot, solids, around, doubts_of(robot, solids, around));
    if (dof != nullptr)
      *dof = (*world)->dof;
    return KINSHIP_OK;
  });
}

void kinship_world_free(kinship_world* world) { delete world; }

const char* kinship_world_warning(const kinship_world* world) {
  return world == nullptr ? "" : world->warning.c_str();
}

kinship_code kinship_world_is_free(kinship_world* world, const double* q, size_t dof,
                                   int* is_free) {
  return guarded([&] {
    require(world, "world");
    require(is_free, "is_free");
    const auto configuration = read_configurations(*world, q, 1, dof, "q");
    const std::scoped_lock lock(world->mutex);
    *is_free = world->world.collides(configuration.col(0)) ? 0 : 1;
    return KINSHIP_OK;
  });
}

kinship_code kinship_world_edge_free(kinship_world* world, const double* from, const double* to,
                                     size_t dof, double clearance_m, kinship_proof* proof) {
  return guarded([&] {
    require(world, "world");
    require(proof, "proof");
    kinship::collision::check_clearance("clearance_m", clearance_m);
    Eigen::MatrixXd ends(static_cast<Eigen::Index>(world->dof), 2);
    ends.col(0) = read_configurations(*world, from, 1, dof, "from");
    ends.col(1) = read_configurations(*world, to, 1, dof, "to");
    write_structure(prove(*world, ends, clearance_m), proof, "proof");
    return KINSHIP_OK;
  });
}

kinship_code kinship_world_path_free(kinship_world* world, const double* waypoints, size_t count,
                                     size_t dof, double clearance_m, kinship_proof* proof) {
  return guarded([&] {
    require(world, "world");
    require(proof, "proof");
    kinship::collision::check_clearance("clearance_m", clearance_m);
    if (count < 2 || count > kMaxWaypoints)
      throw kinship::Failure(kinship::invalid_input(
          "count is " + std::to_string(count) + ", must be 2 to " + std::to_string(kMaxWaypoints)));
    write_structure(
        prove(*world, read_configurations(*world, waypoints, count, dof, "waypoints"), clearance_m),
        proof, "proof");
    return KINSHIP_OK;
  });
}
