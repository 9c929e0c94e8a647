#include "server/catalog/judged_attempts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "proto/evidence/attempt_window.hpp"

namespace kinship::catalog {
namespace {

std::uint32_t older(std::uint32_t age, std::uint32_t by) {
  return age + std::min(by, std::numeric_limits<std::uint32_t>::max() - age);
}

enum class Origin { Own, Unknown, Other };

Origin origin_of(const store::KnownAttempt& attempt, const Context& context,
                 const Contexts& contexts) {
  const auto found =
      attempt.distribution_id ? contexts.find(*attempt.distribution_id) : contexts.end();
  if (found == contexts.end() || found->second == Context{})
    return Origin::Unknown;
  return found->second == context ? Origin::Own : Origin::Other;
}

/// The planner with most attempts of the context, then of unknown origin.
std::string usual_planner(std::span<const store::KnownAttempt> known,
                          const std::vector<Origin>& origins) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> counts;  // own, unknown
  for (std::size_t i = 0; i < known.size(); ++i)
    if (origins[i] != Origin::Other) {
      auto& [own, unknown] = counts[known[i].planner];
      ++(origins[i] == Origin::Own ? own : unknown);
    }
  const auto most =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? std::string() : most->first;
}

}  // namespace

JudgedAttempts judged_attempts(const Context& context, const Contexts& contexts,
                               std::span<const store::KnownAttempt> known) {
  std::vector<Origin> origins;
  for (const store::KnownAttempt& one : known)
    origins.push_back(origin_of(one, context, contexts));
  JudgedAttempts judged;
  judged.planner = usual_planner(known, origins);
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (origins[i] == Origin::Other || known[i].planner != judged.planner)
      continue;
    JudgedAttempt one = known[i].judged;
    if (origins[i] == Origin::Own)
      ++(one.sampling_mode == SamplingMode::Guided ? judged.guided : judged.control);
    else
      one.age = older(one.age, kAgeOfUnknown);
    judged.attempts.push_back(one);
  }
  std::stable_sort(judged.attempts.begin(), judged.attempts.end(),
                   [](const JudgedAttempt& a, const JudgedAttempt& b) { return a.age > b.age; });
  judged.attempts = evidence::AttemptWindow(std::move(judged.attempts)).recent();
  return judged;
}

void add_newest(std::vector<store::KnownAttempt>& known, store::KnownAttempt newest) {
  const SamplingMode mode = newest.judged.sampling_mode;
  const auto is_of_mode = [mode](const store::KnownAttempt& one) {
    return one.judged.sampling_mode == mode;
  };
  for (store::KnownAttempt& one : known)
    one.judged.age = older(one.judged.age, 1);
  const auto count = std::count_if(known.begin(), known.end(), is_of_mode);
  if (count >= static_cast<std::ptrdiff_t>(store::kKnownAttemptsPerMode))
    known.erase(std::find_if(known.begin(), known.end(), is_of_mode));
  newest.judged.age = 0;
  known.push_back(std::move(newest));
}

}  // namespace kinship::catalog
