#include "tests/faults/report_history.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "tests/support/store_values.hpp"

namespace kinship::test {
namespace {

void compare_attempts(const store::Store& store, const std::set<std::uint64_t>& begun,
                      const std::set<std::uint64_t>& answered, HistoryFaults& faults) {
  std::size_t stored = 0;
  for (const std::uint64_t number : begun) {
    const Attempt wanted = numbered_report(number);
    const std::optional<Attempt> found = store.find_attempt(wanted.report_uuid);
    stored += found ? 1U : 0U;
    if (found && !is_as_reported(*found, wanted))
      ++faults.wrong;
    if (!found && answered.contains(number))
      ++faults.lost;
  }
  faults.unknown = store.status().attempts - stored;
}

void compare_paths(const store::Store& store, const std::set<std::uint64_t>& answered,
                   HistoryFaults& faults) {
  constexpr std::size_t kAll = 100'000'000;
  std::set<std::vector<double>> contents;
  std::size_t read = 0;
  for (const store::RobotRecord& robot : history_robots())
    for (std::uint32_t task = 0; task < 2; ++task)
      for (const store::StoredPath& path :
           store.read_paths(robot.digest, history_task(task), {.limit = kAll})) {
        ++read;
        contents.emplace(path.path.waypoints().reshaped().begin(),
                         path.path.waypoints().reshaped().end());
      }
  faults.repeated = read - contents.size();
  for (const std::uint64_t number : answered) {
    if (!brings_path(number))
      continue;
    const Attempt wanted = numbered_report(number);
    const std::vector<double> content(wanted.path->waypoints().reshaped().begin(),
                                      wanted.path->waypoints().reshaped().end());
    if (!contents.contains(content))
      ++faults.pathless;
  }
}

/// The beginning or the end of a reading, or of a report that was stored.
struct Moment {
  std::int64_t at_ns = 0;
  bool is_end = false;
  std::size_t entry = 0;  // of the history
};

bool raises_generation(const HistoryEntry& entry) {
  return entry.kind == HistoryEntry::Kind::Answered && brings_path(entry.number) &&
         static_cast<ReceiptStatus>(entry.status) == ReceiptStatus::Stored;
}

std::vector<Moment> moments_of(const std::vector<HistoryEntry>& history) {
  std::vector<Moment> moments;
  for (std::size_t i = 0; i < history.size(); ++i) {
    if (history[i].kind != HistoryEntry::Kind::Read && !raises_generation(history[i]))
      continue;
    moments.push_back({history[i].began_ns, false, i});
    moments.push_back({history[i].ended_ns, true, i});
  }
  std::sort(moments.begin(), moments.end(),
            [](const Moment& a, const Moment& b) { return a.at_ns < b.at_ns; });
  return moments;
}

/// Who begins to read sees at least what any reading that had ended saw, and more than what was
/// seen before a report that was stored since.
void judge_readings(const std::vector<HistoryEntry>& history, HistoryFaults& faults) {
  std::array<std::uint64_t, kHistoryKeys> known{};
  std::map<std::size_t, std::uint64_t> known_at_begin;                    // by entry
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> seen;  // by client and key
  for (const Moment& moment : moments_of(history)) {
    const HistoryEntry& entry = history[moment.entry];
    const bool is_read = entry.kind == HistoryEntry::Kind::Read;
    const std::uint32_t key = is_read ? entry.key : key_of(entry.number).index();
    if (!moment.is_end) {
      known_at_begin[moment.entry] = known.at(key);
      continue;
    }
    const std::uint64_t before = known_at_begin[moment.entry];
    known.at(key) = std::max(known.at(key), is_read ? entry.number : before + 1);
    if (!is_read)
      continue;
    std::uint64_t& of_client = seen[{entry.client, key}];
    faults.behind += entry.number < before ? 1U : 0U;
    faults.backwards += entry.number < of_client ? 1U : 0U;
    of_client = std::max(of_client, entry.number);
  }
}

}  // namespace

const std::vector<store::RobotRecord>& history_robots() {
  static const std::vector<store::RobotRecord> kRobots = {make_robot("ur5e", 601),
                                                          make_robot("gen3", 602)};
  return kRobots;
}

std::string history_task(std::uint32_t task) { return task == 0 ? "stack" : "shelf"; }

bool brings_path(std::uint64_t number) { return number / 2 % 5 != 4; }

ReportKey key_of(std::uint64_t number) {
  const std::uint64_t content = number / 2;
  return {static_cast<std::uint32_t>(content % 2), static_cast<std::uint32_t>(content / 2 % 2)};
}

Attempt numbered_report(std::uint64_t number) {
  const ReportKey key = key_of(number);
  const Digest& robot = history_robots()[key.robot].digest;
  Attempt attempt = make_attempt(robot, history_task(key.task), number / 2);
  attempt.report_uuid = id_from<Uuid>(number);
  attempt.record.collision_checks = number;
  if (!brings_path(number)) {
    attempt.record.outcome = Outcome::Timeout;
    attempt.path.reset();
  }
  return attempt;
}

HistoryFile::HistoryFile(const std::filesystem::path& file)
    : descriptor_(open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0)
    throw std::runtime_error("cannot open " + file.string());
}

HistoryFile::~HistoryFile() { close(descriptor_); }

void HistoryFile::note(const HistoryEntry& entry) const {
  if (write(descriptor_, &entry, sizeof entry) != sizeof entry)
    throw std::runtime_error("cannot write the history");
}

std::vector<HistoryEntry> read_history(const std::filesystem::path& file) {
  std::vector<HistoryEntry> entries;
  std::ifstream stream(file, std::ios::binary);
  HistoryEntry entry;
  while (stream.read(reinterpret_cast<char*>(&entry), sizeof entry))
    entries.push_back(entry);
  return entries;
}

std::int64_t history_now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

std::set<std::uint64_t> answered_reports(const std::vector<HistoryEntry>& history) {
  std::set<std::uint64_t> answered;
  for (const HistoryEntry& entry : history)
    if (entry.kind == HistoryEntry::Kind::Answered)
      answered.insert(entry.number);
  return answered;
}

HistoryFaults find_faults(const store::Store& store, const std::vector<HistoryEntry>& history) {
  HistoryFaults faults;
  std::set<std::uint64_t> begun, answered;
  for (const HistoryEntry& entry : history) {
    if (entry.kind == HistoryEntry::Kind::Begun)
      begun.insert(entry.number);
    if (entry.kind != HistoryEntry::Kind::Answered)
      continue;
    const auto status = static_cast<ReceiptStatus>(entry.status);
    if (status == ReceiptStatus::Refused || status == ReceiptStatus::UnknownRobot)
      ++faults.refused;
    else
      answered.insert(entry.number);
  }
  compare_attempts(store, begun, answered, faults);
  compare_paths(store, answered, faults);
  judge_readings(history, faults);
  return faults;
}

std::ostream& operator<<(std::ostream& stream, const HistoryFaults& faults) {
  return stream << "lost " << faults.lost << ", wrong " << faults.wrong << ", unknown "
                << faults.unknown << ", repeated " << faults.repeated << ", pathless "
                << faults.pathless << ", refused " << faults.refused << ", backwards "
                << faults.backwards << ", behind " << faults.behind;
}

}  // namespace kinship::test
