#pragma once

#include <array>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "proto/types/attempt.hpp"
#include "proto/types/audit.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/link_mesh.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/publications.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// The words for enumerators in output and files: lower case, stable. In the order of the
/// enumerators, which count from 0.
namespace kinship {

template <typename Enum>
struct Words;

template <>
struct Words<Outcome> {
  static constexpr std::string_view kWhat = "outcome";
  static constexpr std::array<std::string_view, 3> kWords = {"solved", "timeout", "failed"};
};
template <>
struct Words<SamplingMode> {
  static constexpr std::string_view kWhat = "sampling_mode";
  static constexpr std::array<std::string_view, 3> kWords = {"guided", "control", "uniform"};
};
template <>
struct Words<FoundBy> {
  static constexpr std::string_view kWhat = "found_by";
  static constexpr std::array<std::string_view, 5> kWords = {"nothing", "straight_line", "track",
                                                             "search", "recalled"};
};
template <>
struct Words<Guide> {
  static constexpr std::string_view kWhat = "guide";
  static constexpr std::array<std::string_view, 16> kWords = {"none",
                                                              "retreat",
                                                              "ways",
                                                              "retreat+ways",
                                                              "mixture",
                                                              "retreat+mixture",
                                                              "ways+mixture",
                                                              "retreat+ways+mixture",
                                                              "recall",
                                                              "recall+retreat",
                                                              "recall+ways",
                                                              "recall+retreat+ways",
                                                              "recall+mixture",
                                                              "recall+retreat+mixture",
                                                              "recall+ways+mixture",
                                                              "recall+retreat+ways+mixture"};
};
template <>
struct Words<DistributionState> {
  static constexpr std::string_view kWhat = "state";
  static constexpr std::array<std::string_view, 3> kWords = {"ready", "failed", "thin"};
};
template <>
struct Words<GeometryGrade> {
  static constexpr std::string_view kWhat = "geometry_grade";
  static constexpr std::array<std::string_view, 4> kWords = {"none", "partial", "approximate",
                                                             "exact"};
};
template <>
struct Words<MeshRole> {
  static constexpr std::string_view kWhat = "role";
  static constexpr std::array<std::string_view, 3> kWords = {"visual", "collision", "both"};
};
template <>
struct Words<Relation> {
  static constexpr std::string_view kWhat = "relation";
  static constexpr std::array<std::string_view, 3> kWords = {"other", "same_arm", "identical"};
};
template <>
struct Words<Weighting> {
  static constexpr std::string_view kWhat = "weighting";
  static constexpr std::array<std::string_view, 2> kWords = {"sources", "paths"};
};
template <>
struct Words<Estimator> {
  static constexpr std::string_view kWhat = "estimator";
  static constexpr std::array<std::string_view, 2> kWords = {"gmm", "kde"};
};
template <>
struct Words<EventKind> {
  static constexpr std::string_view kWhat = "kind";
  static constexpr std::array<std::string_view, 6> kWords = {"registered", "report",  "fetch",
                                                             "fit",        "refusal", "admin"};
};
template <>
struct Words<JobState> {
  static constexpr std::string_view kWhat = "state";
  static constexpr std::array<std::string_view, 5> kWords = {"queued", "running", "done", "failed",
                                                             "cancelled"};
};

template <>
struct Words<AccessRole> {
  static constexpr std::string_view kWhat = "role";
  static constexpr std::array<std::string_view, 4> kWords = {"robot", "reader", "operator",
                                                             "admin"};
};
template <>
struct Words<AuditOutcome> {
  static constexpr std::string_view kWhat = "outcome";
  static constexpr std::array<std::string_view, 4> kWords = {"begun", "done", "refused", "failed"};
};

/// The enumerator with the largest value.
template <typename Enum>
inline constexpr Enum kLastOf = static_cast<Enum>(Words<Enum>::kWords.size() - 1);

/// \throws std::invalid_argument if `value` is not an enumerator.
template <typename Enum>
requires std::is_enum_v<Enum> std::string_view to_text(Enum value) {
  const auto index = static_cast<std::size_t>(value);
  if (index >= Words<Enum>::kWords.size())
    throw std::invalid_argument("to_text: not an enumerator");
  return Words<Enum>::kWords[index];
}

/// `what: 'text' is not one of word, word`.
Error not_one_of(std::string_view what, std::string_view text,
                 std::span<const std::string_view> words);

/// \return the enumerator, or InvalidInput that lists the allowed words.
template <typename Enum>
Result<Enum> parse_word(std::string_view text) {
  for (std::size_t i = 0; i < Words<Enum>::kWords.size(); ++i)
    if (Words<Enum>::kWords[i] == text)
      return static_cast<Enum>(i);
  return not_one_of(Words<Enum>::kWhat, text, Words<Enum>::kWords);
}

}  // namespace kinship
