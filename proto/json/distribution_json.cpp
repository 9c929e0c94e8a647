#include "proto/json/distribution_json.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "proto/json/parts.hpp"
#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::json {
namespace {

OrderedJson source_object(const Source& source) {
  OrderedJson object;
  object["robot"] = source.robot.hex();
  object["label"] = source.label;
  object["paths"] = source.paths;
  object["generation"] = source.generation;
  object["poses"] = source.poses;
  object["poses_solved"] = source.poses_solved;
  object["relation"] = to_text(source.relation);
  object["paths_used"] = source.paths_used;
  object["out_of_reach"] = source.out_of_reach;
  object["outside_limits"] = source.outside_limits;
  object["not_converged"] = source.not_converged;
  object["configurations"] = source.configurations;
  object["mass"] = source.mass;
  object["colliding"] = source.colliding;
  object["tracks_tried"] = source.tracks_tried;
  object["tracks_kept"] = source.tracks_kept;
  object["random_configurations"] = source.random_configurations;
  object["filter_checks"] = source.filter_checks;
  object["self_collisions"] = source.self_collisions;
  object["scene_collisions"] = source.scene_collisions;
  object["paths_with_scene"] = source.paths_with_scene;
  object["tracks_through"] = source.tracks_through;
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
  if (const auto relation = reader.find("relation"))
    source.relation = parse_relation(relation->text(kMaxWordBytes)).value_or_throw();
  const auto read_count = [&](std::string_view member, std::uint64_t& count) {
    if (const auto value = reader.find(member))
      count = value->count();
  };
  read_count("paths_used", source.paths_used);
  read_count("out_of_reach", source.out_of_reach);
  read_count("outside_limits", source.outside_limits);
  read_count("not_converged", source.not_converged);
  read_count("configurations", source.configurations);
  if (const auto mass = reader.find("mass"))
    source.mass = mass->number(0, 1);
  read_count("colliding", source.colliding);
  read_count("tracks_tried", source.tracks_tried);
  read_count("tracks_kept", source.tracks_kept);
  read_count("random_configurations", source.random_configurations);
  read_count("filter_checks", source.filter_checks);
  read_count("self_collisions", source.self_collisions);
  read_count("scene_collisions", source.scene_collisions);
  read_count("paths_with_scene", source.paths_with_scene);
  read_count("tracks_through", source.tracks_through);
  return source;
}

OrderedJson selection_object(const Selection& selection) {
  OrderedJson object;
  object["sources"] = OrderedJson::array();
  for (const Digest& source : selection.sources)
    object["sources"].push_back(source.hex());
  object["weighting"] =
      selection.weighting ? OrderedJson(to_text(*selection.weighting)) : OrderedJson(nullptr);
  object["since_ms"] = selection.since_ms;
  return object;
}

Selection read_selection(const Reader& reader) {
  Selection selection;
  if (const auto sources = reader.find("sources"))
    for (const Reader& source : sources->elements(kMaxSelectedSources))
      selection.sources.push_back(source.digest());
  if (std::adjacent_find(selection.sources.begin(), selection.sources.end(),
                         std::greater_equal<>()) != selection.sources.end())
    reader.refuse("sources must be ascending and distinct");
  if (const auto weighting = reader.find("weighting"))
    selection.weighting = parse_weighting(weighting->text(kMaxWordBytes)).value_or_throw();
  if (const auto since = reader.find("since_ms")) {
    selection.since_ms = since->integer();
    if (selection.since_ms < 0)
      since->refuse(std::to_string(selection.since_ms) + " is negative");
  }
  return selection;
}

OrderedJson evidence_or_null(const std::optional<ArmEvidence>& evidence) {
  if (!evidence)
    return nullptr;
  OrderedJson object;
  object["attempts"] = evidence->attempts;
  object["solved"] = evidence->solved;
  object["checks_per_solution"] = evidence->checks_per_solution;
  return object;
}

std::optional<ArmEvidence> read_evidence(const Reader& advice, std::string_view arm) {
  const auto reader = advice.find(arm);
  if (!reader)
    return std::nullopt;
  ArmEvidence evidence;
  evidence.attempts = reader->at("attempts").count();
  evidence.solved = reader->at("solved").count(evidence.attempts);
  evidence.checks_per_solution = reader->at("checks_per_solution").number(0);
  return evidence;
}

OrderedJson recent_list(const std::vector<JudgedAttempt>& recent) {
  OrderedJson list = OrderedJson::array();
  for (const JudgedAttempt& attempt : recent)
    list.push_back({{"arm", to_text(attempt.arm)},
                    {"solved", attempt.solved},
                    {"checks", attempt.checks},
                    {"age", attempt.age}});
  return list;
}

JudgedAttempt read_judged_attempt(const Reader& reader) {
  JudgedAttempt attempt;
  const Reader arm = reader.at("arm");
  attempt.arm = parse_arm(arm.text(kMaxWordBytes)).value_or_throw();
  if (attempt.arm == Arm::Uniform)
    arm.refuse("must be guided or control");
  attempt.solved = reader.at("solved").boolean();
  attempt.checks = reader.at("checks").count();
  attempt.age =
      static_cast<std::uint32_t>(reader.at("age").count(std::numeric_limits<std::uint32_t>::max()));
  return attempt;
}

void read_recent(const Reader& reader, Advice& advice) {
  for (const Reader& attempt : reader.elements(kMaxJudgedAttempts)) {
    advice.recent.push_back(read_judged_attempt(attempt));
    if (advice.recent.size() > 1 && advice.recent.back().age > advice.recent.rbegin()[1].age)
      attempt.refuse("is older than the one before, must be oldest first");
  }
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
  distribution.profile = reader.at("profile").text(kMaxProfileBytes);
  distribution.engines = reader.at("engines").text(kMaxMessageBytes);
  for (const Reader& source : reader.at("sources").elements(kMaxSources))
    distribution.sources.push_back(read_source(source));
}

OrderedJson curve_or_null(const std::vector<ComponentScore>& scores) {
  if (scores.empty())
    return nullptr;
  OrderedJson curve = OrderedJson::array();
  for (const ComponentScore& score : scores)
    curve.push_back({{"K", score.components}, {"score", score.score}});
  return curve;
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

OrderedJson cuts_or_null(const std::vector<std::optional<double>>& cuts) {
  if (cuts.empty())
    return nullptr;
  OrderedJson list = OrderedJson::array();
  for (const std::optional<double>& cut : cuts)
    list.push_back(cut ? OrderedJson(*cut) : OrderedJson(nullptr));
  return list;
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

OrderedJson fit_or_null(const std::optional<FitOrigin>& fit) {
  if (!fit)
    return nullptr;
  return {{"from_revision", fit->from_revision},
          {"full_revision", fit->full_revision},
          {"paths", fit->paths},
          {"new_paths", fit->new_paths},
          {"transferred", fit->transferred},
          {"reason", fit->reason}};
}

FitOrigin read_fit(const Reader& reader) {
  FitOrigin fit;
  fit.from_revision = reader.at("from_revision").count();
  fit.full_revision = reader.at("full_revision").count(fit.from_revision);
  fit.paths = reader.at("paths").count();
  fit.new_paths = reader.at("new_paths").count(fit.paths);
  fit.transferred = reader.at("transferred").count(fit.paths);
  fit.reason = reader.at("reason").text(kMaxMessageBytes);
  return fit;
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
  distribution.advice.guided = read_evidence(reader, "guided");
  distribution.advice.control = read_evidence(reader, "control");
  if (const auto recent = reader.find("recent"))
    read_recent(*recent, distribution.advice);
  if (const auto selection = reader.find("selection"))
    distribution.selection = read_selection(*selection);
  if (const auto curve = reader.find("k_curve"))
    distribution.component_scores = read_curve(*curve);
  if (const auto fitted = reader.find("fitted_ms"))
    distribution.fitted_ms = fitted->integer();
  if (const auto time = reader.find("transfer_time_s"))
    distribution.transfer_time_s = time->number(0);
  if (const auto time = reader.find("fit_time_s"))
    distribution.fit_time_s = time->number(0);
  if (const auto fit = reader.find("fit"))
    distribution.fit = read_fit(*fit);
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
  read_provenance(reader, distribution);
  read_optional_members(reader, distribution);
  distribution.state =
      parse_distribution_state(reader.at("state").text(kMaxWordBytes)).value_or_throw();
  distribution.limits = read_limits(reader.at("limits"));
  distribution.advice.recommended_share = reader.at("recommended_share").number(0, 1);
  distribution.advice.guided_share = distribution.advice.recommended_share;  // of older files
  if (const auto share = reader.find("guided_share"))
    distribution.advice.guided_share = share->number(0, 1);
  if (const auto cuts = reader.find("cuts"))
    distribution.cuts = read_cuts(*cuts, distribution.limits.cols());
  distribution.mixture = read_mixture_part(reader, distribution, mixture);
  return distribution;
}

OrderedJson distribution_object(const Distribution& distribution) {
  OrderedJson object;
  object["id"] = distribution.id.hex();
  object["revision"] = distribution.revision;
  object["store_epoch"] = distribution.store_epoch.text();
  object["task"] = distribution.task;
  object["robot"] = distribution.robot.hex();
  object["T_task_base"] = pose_or_null(distribution.T_task_base);
  object["profile"] = distribution.profile;
  object["selection"] = selection_object(distribution.selection);
  object["engines"] = distribution.engines;
  OrderedJson sources = OrderedJson::array();
  for (const Source& source : distribution.sources)
    sources.push_back(source_object(source));
  object["sources"] = std::move(sources);
  object["configurations"] = distribution.configurations;
  add_mixture(distribution.mixture, object);
  object["limits"] = list_of_columns(distribution.limits);
  object["cuts"] = cuts_or_null(distribution.cuts);
  object["k_curve"] = curve_or_null(distribution.component_scores);
  object["held_out_score"] = distribution.held_out_score ? OrderedJson(*distribution.held_out_score)
                                                         : OrderedJson(nullptr);
  object["recommended_share"] = distribution.advice.recommended_share;
  object["guided_share"] = distribution.advice.guided_share;
  object["evidence"] = distribution.advice.evidence;
  object["guided"] = evidence_or_null(distribution.advice.guided);
  object["control"] = evidence_or_null(distribution.advice.control);
  object["recent"] = recent_list(distribution.advice.recent);
  object["state"] = to_text(distribution.state);
  object["reason"] = distribution.reason;
  object["fitted_ms"] = distribution.fitted_ms;
  object["transfer_time_s"] = distribution.transfer_time_s;
  object["fit_time_s"] = distribution.fit_time_s;
  object["fit"] = fit_or_null(distribution.fit);
  return object;
}

std::string to_json(const Distribution& distribution) {
  return write(distribution_object(distribution));
}

Result<Distribution> distribution_from_json(std::string_view text) {
  return read_document(text, "distribution", [](const Reader& reader) {
    return read_distribution(reader, MixturePart::Required);
  });
}

}  // namespace kinship::json
