#include "proto/json/distribution_json.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "proto/json/distribution_fields.hpp"
#include "proto/json/fields.hpp"
#include "proto/json/parts.hpp"
#include "proto/types/names.hpp"

namespace kinship::json {
namespace {

/// Refuses a count that exceeds another one.
void require_at_most(const Reader& object, std::string_view member, std::uint64_t limit) {
  static_cast<void>(object.at(member).count(limit));
}

void check_evidence(const std::optional<Reader>& reader,
                    const std::optional<ModeEvidence>& evidence) {
  if (evidence)
    require_at_most(*reader, "solved", evidence->attempts);
}

Advice read_advice(const Reader& reader) {
  Advice advice;
  read_members(reader, kAdvice, advice);
  check_evidence(reader.find("guided"), advice.guided);
  check_evidence(reader.find("control"), advice.control);
  if (advice.recent.empty())
    return advice;
  const std::vector<Reader> recent = reader.at("recent").elements(kMaxJudgedAttempts);
  for (std::size_t i = 0; i < recent.size(); ++i) {
    if (advice.recent[i].sampling_mode == SamplingMode::Uniform)
      recent[i].at("sampling_mode").refuse("must be guided or control");
    if (i > 0 && advice.recent[i].age > advice.recent[i - 1].age)
      recent[i].refuse("is older than the one before, must be oldest first");
  }
  return advice;
}

void add_mixture(const std::optional<Mixture>& mixture, OrderedJson& object) {
  object["weights"] = nullptr;
  object["means"] = nullptr;
  object["covariances"] = nullptr;
  if (!mixture)
    return;
  object["weights"] = list(mixture->weights());
  object["means"] = list_of_columns(mixture->means());
  OrderedJson covariances = OrderedJson::array();
  for (const Eigen::MatrixXd& covariance : mixture->covariances())
    covariances.push_back(list_of_columns(covariance));  // symmetric: rows are columns
  object["covariances"] = std::move(covariances);
}

Mixture read_mixture(const Reader& reader) {
  std::vector<Eigen::MatrixXd> covariances;
  for (const Reader& covariance : reader.at("covariances").elements(kMaxComponents))
    covariances.push_back(covariance.columns(kMaxDof, kMaxDof));
  const std::size_t most = covariances.size() == 1 ? kMaxKernels : kMaxComponents;
  Eigen::VectorXd weights = reader.at("weights").vector(most);
  Eigen::MatrixXd means = reader.at("means").columns(kMaxDof, most);
  try {
    return {std::move(weights), std::move(means), std::move(covariances)};
  } catch (const std::invalid_argument& error) {
    throw Failure(ErrorCode::InvalidInput,
                  std::string("weights, means, covariances: ") + error.what());
  }
}

Eigen::Matrix2Xd read_limits(const Reader& reader) {
  const Eigen::MatrixXd limits = reader.columns(2, kMaxDof);
  if (limits.cols() == 0)
    return Eigen::Matrix2Xd(2, 0);
  if (limits.rows() != 2)
    reader.refuse("each joint needs [lower, upper]");
  for (Eigen::Index joint = 0; joint < limits.cols(); ++joint)
    if (limits(0, joint) > limits(1, joint))
      reader.refuse("joint " + std::to_string(joint) + " has lower limit " +
                    std::to_string(limits(0, joint)) + " above upper " +
                    std::to_string(limits(1, joint)));
  return limits;
}

std::vector<ComponentScore> read_curve(const Reader& reader) {
  std::vector<ComponentScore> scores;
  for (const Reader& entry : reader.elements(kMaxComponentScores)) {
    const std::uint64_t components = entry.at("K").count();
    if (components < 1 || components > kMaxComponents)
      entry.refuse("K is not between 1 and " + std::to_string(kMaxComponents));
    if (!scores.empty() && static_cast<int>(components) >= scores.back().components)
      entry.refuse("K does not fall");
    scores.push_back({static_cast<int>(components), entry.at("score").number()});
  }
  return scores;
}

std::vector<std::optional<double>> read_cuts(const Reader& reader, Eigen::Index joints) {
  std::vector<std::optional<double>> cuts;
  for (const Reader& entry : reader.elements(kMaxDof)) {
    cuts.emplace_back();
    if (!entry.is_null())
      cuts.back() = entry.number();
  }
  if (static_cast<Eigen::Index>(cuts.size()) != joints)
    reader.refuse(std::to_string(cuts.size()) + " entries for " + std::to_string(joints) +
                  " joints");
  return cuts;
}

/// Of a distribution with state and limits: a ready one has a mixture of as many joints.
std::optional<Mixture> read_mixture_part(const Reader& reader, const Distribution& distribution,
                                         MixturePart part) {
  const auto weights = reader.find("weights");
  if (distribution.state == DistributionState::Failed) {
    if (weights)
      weights->refuse("must be null if state is 'failed'");
    return std::nullopt;
  }
  if (!weights && part == MixturePart::MayBeMissing)
    return std::nullopt;
  Mixture mixture = read_mixture(reader);
  if (mixture.dimension() != distribution.limits.cols())
    throw Failure(ErrorCode::InvalidInput, "limits: " + std::to_string(distribution.limits.cols()) +
                                               " joints, means have " +
                                               std::to_string(mixture.dimension()));
  return mixture;
}

}  // namespace

Distribution read_distribution(const Reader& reader, MixturePart mixture) {
  Distribution distribution;
  read_members(reader, kProvenance, distribution);
  if (const auto error = check_task(distribution.task))
    throw Failure(*error);
  const std::vector<Digest>& selected = distribution.selection.sources;
  if (std::adjacent_find(selected.begin(), selected.end(), std::greater_equal<>()) !=
      selected.end())
    reader.at("selection").refuse("sources must be ascending and distinct");
  read_members(reader, kFit, distribution);
  read_members(reader, kLastFieldsOfDistribution, distribution);
  if (const std::optional<FitOrigin>& fit = distribution.fit) {
    require_at_most(reader.at("fit"), "full_revision", fit->from_revision);
    require_at_most(reader.at("fit"), "new_paths", fit->paths);
    require_at_most(reader.at("fit"), "transferred", fit->paths);
  }
  distribution.advice = read_advice(reader);
  if (const auto score = reader.find("held_out_score"))
    distribution.held_out_score = score->number();
  if (const auto curve = reader.find("k_curve"))
    distribution.component_scores = read_curve(*curve);
  distribution.limits = read_limits(reader.at("limits"));
  if (const auto cuts = reader.find("cuts"))
    distribution.cuts = read_cuts(*cuts, distribution.limits.cols());
  distribution.mixture = read_mixture_part(reader, distribution, mixture);
  return distribution;
}

OrderedJson distribution_object(const Distribution& distribution) {
  OrderedJson object;
  add_members(distribution, kProvenance, object);
  add_mixture(distribution.mixture, object);
  object["limits"] = list_of_columns(distribution.limits);
  object["cuts"] = distribution.cuts.empty() ? OrderedJson(nullptr) : json_of(distribution.cuts);
  object["k_curve"] = distribution.component_scores.empty()
                          ? OrderedJson(nullptr)
                          : json_of(distribution.component_scores);
  object["held_out_score"] = json_of(distribution.held_out_score);
  add_members(distribution.advice, kAdvice, object);
  add_members(distribution, kFit, object);
  add_members(distribution, kLastFieldsOfDistribution, object);
  return object;
}

std::string to_json(const Distribution& distribution) {
  return write(kDistributionFormat, distribution_object(distribution));
}

Result<Distribution> distribution_from_json(std::string_view text) {
  return read_document(text, "distribution", kDistributionFormat, [](const Reader& reader) {
    return read_distribution(reader, MixturePart::Required);
  });
}

}  // namespace kinship::json
