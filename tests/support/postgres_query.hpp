#pragma once

#include <string>

namespace kinship::test {

/// Runs SQL over a connection of its own. \return rows by lines, values by tabs, as psql -At.
/// Commits wait for no standby, so that a test may look in at any time.
/// \throws std::runtime_error with PostgreSQL's message.
std::string query_postgres(const std::string& url, const std::string& sql);

/// Asks until the answer is "t". \throws std::runtime_error with the last answer after a minute.
void wait_until_true(const std::string& url, const std::string& sql);

}  // namespace kinship::test
