#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/sqlite/database/database.hpp"

/// Short texts by name, among the settings of the store.
namespace kinship::store {

std::map<std::string, std::string> select_notes(Database& database, std::string_view prefix);

void write_notes(Database& database,
                 const std::map<std::string, std::optional<std::string>>& notes);

}  // namespace kinship::store
