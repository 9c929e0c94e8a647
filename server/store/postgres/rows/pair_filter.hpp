#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "proto/types/digest.hpp"
#include "server/store/postgres/database/parameters.hpp"

namespace kinship::store::postgres {

/// Says which robots and tasks a statement reads, each empty for all.
struct PairFilter {
  std::optional<Digest> robot = {};
  std::string_view task = {};

  bool is_empty() const noexcept { return !robot && task.empty(); }

  /// Adds what it asks for to the parameters.
  /// \return " AND <table>.robot_id = ... AND <table>.task_id = ...", of what it asks for.
  std::string condition(const std::string& table, Parameters& parameters) const;
};

}  // namespace kinship::store::postgres
