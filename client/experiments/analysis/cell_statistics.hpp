#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "client/experiments/pipeline/query_result.hpp"
#include "client/experiments/wilcoxon.hpp"

namespace kinship::experiments {

/// Mean, standard deviation and median of one quantity over queries.
struct Moments {
  double mean = 0;
  double deviation = 0;  ///< of the sample; 0 with fewer than two values
  double median = 0;
};

/// \throws std::invalid_argument if `values` is empty.
Moments moments_of(const std::vector<double>& values);

/// The queries of one robot with one guidance: instances x seeds.
struct CellResults {
  std::string robot, guidance;
  std::vector<std::string> instances;        ///< ascending
  std::vector<std::vector<double>> checks;   ///< by instance, then seed; unsolved: the limit
  std::vector<std::vector<double>> cpu_s;    ///< the same
  std::vector<std::vector<bool>> solved;     ///< the same
  std::vector<std::vector<double>> lengths;  ///< by instance; of solved queries only, joint units
  double projections_per_check = 0;

  std::size_t queries() const;
  std::size_t solved_queries() const;
};

/// Puts the results of one robot and guidance in order.
/// \param max_checks  what an unsolved query counts.
/// \return            without instances if there are no such results.
CellResults collect_cell(const std::vector<QueryResult>& results, const std::string& robot,
                         const std::string& guidance, std::uint64_t max_checks);

/// Every value of an instances x seeds table.
std::vector<double> flat(const std::vector<std::vector<double>>& by_instance);

/// The mean over the seeds of each instance: seeds are not replicates of a test.
std::vector<double> instance_means(const std::vector<std::vector<double>>& by_instance);

/// Guided against uniform planning of the same robot over the same instances and seeds.
struct PairRatio {
  std::string robot, guidance;
  double checks_ratio = 0;                ///< mean uniform / mean guided
  double low = 0, high = 0;               ///< 95 % interval of it, instances resampled
  double median_checks_ratio = 0;         ///< of the medians over queries
  double cpu_ratio = 0;                   ///< of mean times
  WilcoxonSummary checks_test, cpu_test;  ///< over instance means
  std::size_t guided_only = 0;            ///< queries that were solved with guidance only
  std::size_t uniform_only = 0;           ///< and without it only
  double success_p = 1;                   ///< McNemar's exact test of these
};

/// \throws std::invalid_argument if the two have different instances or seeds.
PairRatio compare_cells(const CellResults& uniform, const CellResults& guided);

/// Geometric mean over pairs with its 95 % interval; instances are resampled, the same ones for
/// every pair, as they are the same.
struct GeometricMean {
  double value = 0, low = 0, high = 0;
  std::size_t pairs = 0;
};

/// What of two cells is compared.
enum class Quantity { Checks, Cpu };

/// \param pairs  (uniform, guided); pairs must have equally many instances.
/// \return       zeros if there are no pairs.
GeometricMean geometric_mean_ratio(
    const std::vector<std::pair<const CellResults*, const CellResults*>>& pairs, Quantity quantity);

/// Two-sided exact p of McNemar's test: of that or a rarer split of discordant pairs by fair coins.
/// Source: McNemar, Note on the sampling error of the difference between correlated proportions
/// (1947); the exact form is a binomial test.
double mcnemar_p(std::size_t first_only, std::size_t second_only);

}  // namespace kinship::experiments
