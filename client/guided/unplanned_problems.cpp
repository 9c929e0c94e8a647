#include "client/guided/unplanned_problems.hpp"

#include <algorithm>
#include <functional>
#include <ostream>
#include <utility>

namespace kinship::guided {
namespace {

constexpr std::size_t kFirstTold = 3;

}  // namespace

std::string named_outcome(const ProblemResult& result, const std::string& outcome) {
  return outcome.starts_with(result.name + ":") ? outcome : result.name + ": " + outcome;
}

void UnplannedProblems::add(const ProblemResult& result) {
  if (!result.not_planned)
    return;
  ++size_;
  ++by_reason_[*result.not_planned];
  if (first_.size() < kFirstTold)
    first_.push_back(named_outcome(result, result.reason));
}

std::string UnplannedProblems::reasons() const {
  std::vector<std::pair<NotPlanned, std::size_t>> counts(by_reason_.begin(), by_reason_.end());
  std::ranges::stable_sort(counts, std::greater{}, [](const auto& each) { return each.second; });
  std::string text;
  for (const auto& [reason, count] : counts) {
    std::string words(to_text(reason));
    std::ranges::replace(words, '_', ' ');
    text += (text.empty() ? "" : ", ") + words + ": " + std::to_string(count);
  }
  return text;
}

void UnplannedProblems::write_first(std::ostream& out) const {
  for (const std::string& line : first_)
    out << "  " << line << '\n';
  if (size_ > first_.size())
    out << "  and " << size_ - first_.size() << " more\n";
}

}  // namespace kinship::guided
