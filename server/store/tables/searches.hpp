#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/types/search_record.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"
#include "server/store/values/experience_key.hpp"
#include "server/store/values/prepared_attempt.hpp"

/// Search records, beside the attempts that brought them; see ExperienceStore. A damaged one counts
/// as missing.
namespace kinship::store {

void insert_search(Session& session, const PreparedAttempt& prepared, const ExperienceKey& key,
                   std::int64_t received_ms);

/// Nothing if it is missing, or damaged.
std::optional<SearchRecord> select_search(Session& session, const Uuid& report_uuid);

/// In words why an attempt failed, as for its listing; nothing if it has no record.
std::optional<std::string> select_why(Session& session, const Uuid& report_uuid);

/// Bytes of all records, about. From an index.
std::uint64_t count_search_bytes(Session& session);

/// Deletes the oldest records beyond the limits, some hundred at most.
/// \return whether there may be more.
bool trim_searches(Session& session, const SearchLimits& limits, std::int64_t now_ms);

/// Deletes the records of a report, or of a robot and task.
void drop_search_of(Session& session, const Uuid& report_uuid);
void drop_searches_of(Session& session, const ExperienceKey& key);

/// Whether a row is there as it was written, maybe by another version.
bool is_search_sound(Session& session, std::int64_t row);

/// Deletes a row; a damaged one may stay. A page that SQLite cannot read fails the transaction.
void drop_search(Session& session, std::int64_t row);

}  // namespace kinship::store
