#include "client/cli/table.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <iomanip>
#include <limits>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "client/cli/table_layout.hpp"
#include "proto/types/characters.hpp"
#include "proto/types/pose.hpp"

namespace kinship::cli {
namespace {

constexpr std::size_t kGap = 2;          // between columns
constexpr std::size_t kLeastCut = 6;     // of a column that is cut
constexpr std::string_view kCut = "..";  // for what was cut

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789.+-eE%") == std::string::npos &&
         text.find_first_of("0123456789") != std::string::npos;
}

std::string cut_to(const std::string& text, std::size_t width) {
  if (character_count(text) <= width)
    return text;
  std::size_t left = width - std::min(width, kCut.size());
  std::size_t bytes = 0;
  while (bytes < text.size() && (left > 0 || !begins_character(text[bytes])))
    left -= begins_character(text[bytes++]) ? 1U : 0U;
  return text.substr(0, bytes) + std::string(kCut);
}

/// Lines of whole words; a word that is longer than the width has a line of its own.
std::vector<std::string> lines_of(const std::string& text, std::size_t width) {
  if (character_count(text) <= width)
    return {text};
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    if (!line.empty() && character_count(line) + 1 + character_count(word) > width)
      lines.push_back(word);
    else
      line += (line.empty() ? "" : " ") + word;
  }
  return lines;
}

std::size_t longest_word(const std::string& text) {
  std::size_t longest = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;)
    longest = std::max(longest, character_count(word));
  return longest;
}

std::vector<std::string> laid_out(const std::string& cell, Fit fit, std::size_t width) {
  return fit == Fit::Cut ? std::vector{cut_to(cell, width)} : lines_of(cell, width);
}

/// \param row  the lines of each cell.
void print_row(const std::vector<std::vector<std::string>>& row,
               const std::vector<std::size_t>& widths, const std::vector<bool>& right,
               std::ostream& out) {
  const std::size_t height = std::ranges::max(row, {}, &std::vector<std::string>::size).size();
  for (std::size_t number = 0; number < height; ++number) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string text = number < row[i].size() ? row[i][number] : "";
      const std::string padding(widths[i] - character_count(text), ' ');
      line += right[i] ? padding + text : text + padding;
      line += std::string(kGap, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  rows_.emplace_back();
  for (const Column& column : columns_)
    rows_.front().push_back(column.heading);
}

void Table::add_row(std::vector<std::string> cells) {
  if (cells.size() != columns_.size())
    throw std::invalid_argument("Table: a row needs one cell per heading");
  rows_.push_back(std::move(cells));
}

std::vector<std::size_t> Table::shown(bool is_wide) const {
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < columns_.size(); ++column)
    if (is_wide || columns_[column].fit != Fit::Wide)
      columns.push_back(column);
  return columns;
}

std::vector<std::size_t> Table::widths(const std::vector<std::size_t>& columns,
                                       std::size_t most) const {
  std::vector<std::size_t> widths, least;
  for (const std::size_t column : columns) {
    std::size_t natural = 0, words = 0;
    for (const auto& row : rows_) {
      natural = std::max(natural, character_count(row[column]));
      words = std::max(words, longest_word(row[column]));
    }
    widths.push_back(natural);
    least.push_back(columns_[column].fit == Fit::Cut ? std::min(natural, kLeastCut) : words);
  }
  std::size_t total = kGap * (columns.size() - 1);
  for (const std::size_t width : widths)
    total += width;
  for (; total > most; --total) {  // the widest that can gives way
    std::size_t widest = widths.size();
    for (std::size_t i = 0; i < widths.size(); ++i)
      if (widths[i] > least[i] && (widest == widths.size() || widths[i] > widths[widest]))
        widest = i;
    if (widest == widths.size())
      break;
    --widths[widest];
  }
  return widths;
}

void Table::print(std::ostream& out) const {
  if (rows_.size() == 1) {
    out << "(none)\n";
    return;
  }
  const TableLayout layout = table_layout(out);
  const std::vector<std::size_t> columns = shown(layout.is_wide);
  const std::vector<std::size_t> most =
      widths(columns, layout.is_wide ? std::numeric_limits<std::size_t>::max() : layout.width);
  std::vector<std::vector<std::vector<std::string>>> cells(rows_.size());
  std::vector<std::size_t> used(columns.size(), 0);
  std::vector<bool> right(columns.size(), true);
  for (std::size_t row = 0; row < rows_.size(); ++row)
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string& cell = rows_[row][columns[i]];
      cells[row].push_back(laid_out(cell, columns_[columns[i]].fit, most[i]));
      for (const std::string& line : cells[row].back())
        used[i] = std::max(used[i], character_count(line));
      if (row > 0 && !is_number(cell))
        right[i] = false;
    }
  for (const auto& row : cells)
    print_row(row, used, right, out);
}

std::string time_text(std::int64_t unix_ms) {
  const std::time_t seconds = unix_ms / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return {text.data(), size};
}

std::string number_text(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string age_text(std::int64_t then_ms, std::int64_t now_ms) {
  if (then_ms <= 0)
    return "-";
  constexpr std::int64_t kMinute_s = 60, kHour_s = 60 * kMinute_s, kDay_s = 24 * kHour_s;
  const std::int64_t age_s = std::max<std::int64_t>(0, now_ms - then_ms) / 1000;
  if (age_s < 2 * kMinute_s)
    return std::to_string(age_s) + "s";
  if (age_s < 2 * kHour_s)
    return std::to_string(age_s / kMinute_s) + "m";
  if (age_s < 2 * kDay_s)
    return std::to_string(age_s / kHour_s) + "h";
  return std::to_string(age_s / kDay_s) + "d";
}

std::int64_t now_ms() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

std::string size_text(std::uint64_t bytes) {
  constexpr double kStep = 1000;
  if (bytes < static_cast<std::uint64_t>(kStep))
    return std::to_string(bytes) + " B";
  auto size = static_cast<double>(bytes);
  const char* unit = "";
  for (const char* const next : {"kB", "MB", "GB", "TB"})
    if (size >= kStep) {
      size /= kStep;
      unit = next;
    }
  return number_text(size, 1) + " " + unit;
}

std::string percent_text(double part) { return number_text(100 * part, 0) + "%"; }

std::string kept_text(std::uint64_t kept, std::uint64_t dropped) {
  return std::to_string(kept) + (dropped > 0 ? " of " + std::to_string(kept + dropped) : "");
}

std::string count_text(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string pose_text(const Eigen::Isometry3d& T_a_b) {
  constexpr int kDigits = 4;
  std::string text;
  for (const double number : to_pose_array(T_a_b))
    text += (text.empty() ? "" : " ") + number_text(number, kDigits);
  return text;
}

std::string short_pose_text(const Eigen::Isometry3d& T_a_b) {
  std::istringstream numbers(pose_text(T_a_b));
  std::string text;
  for (std::string number; numbers >> number;) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.ends_with('.'))
      number.pop_back();
    text += (text.empty() ? "" : " ") + (number == "-0" ? "0" : number);
  }
  return text;
}

}  // namespace kinship::cli
