#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace kinship::cli {

/// What may happen to a column where a table is wider than its layout.
enum class Fit {
  Words,  ///< goes on in a second line, between words: nothing is lost
  Cut,    ///< loses its end, which ".." stands for: never what names a row in the next command
  Wide    ///< is shown by a wide layout only
};

struct Column {
  // NOLINTNEXTLINE(google-explicit-constructor): a heading is a column
  Column(const char* text, Fit how = Fit::Words) : heading(text), fit(how) {}
  Column(std::string text, Fit how) : heading(std::move(text)), fit(how) {}

  std::string heading;
  Fit fit;
};

/// Text in aligned columns, two spaces apart; numbers to the right. It fits the layout of the
/// stream (table_layout.hpp), unless what must stay whole is wider.
class Table {
 public:
  explicit Table(std::vector<Column> columns);

  /// \throws std::invalid_argument unless there is one cell per column.
  void add_row(std::vector<std::string> cells);

  /// Headings and rows; nothing but `(none)` if there are no rows.
  void print(std::ostream& out) const;

 private:
  std::vector<std::size_t> shown(bool is_wide) const;
  std::vector<std::size_t> widths(const std::vector<std::size_t>& columns, std::size_t most) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;  // headings first
};

/// ISO 8601 in UTC to the second, e.g. 2026-11-21T14:03:07Z.
std::string time_text(std::int64_t unix_ms);

/// With `digits` behind the point.
std::string number_text(double value, int digits);

/// How long ago, in one unit: "12s", "5m", "3h", "14d"; "-" for never (0).
std::string age_text(std::int64_t then_ms, std::int64_t now_ms);

std::int64_t now_ms();  ///< Unix time, UTC

std::string size_text(std::uint64_t bytes);  ///< "512 B", "1.2 kB", "3.4 GB", powers of 1000

std::string percent_text(double part);  ///< 0.25: "25%"

/// "1 path", "6 paths", "0 paths".
std::string count_text(std::uint64_t count, const std::string& noun);

/// "20000 of 35012" where a cap left some out, else the number alone.
std::string kept_text(std::uint64_t kept, std::uint64_t dropped);

std::string pose_text(const Eigen::Isometry3d& T_a_b);  ///< x y z qx qy qz qw

/// The same without zeros at the end, as --placement takes it: "0.5 0 0 0 0 0 1".
std::string short_pose_text(const Eigen::Isometry3d& T_a_b);

}  // namespace kinship::cli
