#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace kinship::bench {

/// Configurations of paths and what each weighs.
struct Rows {
  Eigen::MatrixXd configurations;      // d x N
  Eigen::VectorXd weights;             // N
  std::vector<std::uint32_t> path_of;  // N, counted from 0 without gaps
};

/// The rows of some of the paths, with these counted anew.
inline Rows rows_of(const Rows& rows, const std::vector<std::uint8_t>& is_wanted) {
  std::vector<Eigen::Index> columns;
  std::map<std::uint32_t, std::uint32_t> numbers;
  Rows part;
  for (std::size_t i = 0; i < rows.path_of.size(); ++i) {
    if (is_wanted[rows.path_of[i]] == 0)
      continue;
    columns.push_back(static_cast<Eigen::Index>(i));
    part.path_of.push_back(
        numbers.emplace(rows.path_of[i], static_cast<std::uint32_t>(numbers.size())).first->second);
  }
  part.configurations = rows.configurations(Eigen::all, columns);
  part.weights = rows.weights(columns);
  return part;
}

/// What `kinship configurations export` writes.
/// \throws std::runtime_error if the file is none.
inline Rows read_rows(const std::string& file) {
  std::ifstream stream(file);
  std::string line, cell;
  if (!std::getline(stream, line) || !line.starts_with("path_id,"))
    throw std::runtime_error("'" + file + "' holds no exported configurations");
  std::vector<std::string> names;
  for (std::istringstream header(line); std::getline(header, cell, ',');)
    names.push_back(cell);
  Rows rows;
  std::map<std::string, std::uint32_t> numbers;
  std::vector<double> values, weights;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    for (const std::string& name : names) {
      if (!std::getline(cells, cell, ','))
        throw std::runtime_error("'" + file + "': too few cells in '" + line + "'");
      if (name == "path_id")
        rows.path_of.push_back(
            numbers.emplace(cell, static_cast<std::uint32_t>(numbers.size())).first->second);
      else if (name == "weight")
        weights.push_back(std::stod(cell));
      else if (name.starts_with("q_"))
        values.push_back(std::stod(cell));
    }
  }
  const auto count = static_cast<Eigen::Index>(weights.size());
  if (count == 0)
    throw std::runtime_error("'" + file + "' has no rows");
  rows.configurations = Eigen::Map<const Eigen::MatrixXd>(
      values.data(), static_cast<Eigen::Index>(values.size()) / count, count);
  rows.weights = Eigen::Map<const Eigen::VectorXd>(weights.data(), count);
  return rows;
}

}  // namespace kinship::bench
