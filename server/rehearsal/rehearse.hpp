#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/types/mixture.hpp"
#include "proto/types/rehearsal.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/recall/recall_guide.hpp"
#include "server/rehearsal/posed_query.hpp"
#include "server/rehearsal/recorded_query.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::rehearsal {

/// Paths are halves of a task's experience: a query is planned with the mixture of the other half.
inline constexpr std::size_t kHalves = 2;
std::size_t half_of(const Uuid& path);

/// Subject of a rehearsal: one robot at its placement, with its guidance.
struct Subject {
  std::shared_ptr<const runtime::Robot> robot;
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  Starts starts = {};
  bool to_configuration = false;  ///< its queries ask for one configuration, not any at a pose
  RecordedQueries recorded;
  std::shared_ptr<const planning::ExperienceGuide> experience;  ///< not null
  std::shared_ptr<const recall::RecallGuide> recall;            ///< null: there is none
  /// Fitted without the paths of half 0, and of half 1; missing: there is no mixture.
  std::array<std::optional<Mixture>, kHalves> mixtures = {};
};

/// The guide with the least mean time. Of guides that take up to 3 % more: those whose search
/// alone, where nothing is recalled, takes least, or up to 3 % more; of these the one with the
/// least preparation. Where no time is known, by checks.
/// \param costs  at least one.
Guide cheapest(std::span<const GuideCost> costs);

/// "; mean time none 4.12 ms (1552 checks), ways 1.05 ms (361 checks)".
std::string described(const std::vector<GuideCost>& costs);

struct RehearsalOptions {
  std::size_t rounds = 4;  ///< times that each query is planned with each guide, each with a seed
  std::uint64_t max_checks = 20'000;  ///< of one plan
  std::stop_token stop = {};          ///< tested before each check
};

/// Plans recorded queries with each guide in turn, one query per step, so that the caller may rest
/// between steps. Each guide also counts as one that first recalls a path and plans only where that
/// fails. A guide of at least 20 plans whose mean time at the end of a round exceeds 1.5
/// times that of the best one is dropped. Equal subject, equal steps: plans with equal checks;
/// times are measured, and so is what follows from them: the guides dropped, and the one to use.
class Rehearsing {
 public:
  explicit Rehearsing(Subject subject, const RehearsalOptions& options = {});

  /// Plans the next query.
  /// \return false if there was none.
  /// \throws Stopped.
  bool step();

  std::size_t rounds() const noexcept { return round_; }  ///< completed

  /// The result so far, with the cheapest guide. Guide::All until each query was planned once.
  Rehearsal result() const;

 private:
  /// Of one plan, or of trying to recall one.
  struct Cost {
    double checks = 0, time_s = 0;
    bool is_solved = false;
    bool has_used_tracks = false;  // followed all of them in vain
  };
  struct Tried {
    std::vector<double> checks;  // of each plan, in the order of steps
    double time_s = 0;           // of all plans
    std::uint64_t solved = 0;

    void add(const Cost& cost);
    double mean_time_s() const { return time_s / static_cast<double>(checks.size()); }
  };
  struct TriedGuide {
    Guide guide;
    Tried alone, after_recall;  // the latter without plans if nothing can be recalled
    bool is_left = false;
  };

  /// Of one query with one guide.
  struct Costs {
    Cost alone;
    std::optional<Cost> after_recall;  // nothing: there is nothing to recall
  };

  Costs try_guide(PosedQuery& posed, std::uint64_t seed, Guide guide,
                  const std::optional<Cost>& recalled, std::vector<recall::Warp>& failed) const;
  Cost plan(PosedQuery& posed, std::uint64_t seed, Guide guide) const;
  std::optional<Cost> recall(PosedQuery& posed, std::vector<recall::Warp>& failed) const;
  bool is_done() const;
  void advance();
  void end_round();

  const Subject subject_;
  const RehearsalOptions options_;
  std::vector<TriedGuide> guides_;
  std::vector<bool> is_usable_;  // of the queries; all until they were posed once
  std::size_t next_ = 0, round_ = 0;
};

}  // namespace kinship::rehearsal
