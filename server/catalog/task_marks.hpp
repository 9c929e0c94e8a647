#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace kinship::catalog {

/// How often the experience of a task changed since the server began: what was compared with it at
/// other marks may be outdated. Cheaper than asking the store.
struct Marks {
  std::uint64_t changes = 0;      ///< of any kind
  std::uint64_t retirements = 0;  ///< paths were taken out

  bool operator==(const Marks&) const = default;
};

/// The marks of all tasks. Not shared between threads.
class TaskMarks {
 public:
  Marks of(std::string_view task) const {
    const auto found = marks_.find(task);
    return found == marks_.end() ? Marks{} : found->second;
  }
  void grew(std::string_view task) { ++marks_[std::string(task)].changes; }
  void lost(std::string_view task) {
    Marks& marks = marks_[std::string(task)];
    ++marks.changes;
    ++marks.retirements;
  }

 private:
  std::map<std::string, Marks, std::less<>> marks_;
};

}  // namespace kinship::catalog
