#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace kinship::cli {

/// Text in aligned columns, two spaces apart; numbers to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> headings);

  /// \throws std::invalid_argument unless there is one cell per heading.
  void add_row(std::vector<std::string> cells);

  /// Headings and rows; nothing but `(none)` if there are no rows.
  void print(std::ostream& out) const;

 private:
  std::vector<std::vector<std::string>> rows_;  // headings first
};

/// ISO 8601 in UTC to the second, e.g. 2026-11-21T14:03:07Z.
std::string time_text(std::int64_t unix_ms);

/// With `digits` behind the point.
std::string number_text(double value, int digits);

std::string percent_text(double part);  ///< 0.25: "25%"

/// "1 path", "6 paths", "0 paths".
std::string count_text(std::uint64_t count, const std::string& noun);

/// "20000 of 35012" where a cap left some out, else the number alone.
std::string kept_text(std::uint64_t kept, std::uint64_t dropped);

std::string pose_text(const Eigen::Isometry3d& T_a_b);  ///< x y z qx qy qz qw

}  // namespace kinship::cli
