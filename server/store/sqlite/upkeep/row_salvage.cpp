#include "server/store/sqlite/upkeep/row_salvage.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "server/store/sqlite/database/page_format.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kMaxPayload = std::uint64_t{1} << 30U;

/// Sign-extends a big-endian integer of 1 to 8 bytes.
std::int64_t signed_integer(PageBytes bytes, std::size_t at, std::size_t size) {
  const std::uint64_t value = big_endian(bytes, at, size);
  const auto shift = static_cast<unsigned>(64 - 8 * size);
  return static_cast<std::int64_t>(value << shift) >> shift;
}

/// \param at  is moved behind the value. \return nothing if it is no value of a record.
std::optional<RawValue> read_value_of(PageBytes record, std::uint64_t type, std::size_t& at) {
  constexpr std::uint64_t kReal = 7, kZero = 8, kOne = 9, kFirstSized = 12;
  constexpr std::size_t kIntegerBytes[] = {0, 1, 2, 3, 4, 6, 8};
  if (type == 0)
    return RawValue();
  if (type == kZero || type == kOne)
    return RawValue(static_cast<std::int64_t>(type - kZero));
  if (type > kOne && type < kFirstSized)
    return std::nullopt;
  const std::size_t size = type >= kFirstSized ? static_cast<std::size_t>((type - kFirstSized) / 2)
                           : type == kReal     ? 8
                                               : kIntegerBytes[type];
  if (size > record.size() - at)
    return std::nullopt;
  const PageBytes bytes = record.subspan(at, size);
  at += size;
  if (type == kReal)
    return RawValue(std::bit_cast<double>(big_endian(bytes, 0, size)));
  if (type < kFirstSized)
    return RawValue(signed_integer(bytes, 0, size));
  if (type % 2 == 0)
    return RawValue(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  return RawValue(std::string(bytes.begin(), bytes.end()));
}

std::optional<std::vector<RawValue>> read_record_of(PageBytes record) {
  std::size_t at_type = 0;
  const std::uint64_t header = varint(record, at_type);
  if (header > record.size())
    return std::nullopt;
  auto at = static_cast<std::size_t>(header);
  std::vector<RawValue> values;
  while (at_type < header) {
    const std::uint64_t type = varint(record, at_type);
    std::optional<RawValue> value = read_value_of(record, type, at);
    if (!value)
      return std::nullopt;
    values.push_back(std::move(*value));
  }
  return values;
}

/// A cell of a leaf: the row's id and as much of its payload as lies there.
struct Cell {
  std::int64_t id = 0;
  std::uint64_t payload = 0;
  std::vector<std::uint8_t> bytes;
  std::uint64_t overflow = 0;  // the page where it goes on
};

std::vector<Cell> cells_of(PageBytes page, std::size_t header) {
  constexpr std::size_t kCellsAt = 3, kPointersAt = 8;
  std::vector<Cell> cells;
  const std::uint64_t count = big_endian(page, header + kCellsAt, 2);
  for (std::size_t number = 0; number < count && header + kPointersAt + 2 * number < page.size();
       ++number) {
    auto at = static_cast<std::size_t>(big_endian(page, header + kPointersAt + 2 * number, 2));
    Cell cell;
    cell.payload = varint(page, at);
    cell.id = static_cast<std::int64_t>(varint(page, at));
    const std::uint64_t local = local_bytes(page.size(), cell.payload, true);
    if (cell.payload > kMaxPayload || at + local > page.size())
      continue;
    const PageBytes bytes = page.subspan(at, static_cast<std::size_t>(local));
    cell.bytes.assign(bytes.begin(), bytes.end());
    cell.overflow = overflow_of(page, at, cell.payload, true);
    cells.push_back(std::move(cell));
  }
  return cells;
}

/// Reads the part of a cell that lies on other pages. \return false if one is damaged.
bool complete(PageReader& reader, Cell& cell) {
  constexpr std::size_t kNextBytes = 4;
  for (std::uint64_t next = cell.overflow; cell.bytes.size() < cell.payload;) {
    if (next == 0 || next > reader.count())
      return false;
    const std::optional<PageBytes> page = reader.read(next);
    if (!page)
      return false;
    const std::size_t size =
        std::min<std::size_t>(page->size() - kSealBytes - kNextBytes,
                              static_cast<std::size_t>(cell.payload) - cell.bytes.size());
    const PageBytes bytes = page->subspan(kNextBytes, size);
    cell.bytes.insert(cell.bytes.end(), bytes.begin(), bytes.end());
    next = big_endian(*page, 0, kNextBytes);
  }
  return true;
}

}  // namespace

std::uint64_t for_each_row(PageReader& reader, const std::function<void(RawRow)>& take,
                           const std::function<void(double)>& progress) {
  constexpr std::size_t kHeaderOfFileBytes = 100;
  constexpr std::uint64_t kPagesOfAReport = 1024;
  std::uint64_t damaged = 0;
  const std::uint64_t count = reader.count();
  for (std::uint64_t number = 1; number <= count; ++number) {
    if (number % kPagesOfAReport == 0)
      progress(static_cast<double>(number) / static_cast<double>(count));
    const std::optional<PageBytes> page = reader.read(number);
    damaged += page ? 0U : 1U;
    const std::size_t header = number == 1 ? kHeaderOfFileBytes : 0;
    if (!page || (*page)[header] != kTableLeaf)
      continue;
    for (Cell& cell : cells_of(*page, header))
      if (complete(reader, cell))
        if (auto values = read_record_of(cell.bytes))
          take({cell.id, std::move(*values)});
  }
  return damaged;
}

}  // namespace kinship::store
