#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/store/store.hpp"

namespace kinship::test {

/// What a store answers to everything that it can be asked, as texts by what was asked; without
/// times of arrival, counts and revisions, which damage and its repair may change.
using Answers = std::map<std::string, std::string>;

/// What was put into a store.
struct StoredThings {
  std::vector<store::RobotRecord> robots;
  std::vector<std::string> tasks;
  std::vector<Attempt> attempts;
  std::vector<Distribution> distributions;
};

/// Asks everything. What the store refuses is left out, if it refuses in words (Failure).
Answers ask_everything(const store::Store& store, const StoredThings& things);

/// The answers that are not among the right ones, each with what it should have been.
std::vector<std::string> wrong_ones(const Answers& answers, const Answers& right);

}  // namespace kinship::test
