#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "proto/json/format.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/outbox_entry.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// The rows of the admin conversation and of `--json` listings: the server writes them, clients
/// read them. Member names are those of the structs and never change.
namespace kinship::json {

template <typename... Rows>
std::variant<Rows...> any_of(const std::tuple<RowName<Rows>...>& rows);
template <typename... Rows>
std::variant<const Rows*...> pointer_to_any_of(const std::tuple<RowName<Rows>...>& rows);

using AnyRow = decltype(any_of(kAdminRows));
using AnyRowPointer = decltype(pointer_to_any_of(kAdminRows));

/// One of kAdminRows.
template <typename Row>
concept AdminRow = std::is_constructible_v<AnyRowPointer, const Row*>;

std::string write_row(const AnyRowPointer& row);

/// \param index  of the row in kAdminRows.
Result<AnyRow> read_row(std::size_t index, std::string_view text);

/// Of the document of a row that stands alone, as of `jobs wait --json`, and of that of a listing,
/// `{"rows": [...]}`. Over the wire and in a listing a row is a part and names no format.
template <AdminRow Row>
inline constexpr Format kFormatOf{std::get<RowName<Row>>(kAdminRows).name};
template <AdminRow Row>
inline constexpr Format kListFormatOf{std::get<RowName<Row>>(kAdminRows).name, 1, "-list"};

template <AdminRow Row>
std::string to_json(const Row& row) {
  return write_row(&row);
}

/// The document of a row that stands alone.
template <AdminRow Row>
std::string to_document(const Row& row) {
  return in_format(kFormatOf<Row>, to_json(row));
}

/// The distribution of an Explanation may lack its mixture (weights, means, covariances null).
template <AdminRow Row>
Result<Row> row_from_json(std::string_view text) {
  constexpr std::size_t kIndex = AnyRowPointer(static_cast<const Row*>(nullptr)).index();
  Result<AnyRow> row = read_row(kIndex, text);
  if (!row)
    return row.error();
  return std::get<Row>(std::move(row).value());
}

/// The document of `kinship backup download --json`: `{"file", "bytes", "sha256"}`.
std::string download_to_json(const std::string& file, std::uint64_t bytes, const Digest& sha256);

/// The document of `kinship outbox list --json`: `{"rows": [{"file", "state", "why"}]}`.
std::string outbox_to_json(const std::vector<OutboxEntry>& entries);

}  // namespace kinship::json
