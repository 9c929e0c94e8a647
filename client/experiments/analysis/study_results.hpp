#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "client/experiments/analysis/cell_statistics.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// The test results of a study in order: what tables and figures are made of.
class StudyResults {
 public:
  /// \param results  of the main cells: uniform, and guided by one robot's experience each.
  StudyResults(const Study& study, const std::vector<QueryResult>& results);

  const std::vector<std::string>& robots() const noexcept { return robots_; }

  /// Name of the uniform cell that guided ones are compared with: the same overshoot.
  const std::string& uniform() const noexcept { return uniform_; }

  /// \return null if the robot was not planned with this guidance.
  const CellResults* find(const std::string& robot, const std::string& guidance) const;

  /// Guided against uniform planning with the same overshoot.
  /// \return null if there is no such pair.
  const PairRatio* find_pair(const std::string& robot, const std::string& source) const;

  /// Guided against plain uniform planning (f = 1) if that needs fewer checks than with the
  /// overshoot: the ratio of the means.
  double ratio_to_better_uniform(const std::string& robot, const std::string& source) const;

  enum class Pairs { Own, Transferred, All };
  GeometricMean geometric_mean(Pairs pairs, Quantity quantity) const;

 private:
  using Key = std::pair<std::string, std::string>;

  std::vector<std::string> robots_;
  std::string uniform_;
  std::map<Key, CellResults> cells_;
  std::map<Key, PairRatio> pairs_;
};

}  // namespace kinship::experiments
