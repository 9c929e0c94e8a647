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
constexpr Words<DistributionState, 2> kDistributionStates = {
    {{DistributionState::Ready, "ready"}, {DistributionState::Failed, "failed"}}};

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

Result<Outcome> parse_outcome(std::string_view text) {
  return find_enumerator(kOutcomes, "outcome", text);
}

Result<Arm> parse_arm(std::string_view text) { return find_enumerator(kArms, "arm", text); }

Result<DistributionState> parse_distribution_state(std::string_view text) {
  return find_enumerator(kDistributionStates, "state", text);
}

}  // namespace kinship
