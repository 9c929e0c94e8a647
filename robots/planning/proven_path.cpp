#include "robots/planning/proven_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace kinship::planning {
namespace {

// Steps become so much finer each time: little, as another search mostly finds another way. After
// the last, of 0.05, a point 1 m away moves by half a millimetre between two checks.
constexpr double kFiner = 1.5;
constexpr int kMostTimesFiner = 12;
constexpr int kMostShortenings = 6;  // before a path is proven first, and then each shortcut

using Lines = IsFree::Lines;

std::uint64_t refuted_among(const Lines& lines) {
  return static_cast<std::uint64_t>(std::ranges::count(lines, false));
}

/// Lines and the answers for them.
class KnownLines {
 public:
  struct Line {
    Eigen::VectorXd from, to;
    bool is_free;  // else refuted
  };

  /// \return null if nothing is known.
  const Line* find(const Eigen::Ref<const Eigen::VectorXd>& from,
                   const Eigen::Ref<const Eigen::VectorXd>& to) const {
    const auto at = std::ranges::find_if(
        lines_, [&](const Line& line) { return line.from == from && line.to == to; });
    return at == lines_.end() ? nullptr : &*at;
  }

  /// A line that is known to be refuted is; all others count as free.
  Lines by_what_is_known(const Eigen::Ref<const Eigen::MatrixXd>& from,
                         const Eigen::Ref<const Eigen::MatrixXd>& to) const {
    Lines said(static_cast<std::size_t>(from.cols()), true);
    for (Eigen::Index i = 0; i < from.cols(); ++i)
      if (const Line* const known = find(from.col(i), to.col(i)))
        said[static_cast<std::size_t>(i)] = known->is_free;
    return said;
  }

  /// Asks for the lines of a path that are not known. \return how many of them are refuted.
  std::uint64_t prove(const Eigen::MatrixXd& path, const IsFree& is_free) {
    Eigen::MatrixXd from(path.rows(), path.cols()), to(path.rows(), path.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 1; i < path.cols(); ++i)
      if (find(path.col(i - 1), path.col(i)) == nullptr) {
        from.col(count) = path.col(i - 1);
        to.col(count++) = path.col(i);
      }
    if (count == 0)
      return 0;
    const Lines said = is_free.edges(from.leftCols(count), to.leftCols(count));
    for (Eigen::Index i = 0; i < count; ++i)
      lines_.push_back({from.col(i), to.col(i), said[static_cast<std::size_t>(i)]});
    return refuted_among(said);
  }

 private:
  std::vector<Line> lines_;
};

/// One path on its way to a proof.
class Proving {
 public:
  Proving(double step, const IsFree& is_free, const Shorten& shorten, const PlanBetween& plan)
      : step_(step), is_free_(is_free), shorten_(shorten), plan_(plan) {}

  ProvenPath run(const Eigen::MatrixXd& waypoints) {
    if (shorten_what_holds(waypoints))
      return proven_;
    std::vector<Eigen::VectorXd> path = {waypoints.col(0)};
    if (!prove(waypoints, step_, 0, path))
      return proven_;
    Eigen::MatrixXd whole(waypoints.rows(), static_cast<Eigen::Index>(path.size()));
    for (std::size_t i = 0; i < path.size(); ++i)
      whole.col(static_cast<Eigen::Index>(i)) = path[i];
    keep(shorten_(whole, is_free_));
    // Shortcuts are proven from end to end, but a line that is left of one, or of two, may come
    // nearer than the clearance where it is looked at now: then it stays unshortened.
    if (!is_free_.way_is_free(proven_.waypoints))
      proven_.waypoints = whole;
    return proven_;
  }

 private:
  Lines lines(const Eigen::MatrixXd& waypoints) const {
    const Eigen::Index count = waypoints.cols() - 1;
    return is_free_.edges(waypoints.leftCols(count), waypoints.rightCols(count));
  }

  void keep(ShortcutSummary shortened) {
    proven_.waypoints = std::move(shortened.waypoints);
    proven_.shortcut_checks += shortened.collision_checks;
    proven_.projections += shortened.projections;
  }

  /// Shortens without refuted lines, until all is proven. \return whether it came to that; not if
  /// the path itself is refuted.
  bool shorten_what_holds(const Eigen::MatrixXd& waypoints) {
    KnownLines known;
    const IsFree by_checks = is_free_.with_edges(
        [&](const auto& from, const auto& to) { return known.by_what_is_known(from, to); });
    for (int i = 0; i < kMostShortenings; ++i) {
      keep(shorten_(waypoints, by_checks));
      const std::uint64_t refuted = known.prove(proven_.waypoints, is_free_);
      proven_.refuted_edges += refuted;
      const Eigen::Index count = proven_.waypoints.cols() - 1;
      if (refuted_among(known.by_what_is_known(proven_.waypoints.leftCols(count),
                                               proven_.waypoints.rightCols(count))) == 0)
        return true;
      if (refuted == 0)  // only lines refuted before, which are no shortcuts
        break;
    }
    proven_.waypoints.resize(0, 0);
    return false;
  }

  /// Adds all but the first waypoint, or a replacement. \return whether all is proven.
  bool prove(const Eigen::MatrixXd& waypoints, double step, int times,
             std::vector<Eigen::VectorXd>& path) {
    const Lines said = lines(waypoints);
    for (Eigen::Index i = 1; i < waypoints.cols(); ++i) {
      if (said[static_cast<std::size_t>(i - 1)]) {
        path.emplace_back(waypoints.col(i));
        continue;
      }
      ++proven_.refuted_edges;
      if (times == kMostTimesFiner) {
        proven_.reason = NoPath::EdgesRefuted;
        return false;
      }
      const PlanSummary between = plan_(waypoints.col(i - 1), waypoints.col(i), step / kFiner);
      proven_.collision_checks += between.collision_checks;
      proven_.projections += between.projections;
      if (!between.waypoints) {
        proven_.reason = between.reason;
        return false;
      }
      if (!prove(*between.waypoints, step / kFiner, times + 1, path))
        return false;
    }
    return true;
  }

  const double step_;
  const IsFree& is_free_;
  const Shorten& shorten_;
  const PlanBetween& plan_;
  ProvenPath proven_;
};

}  // namespace

std::optional<Eigen::MatrixXd> detour(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                                      const IsFree& is_free, const Eigen::Matrix2Xd& bounds,
                                      std::mt19937_64& generator, std::uint64_t& checks) {
  constexpr double kNearest = 0.02, kFarthest = 0.3;  // joint units, a joint
  std::normal_distribution<double> normal;
  Eigen::MatrixXd over(from.size(), kTogether);
  for (Eigen::Index i = 0; i < kTogether; ++i) {
    const double spread =
        kNearest + (kFarthest - kNearest) * static_cast<double>(i) / static_cast<double>(kTogether);
    for (Eigen::Index joint = 0; joint < from.size(); ++joint)
      over(joint, i) = std::clamp((from[joint] + to[joint]) / 2 + spread * normal(generator),
                                  bounds(0, joint), bounds(1, joint));
  }
  for (Eigen::Index i = 0; i < kTogether; ++i) {
    ++checks;
    if (!is_free(over.col(i)))
      continue;
    Eigen::MatrixXd way(from.size(), 3);
    way << from, over.col(i), to;
    if (is_free.way_is_free(way))
      return way;
  }
  return std::nullopt;
}

ProvenPath shorten_and_prove(const Eigen::MatrixXd& waypoints, double step, const IsFree& is_free,
                             const Shorten& shorten, const PlanBetween& plan) {
  return Proving(step, is_free, shorten, plan).run(waypoints);
}

}  // namespace kinship::planning
