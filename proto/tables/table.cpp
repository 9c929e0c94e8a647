#include "proto/tables/table.hpp"

#include <algorithm>
#include <limits>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "proto/tables/table_layout.hpp"
#include "proto/types/characters.hpp"

namespace kinship::tables {
namespace {

constexpr std::size_t kGap = 2;          // between columns
constexpr std::size_t kLeastCut = 6;     // of a column that is cut
constexpr std::string_view kCut = "..";  // for a part that was cut

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
                                       const TableLayout& layout) const {
  const std::size_t most = layout.is_wide ? std::numeric_limits<std::size_t>::max() : layout.width;
  std::vector<std::size_t> widths, least;
  for (const std::size_t column : columns) {
    std::size_t natural = 0, words = 0;
    for (const auto& row : rows_) {
      natural = std::max(natural, character_count(row[column]));
      words = std::max(words, longest_word(row[column]));
    }
    widths.push_back(natural);
    const bool is_cut = columns_[column].fit == Fit::Cut;
    least.push_back(!is_cut ? words : layout.cuts ? std::min(natural, kLeastCut) : natural);
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
  const std::vector<std::size_t> most = widths(columns, layout);
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

}  // namespace kinship::tables
