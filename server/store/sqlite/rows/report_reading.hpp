#pragma once

#include <cstdint>
#include <optional>

#include "server/store/rules/report_resolver.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"

/// What the rules of reports ask about one report, read as far as they ask.
namespace kinship::store {

/// Stands for the id of the new path, which is known when its row is written; no row has it.
inline constexpr std::int64_t kNewPathId = 0;

struct ReportReading {
  BatchState state;
  ExperienceKey key;                                  ///< of an acceptable one
  ReportRows rows;                                    ///< of its UUID
  SceneRows scene;                                    ///< of the content of its scene
  std::optional<std::int64_t> earlier_scene_id = {};  ///< of the report that came before
};

/// What decides whether it is acceptable: its robot, and the report that came under its UUID.
ReportReading read_report(Database& database, const PreparedAttempt& prepared);

/// The rest, of an acceptable one. Makes its task, and the row of its robot and task.
/// \param max_paths  of a robot and task; 0: no cap.
void read_pair(Database& database, const PreparedAttempt& prepared, std::uint64_t max_paths,
               ReportReading& reading);

}  // namespace kinship::store
