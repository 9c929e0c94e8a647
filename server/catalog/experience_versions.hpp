#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace kinship::catalog {

/// Number of changes of a task's experience since the server began: a comparison at another version
/// may be outdated. Cheaper than asking the store.
struct ExperienceVersion {
  std::uint64_t changes = 0;      ///< of any kind
  std::uint64_t retirements = 0;  ///< paths were taken out

  bool operator==(const ExperienceVersion&) const = default;
};

/// The version of all tasks. Not shared between threads.
class ExperienceVersions {
 public:
  ExperienceVersion of(std::string_view task) const {
    const auto found = versions_.find(task);
    return found == versions_.end() ? ExperienceVersion{} : found->second;
  }
  void grew(std::string_view task) { ++versions_[std::string(task)].changes; }
  void lost(std::string_view task) {
    ExperienceVersion& version = versions_[std::string(task)];
    ++version.changes;
    ++version.retirements;
  }

 private:
  std::map<std::string, ExperienceVersion, std::less<>> versions_;
};

}  // namespace kinship::catalog
