#include "server/store/values/audit_texts.hpp"

#include <unistd.h>

#include <utility>

#include "proto/types/names.hpp"

namespace kinship::store {

AuditEntry cut_to_fit(AuditEntry entry) {
  const auto cut = [](std::string& text, std::size_t limit) { text = cut_text(text, limit); };
  for (std::string* const word : {&entry.name, &entry.role, &entry.verb})
    cut(*word, kMaxWordBytes);
  cut(entry.client, kMaxMachineBytes);
  cut(entry.target, kMaxTargetBytes);
  for (std::string* const message : {&entry.before, &entry.after, &entry.message})
    cut(*message, kMaxMessageBytes);
  return entry;
}

AuditEntry entry_of_act(const AuditEntry& asked, AuditOutcome outcome, std::string before,
                        std::string after) {
  AuditEntry entry = asked;
  entry.outcome = outcome;
  entry.before = std::move(before);
  entry.after = std::move(after);
  return entry;
}

AuditEntry entry_of_maintenance(const std::string& verb, const std::string& store,
                                const std::string& before, const std::string& after) {
  AuditEntry entry;
  entry.client = "kinshipd of user " + std::to_string(getuid());
  entry.verb = verb;
  entry.target = store;
  entry.before = before;
  entry.after = after;
  return entry;
}

AuditEntry entry_of_migration(const std::string& store, std::int64_t before, std::int64_t after) {
  return entry_of_maintenance("migrate", store, "schema " + std::to_string(before),
                              "schema " + std::to_string(after));
}

std::string in_number(std::int64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string describe_paths(std::string_view task, std::int64_t paths) {
  return "task '" + std::string(task) + "': " + in_number(paths, "path");
}

std::string describe_robot(std::string_view label, const Digest& robot, std::int64_t paths,
                           std::int64_t attempts) {
  return "'" + std::string(label) + "' (" + robot.short_hex() + "): " + in_number(paths, "path") +
         ", " + in_number(attempts, "attempt");
}

std::string describe_removal(const RobotRemoval& removal) {
  const std::string rest =
      in_number(static_cast<std::int64_t>(removal.distributions), "distribution") + " gone";
  if (removal.is_deleted)
    return "deleted, " + rest;
  return "removed, " + in_number(static_cast<std::int64_t>(removal.paths), "path") + " retired, " +
         rest;
}

std::string describe_removal(const TaskRemoval& removal) {
  return "removed, " + in_number(static_cast<std::int64_t>(removal.paths), "path") + " retired, " +
         in_number(static_cast<std::int64_t>(removal.distributions), "distribution") + " gone";
}

std::string describe_distribution(const Distribution& distribution) {
  return "task '" + distribution.task + "', robot " + distribution.robot.short_hex() +
         ": revision " + std::to_string(distribution.revision);
}

}  // namespace kinship::store
