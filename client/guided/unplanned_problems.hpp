#pragma once

#include <cstddef>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "proto/types/problem.hpp"

namespace kinship::guided {

/// Problems for which no search began, by reason: averages leave them out.
class UnplannedProblems {
 public:
  /// \param result  ignored without a `not_planned`.
  void add(const ProblemResult& result);

  std::size_t size() const noexcept { return size_; }
  const std::map<NotPlanned, std::size_t>& by_reason() const noexcept { return by_reason_; }

  /// "start collides: 20, goal out of reach: 4", the most frequent first.
  std::string reasons() const;

  /// The first few by name, a line each, indented, and the number of the others.
  void write_first(std::ostream& out) const;

 private:
  std::size_t size_ = 0;
  std::map<NotPlanned, std::size_t> by_reason_;
  std::vector<std::string> first_;  // "shelf-3: start collides: 'l4' touches 'wall'"
};

/// "shelf-1-0003: every goal collides"; the error of an unreadable line already begins with its
/// name.
std::string named_outcome(const ProblemResult& result, const std::string& outcome);

}  // namespace kinship::guided
