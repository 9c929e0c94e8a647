#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "proto/types/uuid.hpp"
#include "server/store/shared_report.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"

/// Which reports' paths were retired: a list that only grows, and that other stores are told.
namespace kinship::store {

/// Whether the path of a report is retired wherever it comes from.
bool is_report_retired(Database& database, const Uuid& report_uuid);

/// \return whether it was not among them before.
bool note_retired_report(Database& database, const Uuid& report_uuid);

/// Notes every report whose path this is: the one that brought it, and those of the same content.
void note_retired_path(Database& database, const ExperienceKey& key, std::int64_t path_id);

/// Notes that the content of a report is that of a path which is there.
void note_same_content(Database& database, std::int64_t path_id, const Uuid& report_uuid);

/// A page of Store::list_retirements(). \throws Failure(InvalidInput) for a cursor of another list.
Feed<Uuid> page_of_retirements(Database& database, std::string_view cursor, std::size_t limit);

}  // namespace kinship::store
