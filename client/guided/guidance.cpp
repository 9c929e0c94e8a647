#include "client/guided/guidance.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "proto/evidence/machine_speed.hpp"
#include "proto/types/enum_text.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::guided {
namespace {

GuidanceAnswer refusal(NoGuidance why, std::string message) {
  return {std::nullopt, std::nullopt, why, std::move(message)};
}

std::string formatted(const char* format, double value) {
  char text[24];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// How the run's queries will be planned.
std::string describe(const SamplingModeChooser& sampling, double guided_fraction) {
  constexpr double kPercent = 100;
  const double guided = sampling.guided_part();
  if (guided_fraction == 0)
    return "uniform";
  const std::string words = "share " + formatted("%.2f", guided_fraction);
  if (sampling.is_sampling())
    return words + ", the first query guided with probability " + formatted("%.2f", guided);
  if (guided == 1)
    return words;
  return words + ", " + formatted("%.3g", kPercent * (1 - guided)) +
         " % of the queries uniform as control";
}

std::string describe(const Distribution& distribution) {
  std::string text =
      "distribution " + distribution.id.short_hex() + " revision " +
      std::to_string(distribution.revision) + ", " + std::to_string(distribution.mixture->size()) +
      (distribution.mixture->shares_covariance() ? " kernels of " : " components fitted to ") +
      std::to_string(distribution.configurations) + " configurations from ";
  for (std::size_t i = 0; i < distribution.sources.size(); ++i) {
    const Source& source = distribution.sources[i];
    text += (i == 0 ? "" : ", ") +
            (source.label.empty() ? source.robot.short_hex() : source.label) + " (" +
            std::to_string(source.paths) + " paths)";
  }
  return text;
}

std::string describe(const TaskExperience& experience) {
  return std::to_string(experience.paths.size()) + " stored ways of the hand, chosen from " +
         std::to_string(experience.paths_known);
}

/// "80 paths to recall, planned for 40 recorded queries, 12 of them its own".
std::string describe(const RecallLibrary& library) {
  const auto own =
      std::ranges::count_if(library.queries, [](const auto& query) { return !query.is_synthetic; });
  return std::to_string(library.paths.size()) + " paths to recall, planned for " +
         std::to_string(library.queries.size()) + " recorded queries, " + std::to_string(own) +
         " of them its own";
}

/// "rehearsed on 50 queries: guide retreat+ways".
std::string describe(const Rehearsal& rehearsal) {
  if (rehearsal.queries == 0 && !rehearsal.message.empty())
    return rehearsal.message;
  return "rehearsed on " + std::to_string(rehearsal.queries) + " recorded queries" +
         (rehearsal.is_complete ? "" : " so far") + ": guide " +
         std::string(to_text(rehearsal.guide)) +
         (rehearsal.message.empty() ? "" : " (" + rehearsal.message + ")");
}

/// Why a distribution cannot guide this robot; empty if it can.
std::string validate(const Distribution& distribution, Eigen::Index dof) {
  const std::string name = "distribution " + distribution.id.short_hex();
  if (!distribution.mixture || distribution.mixture->dimension() != dof)
    return name + " has no mixture over " + std::to_string(dof) + " joints";
  const double told = distribution.advice.guided_share;
  if (!(told >= 0 && told <= 1))
    return name + " has guided share " + std::to_string(told) + ", must be 0 to 1";
  return "";
}

bool needs_server(const GuidanceOptions& wanted) {
  return !wanted.guide || needs_experience(*wanted.guide);
}

/// The rehearsal's; as long as it has none, what costs less than all guides together. Where no
/// recorded query could be planned it has no costs, and says that none helps.
Guide guide_by(const Rehearsal* rehearsal, bool are_ways) {
  if (rehearsal != nullptr && (!rehearsal->costs.empty() || rehearsal->guide == Guide::None))
    return rehearsal->guide;
  return are_ways ? Guide::RecallRetreatWays : Guide::All;
}

/// Guidance by the distribution, the experience, or both; with neither by the robot alone.
GuidanceAnswer answer_with(const Distribution* distribution, KnownExperience known,
                           const Rehearsal* rehearsal, const GuidanceOptions& wanted) {
  const Guide guide = wanted.guide.value_or(guide_by(rehearsal, known.ways != nullptr));
  SamplingModeOptions sampling = wanted.sampling;
  if (guide == Guide::None)
    sampling.guided_fraction = 0;
  Advice advice;
  advice.guided_share = advice.recommended_share = 1;
  if (distribution != nullptr)
    advice = distribution->advice;
  GuidanceAnswer answer;
  Guidance& guidance = answer.guidance.emplace();
  guidance.guided_fraction = guided::guided_fraction(advice, sampling);
  guidance.guide = guide;
  if (distribution != nullptr) {
    guidance.distribution_id = distribution->id;
    guidance.revision = distribution->revision;
    guidance.mixture = distribution->mixture;
    answer.message = describe(*distribution);
  }
  if (!needs_server(wanted))
    answer.message = "guide " + std::string(to_text(guide)) + ", which needs no experience";
  else if (known.ways)
    answer.message += (answer.message.empty() ? "" : "; ") + describe(known.ways->experience());
  if (known.recall)
    answer.message += (answer.message.empty() ? "" : "; ") + describe(known.recall->library());
  if (rehearsal != nullptr && !wanted.guide)
    answer.message += "; " + describe(*rehearsal);
  guidance.experience = std::move(known.ways);
  guidance.recall = std::move(known.recall);
  answer.sampling.emplace(advice, sampling);
  answer.message += "; " + describe(*answer.sampling, guidance.guided_fraction);
  if (!advice.evidence.empty())
    answer.message += " (" + advice.evidence + ")";
  if (distribution != nullptr && !distribution->reason.empty())
    answer.message += "; warning: " + distribution->reason;
  if (distribution != nullptr && !distribution->filters.empty())
    answer.message += "; filters: " + distribution->filters;
  return answer;
}

std::string or_else(const std::string& message, const std::string& otherwise) {
  return message.empty() ? otherwise : message;
}

/// The answer if there is nothing to guide with.
GuidanceAnswer without_guidance(const FetchReply& reply, const GuidanceOptions& wanted) {
  switch (reply.status) {
    case FetchStatus::Ready:
      return refusal(NoGuidance::Failed, reply.distribution
                                             ? validate(*reply.distribution, wanted.dof)
                                             : "the server sent no distribution");
    case FetchStatus::NoExperience:
      return refusal(NoGuidance::NoExperience,
                     or_else(reply.message, "no experience with task '" + wanted.task + "'"));
    case FetchStatus::UnknownRobot:
      return refusal(
          NoGuidance::NotFound,
          or_else(reply.message, "the server does not know robot " + wanted.robot.short_hex()));
    case FetchStatus::Failed:
      return refusal(NoGuidance::NotFound,
                     or_else(reply.distribution ? reply.distribution->reason : reply.message,
                             "nothing could be transferred or fitted"));
    case FetchStatus::Pending:
      return refusal(NoGuidance::Failed, "the distribution is still being made after " +
                                             std::to_string(wanted.wait.count()) + " ms");
    case FetchStatus::Busy:
      return refusal(NoGuidance::Failed, or_else(reply.message, "the server is busy"));
    case FetchStatus::Refused:
      break;
  }
  return refusal(NoGuidance::Failed, or_else(reply.message, "the server refused the request"));
}

/// Whether a library can guide this robot.
bool is_for(const RecallLibrary& library, Eigen::Index dof) {
  return !library.paths.empty() && library.queries.front().start.size() == dof;
}

}  // namespace

GuidanceAnswer fetch_guidance(const Fetch& fetch, const GuidanceOptions& wanted,
                              const std::optional<Eigen::Isometry3d>& T_task_base,
                              KnownExperience known) {
  if (!needs_server(wanted)) {
    if (!known.ways && wanted.chain)
      known.ways = std::make_shared<planning::ExperienceGuide>(*wanted.chain, TaskExperience{});
    return answer_with(nullptr, std::move(known), nullptr, wanted);
  }
  FetchRequest request;
  request.task = wanted.task;
  request.robot = wanted.robot;
  request.T_task_base = T_task_base;
  request.profile = wanted.profile;
  request.selection = wanted.selection;
  request.deadline = wanted.wait;
  if (wanted.chain) {
    request.experience_bytes = kDefaultExperienceBytes;
    request.known_experience = known.ways ? known.ways->experience().revision : 0;
    request.known_recall = known.recall ? known.recall->library().revision : 0;
    request.rehearsed = wanted.rehearsed;
    request.start.assign(wanted.start.begin(), wanted.start.end());
    request.T_task_goal = wanted.T_task_goal;
    request.to_configuration = wanted.to_configuration;
  }
  const Result<FetchReply> reply = fetch(request);
  if (!reply) {
    const bool nobody = reply.error().code == ErrorCode::Unavailable;
    return refusal(nobody ? NoGuidance::NoServer : NoGuidance::Failed, reply.error().message);
  }
  if (wanted.chain && reply->experience && !reply->experience->paths.empty())
    known.ways = std::make_shared<planning::ExperienceGuide>(*wanted.chain, *reply->experience);
  if (wanted.chain && reply->recall)
    known.recall = is_for(*reply->recall, wanted.dof)
                       ? std::make_shared<recall::RecallGuide>(*wanted.chain, *reply->recall)
                       : nullptr;
  const bool is_usable = reply->status == FetchStatus::Ready && reply->distribution &&
                         validate(*reply->distribution, wanted.dof).empty();
  if (!is_usable && !known.ways && !known.recall)
    return without_guidance(*reply, wanted);
  GuidanceAnswer answer = answer_with(is_usable ? &*reply->distribution : nullptr, std::move(known),
                                      reply->rehearsal ? &*reply->rehearsal : nullptr, wanted);
  if (needs_experience(answer.guidance->guide))
    answer.guidance->T_task_base = T_task_base.value_or(Eigen::Isometry3d::Identity());
  return answer;
}

GuidanceCache::Key GuidanceCache::key_of(const std::optional<Eigen::Isometry3d>& T_task_base) {
  if (!T_task_base)
    return std::nullopt;
  return to_pose_array(snapped(*T_task_base));
}

std::pair<const GuidanceAnswer&, bool> GuidanceCache::ask(
    const std::optional<Eigen::Isometry3d>& T_task_base, const GuidanceOptions& wanted) {
  const Key key = key_of(T_task_base);
  if (const auto known = answers_.find(key); known != answers_.end())
    return {known->second, false};
  GuidanceAnswer answer = server_missing_
                              ? refusal(NoGuidance::NoServer, "no server answered before")
                              : fetch_guidance(fetch_, wanted, T_task_base, known_);
  if (answer.why_not == NoGuidance::NoServer)
    server_missing_ = true;
  if (answer.guidance)
    known_ = {answer.guidance->experience, answer.guidance->recall};
  // The answer's is of the same task and robot as those before, and newer; without a server it
  // knows nothing.
  if (answer.sampling && (needs_server(wanted) || !sampling_))
    sampling_ = answer.sampling;
  return {answers_.emplace(key, std::move(answer)).first->second, true};
}

std::pair<const GuidanceAnswer&, bool> GuidanceCache::ask(const Problem& problem) {
  GuidanceOptions wanted = wanted_;
  wanted.T_task_goal = problem.T_task_goal;
  wanted.to_configuration = problem.goal_configurations.cols() == 1;
  if (!problem.T_task_goal && wanted.chain && problem.goal_configurations.cols() > 0 &&
      problem.goal_configurations.rows() == wanted.dof)
    wanted.T_task_goal =
        problem.T_task_base.value_or(Eigen::Isometry3d::Identity()) *
        kinematics::T_base_transfer(*wanted.chain, problem.goal_configurations.col(0));
  return ask(problem.T_task_base, wanted);
}

QueryGuidance GuidanceCache::choose(const Problem& problem) const {
  const auto known = answers_.find(key_of(problem.T_task_base));
  if (known == answers_.end())
    return {.why_not = "nobody was asked for guidance at its placement"};
  if (!known->second.guidance)
    return {.why_not = known->second.message};
  return {.guidance = &*known->second.guidance,
          .sampling_mode = sampling_->choose(sampling_mode_seed(problem)),
          .recall_trust = recall_trust_.value()};
}

void GuidanceCache::add(const PlannedProblem& planned) {
  recall_trust_.add(planned.recall_expected, planned.result.found_by == FoundBy::Recalled);
  if (sampling_)
    sampling_->add(planned.result.sampling_mode, planned.outcome, planned.result.collision_checks,
                   planned.result.processor_time_s * evidence::machine_speed());
}

}  // namespace kinship::guided
