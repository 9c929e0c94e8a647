#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "server/store/store.hpp"

/// Reports by numbers, and what clients of several stores over one database did and saw.
namespace kinship::test {

/// Robots of all numbered reports.
const std::vector<store::RobotRecord>& history_robots();

/// The attempt of a number, always the same. An odd number has another UUID and the content of the
/// even one before; of five contents one is unsolved.
Attempt numbered_report(std::uint64_t number);

/// Which robot and task a number's attempt is of, and whether it brings a path.
struct ReportKey {
  std::uint32_t robot = 0, task = 0;  ///< of history_robots(); of history_task()

  std::uint32_t index() const noexcept { return 2 * robot + task; }
};
inline constexpr std::uint32_t kHistoryKeys = 4;
ReportKey key_of(std::uint64_t number);
std::string history_task(std::uint32_t task);
bool brings_path(std::uint64_t number);

/// One thing that a client did, on the clock that all processes of this machine share.
struct HistoryEntry {
  enum class Kind : std::uint32_t { Begun, Answered, Read };

  Kind kind = Kind::Begun;
  std::uint32_t client = 0;
  std::uint64_t number = 0;  ///< of the report; of a Read the generation that was seen
  std::uint32_t key = 0;     ///< ReportKey::index()
  std::uint32_t status = 0;  ///< ReceiptStatus of an answer
  std::int64_t began_ns = 0, ended_ns = 0;
};

/// A file that entries are added to by one process, several threads; whole after kill -9.
class HistoryFile {
 public:
  explicit HistoryFile(const std::filesystem::path& file);
  ~HistoryFile();
  HistoryFile(const HistoryFile&) = delete;
  HistoryFile& operator=(const HistoryFile&) = delete;

  void note(const HistoryEntry& entry) const;

 private:
  int descriptor_;
};

std::vector<HistoryEntry> read_history(const std::filesystem::path& file);
std::int64_t history_now_ns();

/// What is wrong with what clients saw and with what a store has in the end; all of it 0 if
/// nothing.
struct HistoryFaults {
  std::size_t lost = 0;       ///< reports with a receipt that are not there
  std::size_t wrong = 0;      ///< there, and not as they were reported
  std::size_t unknown = 0;    ///< attempts that nobody began
  std::size_t repeated = 0;   ///< paths whose content another one has
  std::size_t pathless = 0;   ///< contents with a receipt whose path cannot be read
  std::size_t refused = 0;    ///< answers that are final and took nothing
  std::size_t backwards = 0;  ///< readings of a generation below what this client had seen
  std::size_t behind = 0;     ///< readings that lack what had been seen or stored before they began

  bool operator==(const HistoryFaults&) const = default;
};
std::ostream& operator<<(std::ostream& stream, const HistoryFaults& faults);

/// Compares a store with what its clients know.
HistoryFaults find_faults(const store::Store& store, const std::vector<HistoryEntry>& history);

/// Numbers of reports that were answered.
std::set<std::uint64_t> answered_reports(const std::vector<HistoryEntry>& history);

}  // namespace kinship::test
