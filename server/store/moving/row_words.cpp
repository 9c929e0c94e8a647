#include "server/store/moving/row_words.hpp"

#include <algorithm>
#include <optional>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/values/bytes.hpp"
#include "server/store/values/codes.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/path_content.hpp"
#include "server/store/values/scene_blob.hpp"

namespace kinship::store::moving {
namespace {

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

}  // namespace

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

bool is_damaged(const MovedTable& table, const MovedRow& row) {
  if (has_column(table, "damaged_ms") && number_of(table, row, "damaged_ms") != 0)
    return true;
  if (table.name != "path" && table.name != "scene" && table.name != "distribution")
    return false;
  return checksum_of(table, row) != number_of(table, row, "crc32c");
}

}  // namespace kinship::store::moving
