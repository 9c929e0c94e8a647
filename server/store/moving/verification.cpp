#include "server/store/moving/verification.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <utility>

#include "server/store/moving/row_words.hpp"
#include "server/store/values/crc32c.hpp"

namespace kinship::store::moving {
namespace {

constexpr std::size_t kRowsCompared = 128;  // at once; of 4 MB at most
constexpr std::size_t kMaxMessages = 10;    // of a table

std::uint32_t add_to_digest(std::uint32_t digest, const MovedRow& row) {
  const auto add = [&](const void* bytes, std::size_t size) {
    digest = crc32c({static_cast<const std::uint8_t*>(bytes), size}, digest);
  };
  for (const Cell& cell : row) {
    const std::uint64_t kind = cell.index();
    add(&kind, sizeof kind);
    if (const auto* const text = std::get_if<std::string>(&cell))
      add(text->data(), text->size());
    else if (const auto* const real = std::get_if<double>(&cell))
      add(real, sizeof *real);
    else if (const auto* const integer = std::get_if<std::int64_t>(&cell))
      add(integer, sizeof *integer);
  }
  return digest;
}

/// The names of the columns that are not the same; empty: it is one row. Numbers by their bits.
std::string differing_columns(const MovedTable& table, const MovedRow& source,
                              const MovedRow& target) {
  std::string names;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const auto* const one = std::get_if<double>(&source[i]);
    const auto* const other = std::get_if<double>(&target[i]);
    const bool is_same = one != nullptr && other != nullptr
                             ? std::memcmp(one, other, sizeof *one) == 0
                             : source[i] == target[i];
    if (!is_same)
      names += (names.empty() ? "" : ", ") + table.columns[i].name;
  }
  return names;
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
        count(*one++, found_.source_rows, found_.source_digest);
      if (order >= 0)
        count(*other++, found_.target_rows, found_.target_digest);
    }
  }

  void end() { verification_.tables.push_back(found_); }

 private:
  int order_of(const MovedRow& one, const MovedRow& other) const {
    for (std::size_t i = 0; i < table_.keys; ++i)
      if (one[i] != other[i])
        return one[i] < other[i] ? -1 : 1;
    return 0;
  }

  static void count(const MovedRow& row, std::uint64_t& rows, std::uint32_t& digest) {
    ++rows;
    digest = add_to_digest(digest, row);
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
std::vector<std::int64_t> ids_of_either(const std::vector<LightRow>& one,
                                        const std::vector<LightRow>& other) {
  std::vector<std::int64_t> ids;
  for (const std::vector<LightRow>* const rows : {&one, &other})
    for (const LightRow& row : *rows)
      ids.push_back(row[0]);
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// The comparison of all tables, under way.
class Verifier {
 public:
  Verifier(Side& source, Side& target, const RowsDone& rows_done)
      : source_(source), target_(target), rows_done_(rows_done) {}

  Verification run() {
    const std::vector<Pair> pairs = pairs_of_either();
    for (const MovedTable& table : moved_tables()) {
      Comparison comparison(table, verification_);
      if (table.reading == Reading::Whole)
        comparison.add(in_order(source_.all(table), table), in_order(target_.all(table), table));
      else if (table.reading == Reading::ById)
        compare_ids_of(table, {}, comparison);
      else
        for (const Pair& pair : pairs)
          compare_ids_of(table, pair, comparison);
      comparison.end();
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

  std::vector<Pair> pairs_of_either() {
    const MovedTable& experience = moved_table("experience");
    std::set<std::pair<std::int64_t, std::int64_t>> keys;
    for (Side* const side : {&source_, &target_})
      for (const MovedRow& row : side->all(experience)) {
        keys.emplace(integer_of(row, 0), integer_of(row, 1));
        total_ += static_cast<std::uint64_t>(integer_of(row, experience.column("paths")) +
                                             integer_of(row, experience.column("attempts")));
      }
    total_ /= 2;
    std::vector<Pair> pairs;
    for (const auto& [task, robot] : keys)
      pairs.push_back({task, robot});
    return pairs;
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

  Side& source_;
  Side& target_;
  const RowsDone& rows_done_;
  Verification verification_;
  std::uint64_t done_ = 0, total_ = 0;
};

}  // namespace

Verification verify(Side& source, Side& target, const RowsDone& rows_done) {
  return Verifier(source, target, rows_done).run();
}

}  // namespace kinship::store::moving
