#include "proto/json/admin_rows_json.hpp"

#include <array>
#include <type_traits>
#include <vector>

#include "proto/json/fields.hpp"
#include "proto/json/parts.hpp"

namespace kinship::json {
namespace {

Explanation read_explanation(const Reader& reader) {
  Explanation explanation;
  explanation.distribution =
      read_distribution(reader.at("distribution"), MixturePart::MayBeMissing);
  explanation.experience =
      read_as<std::vector<Explanation::Now>>(reader.at("experience"), {.limit = kMaxSources});
  explanation.behind = reader.at("behind").boolean();
  explanation.next_fit = reader.at("next_fit").text(kMaxMessageBytes);
  if (const auto rehearsal = reader.find("rehearsal"))
    explanation.rehearsal = read_as<Rehearsal>(*rehearsal);
  return explanation;
}

OrderedJson explanation_object(const Explanation& explanation) {
  OrderedJson object;
  object["distribution"] = distribution_object(explanation.distribution);
  object["experience"] = json_of(explanation.experience);
  object["behind"] = explanation.behind;
  object["next_fit"] = explanation.next_fit;
  object["rehearsal"] = json_of(explanation.rehearsal);
  return object;
}

template <typename Row>
Result<AnyRow> read(std::string_view text) {
  constexpr std::string_view kName = std::get<RowName<Row>>(kAdminRows).name;
  Result<Row> row = Error{};
  if constexpr (std::is_same_v<Row, Explanation>)
    row = read_document(text, kName, kFormatOf<Row>, read_explanation);
  else
    row = read_fields<Row>(text, kName, kFormatOf<Row>);
  if (!row)
    return row.error();
  return AnyRow(std::move(row).value());
}

template <typename... Rows>
constexpr auto readers_of(const std::tuple<RowName<Rows>...>& /*rows*/) {
  return std::array{&read<Rows>...};
}

}  // namespace

std::string write_row(const AnyRowPointer& row) {
  return std::visit(
      [](const auto* value) {
        if constexpr (std::is_same_v<decltype(value), const Explanation*>)
          return write(explanation_object(*value));
        else
          return write_fields(*value);
      },
      row);
}

Result<AnyRow> read_row(std::size_t index, std::string_view text) {
  constexpr auto kReaders = readers_of(kAdminRows);
  return kReaders.at(index)(text);
}

std::string download_to_json(const std::string& file, std::uint64_t bytes, const Digest& sha256) {
  OrderedJson object;
  object["file"] = file;
  object["bytes"] = bytes;
  object["sha256"] = sha256.hex();
  return write(kBackupDownloadFormat, object);
}

std::string outbox_to_json(const std::vector<OutboxEntry>& entries) {
  OrderedJson rows = OrderedJson::array();
  for (const OutboxEntry& entry : entries)
    rows.push_back({{"file", entry.file}, {"state", entry.state}, {"why", entry.why}});
  return write(kOutboxListFormat, {{"rows", std::move(rows)}});
}

}  // namespace kinship::json
