#include "server/store/moving/verification.hpp"

#include <algorithm>
#include <bit>
#include <set>
#include <span>
#include <utility>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/values/bytes.hpp"
#include "server/store/values/codes.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/path_content.hpp"
#include "server/store/values/scene_blob.hpp"

namespace kinship::store::moving {
namespace {

constexpr std::size_t kRowsCompared = 128;  // at once; of 4 MB at most
constexpr std::size_t kMaxMessages = 10;    // of a table

/// The names of the columns that are not the same; empty: it is one row. Numbers by their bits.
std::string differing_columns(const MovedTable& table, const MovedRow& source,
                              const MovedRow& target) {
  std::string names;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const auto* const one = std::get_if<double>(&source[i]);
    const auto* const other = std::get_if<double>(&target[i]);
    const bool is_same =
        one != nullptr && other != nullptr
            ? std::bit_cast<std::uint64_t>(*one) == std::bit_cast<std::uint64_t>(*other)
            : source[i] == target[i];
    if (!is_same)
      names += (names.empty() ? "" : ", ") + table.columns[i].name;
  }
  return names;
}

Bytes bytes_of(const MovedTable& table, const MovedRow& row, const std::string& column) {
  const auto* const text = std::get_if<std::string>(&row[table.column(column)]);
  if (text == nullptr)
    return {};
  return {reinterpret_cast<const std::uint8_t*>(text->data()), text->size()};
}

std::int64_t number_of(const MovedTable& table, const MovedRow& row, const std::string& column) {
  return integer_of(row, table.column(column));
}

bool has_column(const MovedTable& table, const std::string& column) {
  return std::ranges::find(table.columns, column, &MovedColumn::name) != table.columns.end();
}

std::string words_of(const Cell& cell) {
  if (const auto* const integer = std::get_if<std::int64_t>(&cell))
    return std::to_string(*integer);
  const auto* const text = std::get_if<std::string>(&cell);
  return text == nullptr ? "" : "'" + *text + "'";
}

std::uint32_t checksum_of(const MovedTable& table, const MovedRow& row) {
  if (table.name == "path")
    return PathContent{bytes_of(table, row, "report_uuid"), bytes_of(table, row, "T_task_base"),
                       number_of(table, row, "dof"),        number_of(table, row, "waypoint_count"),
                       number_of(table, row, "encoding"),   bytes_of(table, row, "waypoints")}
        .crc();
  if (table.name == "scene")
    return static_cast<std::uint32_t>(
        scene_crc(bytes_of(table, row, "content_sha256"), number_of(table, row, "size"),
                  number_of(table, row, "encoding"), bytes_of(table, row, "scene")));
  return crc32c(bytes_of(table, row, "payload"));
}

/// A row's name for people: "path 7 (report 0194...)".
std::string describe_row(const MovedTable& table, const MovedRow& row) {
  if (has_column(table, "report_uuid"))
    return table.name + " " + words_of(row[0]) + " (report " +
           id_of<Uuid>(bytes_of(table, row, "report_uuid")).text() + ")";
  if (has_column(table, "label"))
    return table.name + " " + words_of(row[table.column("label")]);
  if (has_column(table, "digest"))
    return table.name + " " + id_of<Digest>(bytes_of(table, row, "digest")).short_hex();
  std::string words = table.name;
  for (std::size_t i = 0; i < table.keys; ++i)
    words += " " + words_of(row[i]);
  return words;
}

/// Whether a row bears a mark of damage, or its checksum is wrong.
bool is_damaged(const MovedTable& table, const MovedRow& row) {
  if (has_column(table, "damaged_ms") && number_of(table, row, "damaged_ms") != 0)
    return true;
  if (table.name != "path" && table.name != "scene" && table.name != "distribution" &&
      table.name != "rehearsal" && table.name != "search" && table.name != "mesh")
    return false;
  return checksum_of(table, row) != number_of(table, row, "crc32c");
}

class Comparison {
 public:
  Comparison(const MovedTable& table, Verification& verification)
      : table_(table), verification_(verification) {
    found_.name = table.name;
  }

  /// \param source, target  in the order of their keys, of the same range of keys.
  void add(const std::vector<MovedRow>& source, const std::vector<MovedRow>& target) {
    auto one = source.begin();
    auto other = target.begin();
    while (one != source.end() || other != target.end()) {
      const int order = one == source.end()     ? 1
                        : other == target.end() ? -1
                                                : order_of(*one, *other);
      if (order < 0)
        differ(describe_row(table_, *one) + " is missing");
      else if (order > 0)
        differ(describe_row(table_, *other) + " is not in the source");
      else
        compare(*one, *other);
      if (order <= 0)
        count(*one++, found_.source);
      if (order >= 0)
        count(*other++, found_.target);
    }
  }

  /// Rows of which ids and states alone are compared.
  void add_light(const std::vector<RowFingerprint>& source,
                 const std::vector<RowFingerprint>& target) {
    if (source == target)
      return;
    differ(table_.name + ": of " + std::to_string(source.size()) +
           " rows that were the same when they were compared first, some are not now");
  }

  const VerifiedTable& found() const noexcept { return found_; }

 private:
  int order_of(const MovedRow& one, const MovedRow& other) const {
    for (std::size_t i = 0; i < table_.keys; ++i)
      if (one[i] != other[i])
        return one[i] < other[i] ? -1 : 1;
    return 0;
  }

  static void count(const MovedRow& row, RowsSum& sum) {
    ++sum.rows;
    sum.digest = digest_of(row, sum.digest);
  }

  void compare(const MovedRow& source, const MovedRow& target) {
    if (const std::string columns = differing_columns(table_, source, target); !columns.empty())
      return differ(describe_row(table_, source) + " is not the same: " + columns);
    if (is_damaged(table_, source) && ++found_.damaged <= kMaxMessages)
      verification_.messages.push_back(describe_row(table_, source) +
                                       " is damaged, there as here: a report brings it anew");
  }

  void differ(const std::string& message) {
    ++verification_.differences;
    if (++found_.differences <= kMaxMessages)
      verification_.messages.push_back(message);
  }

  const MovedTable& table_;
  Verification& verification_;
  VerifiedTable found_;
};

/// Ids of both, ascending.
std::vector<std::int64_t> ids_of_either(const std::vector<RowFingerprint>& one,
                                        const std::vector<RowFingerprint>& other) {
  std::vector<std::int64_t> ids;
  for (const std::vector<RowFingerprint>* const rows : {&one, &other})
    for (const RowFingerprint& row : *rows)
      ids.push_back(row[0]);
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

RowsSum& operator+=(RowsSum& sum, const RowsSum& more) {
  sum.rows += more.rows;
  sum.digest =
      crc32c({reinterpret_cast<const std::uint8_t*>(&more.digest), sizeof more.digest}, sum.digest);
  return sum;
}

/// The comparison of all tables, under way.
class Verifier {
 public:
  Verifier(Side& source, Side& target, const RowsDone& rows_done)
      : source_(source), target_(target), rows_done_(rows_done), records_(target) {
    for (const MovedTable& table : moved_tables())
      verification_.tables.push_back({.name = table.name});
    list_pairs();
  }

  Verification run() {
    for (const MovedTable& table : moved_tables()) {
      if (table.reading == Reading::ByPair)
        continue;
      Verification found;
      Comparison comparison(table, found);
      if (table.reading == Reading::Whole)
        comparison.add(in_order(source_.all(table), table), in_order(target_.all(table), table));
      else
        compare_ids_of(table, {}, comparison);
      found.tables.push_back(comparison.found());
      take(std::move(found));
    }
    for (const Pair& pair : pairs_)
      take(compare_pair(pair, true));
    return std::move(verification_);
  }

  /// A pair that changes while it is compared is neither equal nor different.
  Verification run_beside_server() {
    for (const Pair& pair : pairs_) {
      const MovedRow experience = source_.experience_of(pair);
      if (experience.empty() || experience != target_.experience_of(pair) ||
          records_.find(experience))
        continue;
      Verification found = compare_pair(pair, false);
      if (source_.experience_of(pair) != experience)
        continue;
      if (found.is_equal() && found.messages.empty())
        records_.put(experience, {found.tables[0].source, found.tables[1].source});
      take(std::move(found));
    }
    return std::move(verification_);
  }

 private:
  static std::vector<MovedRow> in_order(std::vector<MovedRow> rows, const MovedTable& table) {
    std::ranges::sort(rows, [&](const MovedRow& one, const MovedRow& other) {
      return std::lexicographical_compare(
          one.begin(), one.begin() + static_cast<std::ptrdiff_t>(table.keys), other.begin(),
          other.begin() + static_cast<std::ptrdiff_t>(table.keys));
    });
    return rows;
  }

  /// Of both stores.
  void list_pairs() {
    const MovedTable& experience = moved_table("experience");
    std::set<std::pair<std::int64_t, std::int64_t>> keys;
    for (Side* const side : {&source_, &target_})
      for (const MovedRow& row : side->all(experience)) {
        keys.emplace(integer_of(row, 0), integer_of(row, 1));
        total_ += static_cast<std::uint64_t>(integer_of(row, experience.column("paths")) +
                                             integer_of(row, experience.column("attempts")));
      }
    total_ /= 2;
    for (const auto& [task, robot] : keys)
      pairs_.push_back({task, robot});
  }

  /// \return of the tables of paths and of attempts.
  Verification compare_pair(const Pair& pair, bool may_know) {
    Verification found;
    const MovedRow experience = may_know ? source_.experience_of(pair) : MovedRow();
    const std::optional<PairRecord> known =
        experience.empty() ? std::nullopt : records_.find(experience);
    for (const char* const name : {"path", "attempt"}) {
      const MovedTable& table = moved_table(name);
      Comparison comparison(table, found);
      if (known)
        comparison.add_light(source_.light(table, pair), target_.light(table, pair));
      else
        compare_ids_of(table, pair, comparison);
      found.tables.push_back(comparison.found());
    }
    if (known) {
      found.tables[0].source = found.tables[0].target = known->paths;
      found.tables[1].source = found.tables[1].target = known->attempts;
    }
    return found;
  }

  void compare_ids_of(const MovedTable& table, const Pair& pair, Comparison& comparison) {
    const std::vector<std::int64_t> ids =
        ids_of_either(source_.light(table, pair), target_.light(table, pair));
    for (std::size_t begin = 0; begin < ids.size(); begin += kRowsCompared) {
      const auto some = std::span(ids).subspan(begin, std::min(kRowsCompared, ids.size() - begin));
      comparison.add(source_.of_ids(table, some), target_.of_ids(table, some));
      if (table.reading == Reading::ByPair)
        done_ += some.size();
      rows_done_(done_, std::max(total_, done_));
    }
  }

  void take(Verification found) {
    for (const VerifiedTable& table : found.tables) {
      VerifiedTable& sum =
          *std::ranges::find(verification_.tables, table.name, &VerifiedTable::name);
      sum.source += table.source;
      sum.target += table.target;
      sum.differences += table.differences;
      sum.damaged += table.damaged;
    }
    verification_.differences += found.differences;
    constexpr std::size_t kMaxMessagesOfAll = 100;
    for (std::string& message : found.messages)
      if (verification_.messages.size() < kMaxMessagesOfAll)
        verification_.messages.push_back(std::move(message));
  }

  Side& source_;
  Side& target_;
  const RowsDone& rows_done_;
  PairRecords records_;
  std::vector<Pair> pairs_;
  Verification verification_;
  std::uint64_t done_ = 0, total_ = 0;
};

}  // namespace

Verification verify(Side& source, Side& target, const RowsDone& rows_done) {
  return Verifier(source, target, rows_done).run();
}

Verification verify_beside_server(Side& source, Side& target, const RowsDone& rows_done) {
  return Verifier(source, target, rows_done).run_beside_server();
}

}  // namespace kinship::store::moving
