#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/session.hpp"

/// Short texts by name: settings of the store, and notes of its server.
namespace kinship::store {

/// Empty if there is none.
std::string read_setting(Session& session, std::string_view key);

/// Makes or changes a setting; without a value, deletes it.
void write_setting(Session& session, std::string_view key, const std::optional<std::string>& value);

/// Notes whose names begin with `prefix`, by name.
std::map<std::string, std::string> select_notes(Session& session, std::string_view prefix);

/// Makes, changes and deletes notes, as write_setting() does.
void write_notes(Session& session, const std::map<std::string, std::optional<std::string>>& notes);

}  // namespace kinship::store
