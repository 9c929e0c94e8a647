#pragma once

#include <memory>
#include <string>

namespace kinship::test {

/// A table of PostgreSQL that nobody else may read or write while this lives: whoever tries waits,
/// so that a test decides what happens meanwhile.
class LockedTable {
 public:
  /// \throws std::runtime_error with PostgreSQL's message.
  LockedTable(const std::string& url, const std::string& table);
  LockedTable(const LockedTable&) = delete;
  LockedTable& operator=(const LockedTable&) = delete;
  ~LockedTable();

  /// Until so many wait for it. \throws std::runtime_error after a minute.
  void wait_until_wanted_by(int sessions) const;

 private:
  struct Session;
  std::string url_, table_;
  std::unique_ptr<Session> session_;
};

}  // namespace kinship::test
