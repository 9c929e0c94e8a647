#include "proto/json/distribution_json.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::json {
namespace {

constexpr std::size_t kMaxWordBytes = 64;

OrderedJson source_object(const Source& source) {
  OrderedJson object;
  object["robot"] = source.robot.hex();
  object["label"] = source.label;
  object["paths"] = source.paths;
  object["generation"] = source.generation;
  object["poses"] = source.poses;
  object["poses_solved"] = source.poses_solved;
  return object;
}

Source read_source(const Reader& reader) {
  Source source;
  source.robot = reader.at("robot").digest();
  if (const auto label = reader.find("label"))
    source.label = label->text(kMaxLabelBytes);
  source.paths = reader.at("paths").count();
  source.generation = reader.at("generation").count();
  source.poses = reader.at("poses").count();
  source.poses_solved = reader.at("poses_solved").count();
  return source;
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
  Eigen::VectorXd weights = reader.at("weights").vector(kMaxComponents);
  Eigen::MatrixXd means = reader.at("means").columns(kMaxDof, kMaxComponents);
  std::vector<Eigen::MatrixXd> covariances;
  for (const Reader& covariance : reader.at("covariances").elements(kMaxComponents))
    covariances.push_back(covariance.columns(kMaxDof, kMaxDof));
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

void read_provenance(const Reader& reader, Distribution& distribution) {
  distribution.id = reader.at("id").digest();
  distribution.revision = reader.at("revision").count();
  distribution.store_epoch = reader.at("store_epoch").uuid();
  distribution.task = reader.at("task").text(kMaxTaskBytes);
  if (const auto error = check_task(distribution.task))
    throw Failure(*error);
  distribution.robot = reader.at("robot").digest();
  if (const auto placement = reader.find("T_task_base"))
    distribution.T_task_base = placement->pose();
  distribution.profile = reader.at("profile").text(kMaxLabelBytes);
  distribution.engines = reader.at("engines").text(kMaxMessageBytes);
  for (const Reader& source : reader.at("sources").elements(kMaxSources))
    distribution.sources.push_back(read_source(source));
}

void read_optional_members(const Reader& reader, Distribution& distribution) {
  if (const auto reason = reader.find("reason"))
    distribution.reason = reason->text(kMaxMessageBytes);
  if (const auto configurations = reader.find("configurations"))
    distribution.configurations = configurations->count();
  if (const auto score = reader.find("held_out_score"))
    distribution.held_out_score = score->number();
  if (const auto evidence = reader.find("evidence"))
    distribution.advice.evidence = evidence->text(kMaxMessageBytes);
  if (const auto fitted = reader.find("fitted_ms"))
    distribution.fitted_ms = fitted->integer();
  if (const auto time = reader.find("transfer_time_s"))
    distribution.transfer_time_s = time->number(0);
  if (const auto time = reader.find("fit_time_s"))
    distribution.fit_time_s = time->number(0);
}

Distribution read_distribution(const Reader& reader) {
  Distribution distribution;
  read_provenance(reader, distribution);
  read_optional_members(reader, distribution);
  distribution.state =
      parse_distribution_state(reader.at("state").text(kMaxWordBytes)).value_or_throw();
  distribution.limits = read_limits(reader.at("limits"));
  distribution.advice.recommended_share = reader.at("recommended_share").number(0, 1);
  if (const auto cuts = reader.find("cuts"))
    cuts->refuse("not supported yet, must be null");
  if (distribution.state == DistributionState::Ready) {
    distribution.mixture = read_mixture(reader);
    if (distribution.mixture->dimension() != distribution.limits.cols())
      throw Failure(ErrorCode::InvalidInput,
                    "limits: " + std::to_string(distribution.limits.cols()) +
                        " joints, means have " + std::to_string(distribution.mixture->dimension()));
  } else if (const auto weights = reader.find("weights")) {
    weights->refuse("must be null if state is 'failed'");
  }
  return distribution;
}

}  // namespace

std::string to_json(const Distribution& distribution) {
  OrderedJson object;
  object["id"] = distribution.id.hex();
  object["revision"] = distribution.revision;
  object["store_epoch"] = distribution.store_epoch.text();
  object["task"] = distribution.task;
  object["robot"] = distribution.robot.hex();
  object["T_task_base"] = pose_or_null(distribution.T_task_base);
  object["profile"] = distribution.profile;
  object["engines"] = distribution.engines;
  OrderedJson sources = OrderedJson::array();
  for (const Source& source : distribution.sources)
    sources.push_back(source_object(source));
  object["sources"] = std::move(sources);
  object["configurations"] = distribution.configurations;
  add_mixture(distribution.mixture, object);
  object["limits"] = list_of_columns(distribution.limits);
  object["cuts"] = nullptr;
  object["k_curve"] = nullptr;
  object["held_out_score"] = distribution.held_out_score ? OrderedJson(*distribution.held_out_score)
                                                         : OrderedJson(nullptr);
  object["recommended_share"] = distribution.advice.recommended_share;
  object["evidence"] = distribution.advice.evidence;
  object["state"] = to_text(distribution.state);
  object["reason"] = distribution.reason;
  object["fitted_ms"] = distribution.fitted_ms;
  object["transfer_time_s"] = distribution.transfer_time_s;
  object["fit_time_s"] = distribution.fit_time_s;
  return write(object);
}

Result<Distribution> distribution_from_json(std::string_view text) {
  return read_document(text, "distribution", read_distribution);
}

}  // namespace kinship::json
