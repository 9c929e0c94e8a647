#include "proto/types/enum_text.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace kinship {
namespace {

template <typename Enum, std::size_t count>
using Words = std::array<std::pair<Enum, std::string_view>, count>;

constexpr Words<Outcome, 3> kOutcomes = {
    {{Outcome::Solved, "solved"}, {Outcome::Timeout, "timeout"}, {Outcome::Failed, "failed"}}};
constexpr Words<Arm, 3> kArms = {
    {{Arm::Guided, "guided"}, {Arm::Control, "control"}, {Arm::Uniform, "uniform"}}};
constexpr Words<DistributionState, 3> kDistributionStates = {{{DistributionState::Ready, "ready"},
                                                              {DistributionState::Failed, "failed"},
                                                              {DistributionState::Thin, "thin"}}};

constexpr Words<Relation, 3> kRelations = {{{Relation::Other, "other"},
                                            {Relation::SameArm, "same_arm"},
                                            {Relation::Identical, "identical"}}};
constexpr Words<Weighting, 2> kWeightings = {
    {{Weighting::Sources, "sources"}, {Weighting::Paths, "paths"}}};
constexpr Words<EventKind, 6> kEventKinds = {{{EventKind::Registered, "registered"},
                                              {EventKind::Report, "report"},
                                              {EventKind::Fetch, "fetch"},
                                              {EventKind::Fit, "fit"},
                                              {EventKind::Refusal, "refusal"},
                                              {EventKind::Administration, "admin"}}};
constexpr Words<JobState, 5> kJobStates = {{{JobState::Queued, "queued"},
                                            {JobState::Running, "running"},
                                            {JobState::Done, "done"},
                                            {JobState::Failed, "failed"},
                                            {JobState::Cancelled, "cancelled"}}};

template <typename Enum, std::size_t count>
std::string_view find_word(const Words<Enum, count>& words, Enum value) {
  for (const auto& [enumerator, word] : words)
    if (enumerator == value)
      return word;
  throw std::invalid_argument("to_text: not an enumerator");
}

template <typename Enum, std::size_t count>
Result<Enum> find_enumerator(const Words<Enum, count>& words, std::string_view what,
                             std::string_view text) {
  constexpr std::size_t kMaxShown = 40;
  std::string allowed;
  for (const auto& [enumerator, word] : words) {
    if (word == text)
      return enumerator;
    allowed += (allowed.empty() ? "" : ", ") + std::string(word);
  }
  return Error{ErrorCode::InvalidInput, std::string(what) + ": '" +
                                            std::string(text.substr(0, kMaxShown)) +
                                            "' is not one of " + allowed};
}

}  // namespace

std::string_view to_text(Outcome outcome) { return find_word(kOutcomes, outcome); }
std::string_view to_text(Arm arm) { return find_word(kArms, arm); }
std::string_view to_text(DistributionState state) { return find_word(kDistributionStates, state); }
std::string_view to_text(Relation relation) { return find_word(kRelations, relation); }
std::string_view to_text(Weighting weighting) { return find_word(kWeightings, weighting); }
std::string_view to_text(EventKind kind) { return find_word(kEventKinds, kind); }
std::string_view to_text(JobState state) { return find_word(kJobStates, state); }

Result<Outcome> parse_outcome(std::string_view text) {
  return find_enumerator(kOutcomes, "outcome", text);
}

Result<Arm> parse_arm(std::string_view text) { return find_enumerator(kArms, "arm", text); }

Result<DistributionState> parse_distribution_state(std::string_view text) {
  return find_enumerator(kDistributionStates, "state", text);
}

Result<Relation> parse_relation(std::string_view text) {
  return find_enumerator(kRelations, "relation", text);
}

Result<Weighting> parse_weighting(std::string_view text) {
  return find_enumerator(kWeightings, "weighting", text);
}

Result<JobState> parse_job_state(std::string_view text) {
  return find_enumerator(kJobStates, "state", text);
}

}  // namespace kinship
