#include "server/store/values/distribution_blob.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/values/byte_fields.hpp"

namespace kinship::store {
namespace {

// Written first. Each addition of a format stands at its fields.
constexpr int kDistributionFormat =
    std::max(newest_format(kFieldsOf<Source>), newest_format(kLastFieldsOfDistribution));

constexpr std::tuple kBegin{Field{"id", &Distribution::id},
                            Field{"task", &Distribution::task},
                            Field{"robot", &Distribution::robot},
                            Field{"T_task_base", &Distribution::T_task_base},
                            Field{"profile", &Distribution::profile},
                            Field{"engines", &Distribution::engines},
                            Field{"state", &Distribution::state},
                            Field{"reason", &Distribution::reason},
                            Field{"configurations", &Distribution::configurations},
                            Field{"limits", &Distribution::limits, {.limit = kMaxDof}},
                            Field{"held_out_score", &Distribution::held_out_score}};
constexpr std::tuple kAdvice{Field{"recommended_share", &Advice::recommended_share},
                             Field{"evidence", &Advice::evidence}};
constexpr std::tuple kMade{Field{"fitted_ms", &Distribution::fitted_ms},
                           Field{"transfer_time_s", &Distribution::transfer_time_s},
                           Field{"fit_time_s", &Distribution::fit_time_s},
                           Field{"sources", &Distribution::sources, {.limit = kMaxSources}}};
constexpr std::tuple kEnd{
    Field{"selection", &Distribution::selection},
    Field{"component_scores", &Distribution::component_scores, {.limit = kMaxComponentScores}},
    Field{"cuts", &Distribution::cuts, {.limit = kMaxDof}}, Field{"fit", &Distribution::fit}};

/// Rules beyond sizes and enumerators.
void check_choice(const Distribution& distribution) {
  for (const ComponentScore& score : distribution.component_scores)
    if (score.components < 1 || score.components > int{kMaxComponents} ||
        !std::isfinite(score.score))
      throw std::out_of_range("distribution: a score that no fit has");
  if (!distribution.cuts.empty() && std::ssize(distribution.cuts) != distribution.limits.cols())
    throw std::out_of_range("distribution: cuts of other joints than it has");
  for (const std::optional<double>& cut : distribution.cuts)
    if (!std::isfinite(cut.value_or(0)))
      throw std::out_of_range("distribution: a cut is not finite");
}

void add_mixture(ByteWriter& out, const Mixture& mixture) {
  out.add(mixture.weights()).add(mixture.means());
  out.add(std::uint64_t{mixture.covariances().size()});
  for (const Eigen::MatrixXd& covariance : mixture.covariances())
    out.add(covariance);
}

Mixture read_mixture(ByteReader& in) {
  const Eigen::MatrixXd weights = in.matrix(kMaxKernels, 1);
  Eigen::MatrixXd means = in.matrix(kMaxDof, kMaxKernels);
  const std::uint64_t count = in.integer();
  if (count > kMaxComponents || (count > 1 && std::uint64_t(weights.rows()) != count))
    throw std::out_of_range("distribution: too many covariances, or other than components");
  std::vector<Eigen::MatrixXd> covariances;
  for (std::uint64_t i = 0; i < count; ++i)
    covariances.push_back(in.matrix(kMaxDof, kMaxDof));
  return {Eigen::VectorXd(weights.reshaped()), std::move(means), std::move(covariances)};
}

Distribution read_distribution(ByteReader& in) {
  const std::uint64_t format = in.integer();
  if (format < 1 || format > std::uint64_t{kDistributionFormat})
    throw std::out_of_range("distribution: another format");
  const auto known = static_cast<int>(format);
  Distribution distribution;
  read_members(in, known, kBegin, distribution);
  read_members(in, known, kAdvice, distribution.advice);
  read_members(in, known, kMade, distribution);
  if (in.integer() != 0)
    distribution.mixture = read_mixture(in);
  read_members(in, known, kEnd, distribution);
  read_members(in, known, kLastFieldsOfDistribution, distribution);
  if (!in.at_end())
    throw std::out_of_range("distribution: bytes left over");
  check_choice(distribution);
  return distribution;
}

}  // namespace

std::vector<std::uint8_t> encode_distribution(const Distribution& distribution) {
  ByteWriter out;
  out.add(std::uint64_t{kDistributionFormat});
  add_members(out, distribution, kBegin);
  add_members(out, distribution.advice, kAdvice);
  add_members(out, distribution, kMade);
  out.add(std::uint64_t{distribution.mixture ? 1U : 0U});
  if (distribution.mixture)
    add_mixture(out, *distribution.mixture);
  add_members(out, distribution, kEnd);
  add_members(out, distribution, kLastFieldsOfDistribution);
  return out.bytes();
}

std::optional<Distribution> decode_distribution(std::span<const std::uint8_t> blob) {
  try {
    ByteReader in(blob);
    return read_distribution(in);
  } catch (const std::out_of_range&) {
    return std::nullopt;
  } catch (const std::invalid_argument&) {  // of Mixture
    return std::nullopt;
  }
}

}  // namespace kinship::store
