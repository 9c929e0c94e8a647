#include "server/store/sqlite/disk_budget.hpp"

#include <chrono>

namespace kinship::store {

std::string out_of_space_reason(const DiskSpace& space, const Writer& writer,
                                const ReaderPool& readers, std::uint64_t max_wal_bytes) {
  std::string why = space.shortage();
  if (!why.empty() || !writer.wal_full())
    return why;
  constexpr std::uint64_t kMega = std::uint64_t{1} << 20U;
  why = "the WAL holds " + std::to_string(writer.wal_bytes() / kMega) + " MB, of " +
        std::to_string(max_wal_bytes / kMega) + " MB at most, because ";
  const auto reading = readers.longest_reading();
  if (!reading)
    return why + "another program reads the store";
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(*reading).count();
  return why + "a reading has been going on for " + std::to_string(seconds) + " s";
}

void describe_disk(StoreStatus& status, const DiskSpace& space, const Writer& writer,
                   const std::string& lack) {
  std::string trouble = writer.trouble();
  if (trouble.empty())
    trouble = lack;
  status.writable = trouble.empty();
  if (!trouble.empty())
    status.message = "not writable: " + trouble + "; ";
  if (const WriterFailures failures = writer.failures(); failures.count > 0)
    status.message += std::to_string(failures.count) +
                      " failures of the disk since the start, the last: " + failures.last + "; ";
  if (const std::string ballast = space.missing_ballast(); !ballast.empty())
    status.message += ballast + "; ";
}

void describe_damage(StoreStatus& status, std::size_t damaged_robots, const std::string& findings) {
  status.damaged = damaged_robots > 0 || !findings.empty();
  if (damaged_robots > 0)
    status.message += std::to_string(damaged_robots) + " damaged robots left out; ";
  if (!findings.empty())
    status.message += "damaged: " + findings +
                      "; clients that report again mend paths, attempts and scenes, "
                      "'kinshipd repair' of the stopped server the rest; ";
}

}  // namespace kinship::store
