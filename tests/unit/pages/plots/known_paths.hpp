#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pages/plots/look_up.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/robots.hpp"

/// What a server would answer to figures that ask for paths.
namespace kinship::plots::test {

class KnownPaths {
 public:
  /// A path of a model along the given waypoints; the label is the model's name.
  /// \return what is reported of it, to be changed.
  Attempt& add(const std::string& model, const Eigen::MatrixXd& waypoints) {
    Attempt attempt;
    attempt.report_uuid.bytes.back() = static_cast<std::uint8_t>(attempts.size());
    attempt.report_uuid.bytes.front() = static_cast<std::uint8_t>(attempts.size() >> 8U);
    attempt.robot = kinship::test::model_chain(model).digest();
    attempt.task = "shelf";
    attempt.record.outcome = Outcome::Solved;
    attempt.path = Path(waypoints);
    descriptions.try_emplace(attempt.robot, kinship::test::model_description(model));
    PathSummary summary;
    summary.report_uuid = attempt.report_uuid;
    summary.robot = attempt.robot;
    summary.label = model;
    summary.received_ms = 1000 + static_cast<std::int64_t>(attempts.size());
    newest_first.insert(newest_first.begin(), summary);
    return attempts[attempt.report_uuid] = attempt;
  }

  LookUp look_up() {
    return {.for_each_path =
                [this](const std::string&, const std::optional<Digest>& robot, const auto& take) {
                  for (const PathSummary& path : newest_first)
                    if ((!robot || path.robot == *robot) && !take(path))
                      return;
                },
            .attempt = [this](const Uuid& report) { return find(attempts, report); },
            .robot = [this](const Digest& robot) { return find(descriptions, robot); },
            .distributions =
                [this](const std::string&, const Digest&) {
                  std::vector<DistributionSummary> kept;
                  for (const auto& [id, distribution] : distributions) {
                    DistributionSummary& summary = kept.emplace_back();
                    summary.id = id;
                    summary.state = distribution.state;
                    summary.fitted_ms = distribution.fitted_ms;
                    summary.T_task_base = distribution.T_task_base;
                  }
                  return kept;
                },
            .distribution = [this](const Digest& id) { return find(distributions, id); }};
  }

  std::map<Uuid, Attempt> attempts;
  std::vector<PathSummary> newest_first;
  std::map<Digest, RobotDescription> descriptions;
  std::map<Digest, Distribution> distributions;

 private:
  template <typename Key, typename Value>
  static Value find(const std::map<Key, Value>& values, const Key& key) {
    const auto found = values.find(key);
    if (found == values.end())
      throw Failure(ErrorCode::NotFound, "there is none");
    return found->second;
  }
};

/// The UR10e turns its first joint by an angle, rad.
inline Eigen::MatrixXd turn_of_ur10e(double angle) {
  Eigen::MatrixXd waypoints(6, 2);
  waypoints.colwise() = Eigen::VectorXd{{0, -1.2, 1.8, -2.2, -1.57, 0}};
  waypoints.row(0) << 0, angle;
  return waypoints;
}

/// The Panda in front of it, likewise.
inline Eigen::MatrixXd turn_of_panda(double angle) {
  Eigen::MatrixXd waypoints(7, 2);
  waypoints.colwise() = Eigen::VectorXd{{0, -0.785, 0, -2.356, 0, 1.571, 0.785}};
  waypoints.row(0) << 0, angle;
  return waypoints;
}

}  // namespace kinship::plots::test
