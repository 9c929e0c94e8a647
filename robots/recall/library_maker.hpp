#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/recall_library.hpp"
#include "proto/types/rehearsal.hpp"
#include "robots/collision/body.hpp"
#include "robots/collision/robot_solids.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/recall/recall_guide.hpp"

namespace kinship::recall {

/// A recorded query, posed to the robot.
struct PosedQuery {
  Uuid report;
  /// The robot's own path that answered it, dof x n; missing: the maker plans one.
  std::optional<Eigen::MatrixXd> solution;
  collision::Surroundings surroundings;            ///< with the robot's placement
  Eigen::Matrix2Xd bounds;                         ///< 2 x dof
  Eigen::VectorXd start;                           ///< dof, free
  Eigen::MatrixXd goals;                           ///< dof x n, n >= 1, free; one pose
  std::optional<TaskSpaceRegion> constraint = {};  ///< that the whole path keeps
};

struct LibraryMakerOptions {
  double step = 0.1;                             ///< between checked configurations, joint units
  std::vector<double> clearances_m{0.01, 0.02};  ///< of paths, one path each
  int branches = 2;                      ///< other goals of a query that a path is planned to
  std::uint64_t max_checks = 60'000;     ///< of one plan
  std::size_t max_paths = 256;           ///< of the library
  double max_phase_s = 60;               ///< processor time of each of three phases
  std::function<void()> before = [] {};  ///< called before each check; may throw to end the work
};

/// Makes the library of one robot and task from queries that were recorded, one query a step, so
/// that the caller may rest between steps: each query is solved, its path planned again with
/// clearance, also to other goals; then each path is moved onto the other queries and checked
/// there. Equal queries, equal library.
class LibraryMaker {
 public:
  LibraryMaker(const kinematics::Chain& chain, const collision::RobotSolids& solids,
               std::vector<PosedQuery> queries, LibraryMakerOptions options);

  /// Does the next part. \return false if there was none.
  bool step();

  /// After the last step: the library; nothing if no query was solved. Its revision is a digest of
  /// its content.
  std::optional<RecallLibrary> take();

 private:
  enum class Phase { Solve, Probe, Try, Done };
  struct World;

  void advance();
  std::size_t parts_of_phase() const;
  planning::PlanSummary plan(const PosedQuery& posed, World& world, const Eigen::MatrixXd& goals,
                             Guide guide, std::uint64_t seed) const;
  void solve(std::size_t query);
  std::optional<Eigen::MatrixXd> as_planned(const Eigen::MatrixXd& answer, World& world) const;
  Eigen::MatrixXd shortest(const std::vector<Eigen::MatrixXd>& answers, World& world) const;
  void add_clear_paths(const PosedQuery& posed, const Eigen::MatrixXd& raw,
                       std::span<const double> clearances_m);
  void add_path(const Eigen::MatrixXd& path);
  void begin_probe();
  void probe(std::size_t query);
  void begin_tries();
  void try_all(std::size_t query);
  void finish();

  Query query_of(std::size_t query, World& world, bool is_pose) const;
  bool works(const planning::IsFree& is_free, const Query& query, const Candidate& candidate);
  std::vector<bool> solved_by(std::size_t path) const;
  std::vector<std::size_t> best_first() const;

  const kinematics::Chain chain_;
  const collision::RobotSolids solids_;
  const std::vector<PosedQuery> queries_;
  const LibraryMakerOptions options_;
  const std::shared_ptr<const planning::ExperienceGuide> no_experience_;
  RecallLibrary library_;
  std::vector<std::size_t> posed_of_;  // of library_.queries: index into queries_
  std::optional<RecallGuide> guide_;
  std::size_t max_paths_ = 0, branches_ = 0;  // of the library, of a query
  Phase phase_ = Phase::Solve;
  double spent_s_ = 0;  // processor time of the phase
  std::size_t next_ = 0;
  std::size_t planned_ = 0;  // queries, with a search
  double uniform_checks_ = 0, retreat_checks_ = 0, planned_s_ = 0;
  double failed_s_ = 0;  // of tries that failed
  std::size_t failed_ = 0;
  std::vector<std::size_t> worked_;  // by mode, of the probe
};

}  // namespace kinship::recall
