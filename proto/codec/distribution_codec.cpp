#include "proto/codec/distribution_codec.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/fields.hpp"
#include "proto/codec/mixture_codec.hpp"
#include "proto/codec/selection_codec.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::codec {
namespace {

constexpr std::size_t kMaxEnginesBytes = 128;

constexpr const char* kOfSource = " of a source";

constexpr std::size_t kLastFields = offsetof(kinship_wire_Distribution, filters);
static_assert(size_of_message<kinship_wire_Distribution>(kLastFieldsOfDistribution, kLastFields) ==
              sizeof(kinship_wire_Distribution));

void check_evidence(std::string_view mode, const std::optional<ModeEvidence>& evidence,
                    Rules& rules) {
  if (!evidence)
    return;
  const std::string what(mode);
  rules
      .that(evidence->solved <= evidence->attempts, what + ": " + std::to_string(evidence->solved) +
                                                        " solved of " +
                                                        std::to_string(evidence->attempts))
      .not_negative(what + ": checks_per_solution", evidence->checks_per_solution);
}

void check_recent(const std::vector<JudgedAttempt>& recent, Rules& rules) {
  rules.at_most("recent", recent.size(), kMaxJudgedAttempts);
  for (std::size_t i = 0; i < recent.size() && !rules.broken(); ++i) {
    rules.that(recent[i].sampling_mode != SamplingMode::Uniform,
               "recent: an attempt of sampling_mode uniform");
    if (i > 0)
      rules.that(recent[i].age <= recent[i - 1].age,
                 "recent: age " + std::to_string(recent[i].age) + " after " +
                     std::to_string(recent[i - 1].age) + ", must be oldest first");
  }
}

void check_scores(const std::vector<ComponentScore>& scores, Rules& rules) {
  rules.at_most("component_scores", scores.size(), kMaxComponentScores);
  for (std::size_t i = 0; i < scores.size() && !rules.broken(); ++i) {
    rules.finite("component_scores: score", scores[i].score)
        .that(scores[i].components >= 1,
              "component_scores: " + std::to_string(scores[i].components) + " components");
    if (i > 0)
      rules.that(scores[i].components < scores[i - 1].components,
                 "component_scores: " + std::to_string(scores[i].components) + " after " +
                     std::to_string(scores[i - 1].components) + " components, must fall");
  }
}

void write_cuts(const std::vector<std::optional<double>>& cuts, Arena& arena,
                kinship_wire_Distribution& wire) {
  arena.resize(wire.cuts, cuts.size() - static_cast<std::size_t>(
                                            std::count(cuts.begin(), cuts.end(), std::nullopt)));
  std::size_t next = 0;
  for (std::size_t joint = 0; joint < cuts.size(); ++joint)
    if (cuts[joint]) {
      wire.cuts._buffer[next].joint = static_cast<std::uint32_t>(joint);
      wire.cuts._buffer[next++].angle = *cuts[joint];
    }
}

/// \param joints  of the distribution.
std::vector<std::optional<double>> read_cuts(const kinship_wire_Distribution& wire,
                                             std::size_t joints, Reader& reader) {
  const auto entries = elements(wire.cuts);
  std::vector<std::optional<double>> cuts(entries.empty() ? 0 : joints);
  std::int64_t previous = -1;
  for (const kinship_wire_JointCut& entry : entries) {
    reader.rules.that(entry.joint > previous, "cuts: joint " + std::to_string(entry.joint) +
                                                  " after joint " + std::to_string(previous));
    previous = entry.joint;
    reader.rules.that(entry.joint < joints, "cuts: joint " + std::to_string(entry.joint) + " of " +
                                                std::to_string(joints));
    if (entry.joint < joints)
      cuts[entry.joint] = entry.angle;
  }
  return cuts;
}

void check_cuts(const std::vector<std::optional<double>>& cuts, std::size_t joints, Rules& rules) {
  rules.that(cuts.empty() || cuts.size() == joints, "cuts: " + std::to_string(cuts.size()) +
                                                        " entries for " + std::to_string(joints) +
                                                        " joints");
  for (const std::optional<double>& cut : cuts)
    rules.finite("cuts", cut.value_or(0));
}

void check_fit(const std::optional<FitOrigin>& fit, Rules& rules) {
  if (!fit)
    return;
  const auto at_most = [&rules](const char* part, std::uint64_t count, const char* whole,
                                std::uint64_t limit) {
    rules.that(count <= limit, std::string("fit: ") + part + " " + std::to_string(count) +
                                   " exceeds " + whole + " " + std::to_string(limit));
  };
  at_most("full_revision", fit->full_revision, "from_revision", fit->from_revision);
  at_most("new_paths", fit->new_paths, "paths", fit->paths);
  at_most("transferred", fit->transferred, "paths", fit->paths);
  check_fields(*fit, rules, " of a full fit");
}

void check_limits(const Eigen::Matrix2Xd& limits, Rules& rules) {
  rules.at_most("limits", static_cast<std::size_t>(limits.cols()), kMaxDof)
      .that(limits.allFinite(), "limits: not all finite");
  for (Eigen::Index joint = 0; joint < limits.cols() && !rules.broken(); ++joint)
    if (limits(0, joint) > limits(1, joint))
      rules.that(false, "limits: joint " + std::to_string(joint + 1) + " from " +
                            std::to_string(limits(0, joint)) + " to " +
                            std::to_string(limits(1, joint)));
}

}  // namespace

std::optional<Error> validate(const Distribution& distribution) {
  Rules rules;
  rules.name(check_task(distribution.task))
      .text("profile", distribution.profile, kMaxProfileBytes)
      .text("engines", distribution.engines, kMaxEnginesBytes)
      .text("reason", distribution.reason, kMaxMessageBytes)
      .text("evidence", distribution.advice.evidence, kMaxMessageBytes)
      .at_most("sources", distribution.sources.size(), kMaxSources)
      .between("recommended_share", distribution.advice.recommended_share, 0, 1)
      .between("guided_share", distribution.advice.guided_share, 0, 1)
      .finite("held_out_score", distribution.held_out_score.value_or(0))
      .not_negative("transfer_time_s", distribution.transfer_time_s)
      .not_negative("fit_time_s", distribution.fit_time_s);
  if (distribution.T_task_base)
    rules.pose("T_task_base", *distribution.T_task_base);
  check_members<kLastFieldsOfDistribution>(distribution, rules);
  for (const Source& source : distribution.sources)
    check_fields(source, rules, kOfSource);
  check_selection(distribution.selection, rules);
  check_evidence("guided", distribution.advice.guided, rules);
  check_evidence("control", distribution.advice.control, rules);
  check_recent(distribution.advice.recent, rules);
  check_limits(distribution.limits, rules);
  check_scores(distribution.component_scores, rules);
  check_cuts(distribution.cuts, static_cast<std::size_t>(distribution.limits.cols()), rules);
  check_fit(distribution.fit, rules);
  const auto& mixture = distribution.mixture;
  rules.that(mixture.has_value() == has_mixture(distribution.state),
             mixture ? "mixture: given although failed" : "mixture: missing although not failed");
  if (mixture)
    check_mixture(*mixture, rules);
  if (mixture)
    rules.that(mixture->dimension() == distribution.limits.cols(),
               "mixture: dimension " + std::to_string(mixture->dimension()) +
                   " differs from that of the limits, " +
                   std::to_string(distribution.limits.cols()));
  return rules.broken();
}

void write_part(const Distribution& distribution, Arena& arena, kinship_wire_Distribution& wire) {
  write_digest(distribution.id, wire.id);
  wire.revision = distribution.revision;
  write_uuid(distribution.store_epoch, wire.store_epoch);
  wire.task = arena.text(distribution.task);
  write_digest(distribution.robot, wire.robot);
  write_placement(arena, distribution.T_task_base, wire.T_task_base);
  wire.profile = arena.text(distribution.profile);
  wire.engines = arena.text(distribution.engines);
  wire.state = static_cast<std::uint32_t>(distribution.state);
  wire.reason = arena.text(distribution.reason);
  write_value(distribution.sources, {}, arena, wire.sources);
  wire.configurations = distribution.configurations;
  if (distribution.mixture)
    write_mixture(*distribution.mixture, arena, wire);
  write_numbers(arena, distribution.limits.data(),
                static_cast<std::size_t>(distribution.limits.size()), wire.limits);
  if (distribution.held_out_score)
    write_numbers(arena, &*distribution.held_out_score, 1, wire.held_out_score);
  wire.recommended_share = distribution.advice.recommended_share;
  wire.evidence = arena.text(distribution.advice.evidence);
  wire.fitted_ms = distribution.fitted_ms;
  wire.transfer_time_s = distribution.transfer_time_s;
  wire.fit_time_s = distribution.fit_time_s;
  write_part(distribution.selection, arena, wire.selection);
  write_value(distribution.advice.guided, {}, arena, wire.guided);
  write_value(distribution.advice.control, {}, arena, wire.control);
  wire.guided_share = distribution.advice.guided_share;
  write_value(distribution.advice.recent, {}, arena, wire.recent);
  write_value(distribution.component_scores, {}, arena, wire.component_scores);
  write_cuts(distribution.cuts, arena, wire);
  write_value(distribution.fit, {}, arena, wire.fit);
  write_members(distribution, kLastFieldsOfDistribution, kLastFields, arena, wire);
}

void read_part(const kinship_wire_Distribution& wire, Reader& reader, Distribution& distribution) {
  distribution.id = read_digest(wire.id);
  distribution.revision = wire.revision;
  distribution.store_epoch = read_uuid(wire.store_epoch);
  distribution.task = read_text(wire.task);
  distribution.robot = read_digest(wire.robot);
  distribution.T_task_base = reader.placement("T_task_base", elements(wire.T_task_base));
  distribution.profile = read_text(wire.profile);
  distribution.engines = read_text(wire.engines);
  distribution.state = reader.enumerator("state", wire.state, DistributionState::Thin);
  distribution.reason = read_text(wire.reason);
  distribution.configurations = wire.configurations;
  const auto limits = elements(wire.limits);
  reader.rules.at_most("sources", wire.sources._length, kMaxSources)
      .at_most("recent", wire.recent._length, kMaxJudgedAttempts)
      .at_most("component_scores", wire.component_scores._length, kMaxComponentScores)
      .at_most("cuts", wire.cuts._length, kMaxDof)
      .at_most("limits (numbers)", limits.size(), 2 * kMaxDof)
      .that(limits.size() % 2 == 0, "limits: an odd number of numbers");
  if (reader.rules.broken())
    return;
  distribution.sources =
      read_value<std::vector<Source>>({"a source"}, wire.sources, {.limit = kMaxSources}, reader);
  distribution.limits = Eigen::Map<const Eigen::Matrix2Xd>(
      limits.data(), 2, static_cast<Eigen::Index>(limits.size() / 2));
  distribution.mixture = read_mixture(wire, limits.size() / 2, reader);
  distribution.held_out_score =
      reader.optional_number("held_out_score", elements(wire.held_out_score));
  distribution.advice.recommended_share = wire.recommended_share;
  distribution.advice.evidence = read_text(wire.evidence);
  distribution.fitted_ms = wire.fitted_ms;
  distribution.transfer_time_s = wire.transfer_time_s;
  distribution.fit_time_s = wire.fit_time_s;
  read_part(wire.selection, reader, distribution.selection);
  distribution.advice.guided =
      read_value<std::optional<ModeEvidence>>({"guided"}, wire.guided, {}, reader);
  distribution.advice.control =
      read_value<std::optional<ModeEvidence>>({"control"}, wire.control, {}, reader);
  distribution.advice.guided_share = wire.guided_share;
  distribution.advice.recent = read_value<std::vector<JudgedAttempt>>(
      {"a recent attempt"}, wire.recent, {.limit = kMaxJudgedAttempts}, reader);
  for (const kinship_wire_ComponentScore& entry : elements(wire.component_scores))
    reader.rules.at_most("component_scores: components", entry.components, kMaxComponents);
  distribution.component_scores = read_value<std::vector<ComponentScore>>(
      {"component_scores"}, wire.component_scores, {.limit = kMaxComponentScores}, reader);
  distribution.cuts = read_cuts(wire, limits.size() / 2, reader);
  distribution.fit = read_value<std::optional<FitOrigin>>({"a full fit"}, wire.fit, {}, reader);
  read_members(wire, kLastFieldsOfDistribution, kLastFields, reader, distribution);
}

}  // namespace kinship::codec
