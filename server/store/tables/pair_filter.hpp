#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/digest.hpp"
#include "server/store/session.hpp"

namespace kinship::store {

/// Says which robots and tasks a statement reads, each empty for all.
struct PairFilter {
  std::optional<Digest> robot = {};
  std::string_view task = {};

  bool is_empty() const noexcept { return !robot && task.empty(); }

  /// A column of a table, and the SQL of what it has to be.
  struct Column {
    std::string name, id;
  };
  /// task_id and robot_id, of what it asks for, which is added to the parameters; they borrow it.
  std::vector<Column> columns(std::vector<Parameter>& parameters) const;

  /// Adds what it asks for to the parameters.
  /// \return " AND <table>.task_id = ... AND <table>.robot_id = ...", of what it asks for.
  std::string condition(const std::string& table, std::vector<Parameter>& parameters) const;
};

}  // namespace kinship::store
