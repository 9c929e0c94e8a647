#include "proto/json/admin_rows_json.hpp"

#include <type_traits>

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

}  // namespace

template <AdminRow Row>
std::string to_json(const Row& row) {
  if constexpr (std::is_same_v<Row, Explanation>)
    return write(explanation_object(row));
  else
    return write_fields(row);
}

template <AdminRow Row>
Result<Row> row_from_json(std::string_view text) {
  if constexpr (std::is_same_v<Row, Explanation>)
    return read_document(text, kRowName<Row>, read_explanation);
  else
    return read_fields<Row>(text, kRowName<Row>);
}

template std::string to_json(const RobotSummary&);
template Result<RobotSummary> row_from_json(std::string_view);
template std::string to_json(const TaskSummary&);
template Result<TaskSummary> row_from_json(std::string_view);
template std::string to_json(const PathSummary&);
template Result<PathSummary> row_from_json(std::string_view);
template std::string to_json(const AttemptSummary&);
template Result<AttemptSummary> row_from_json(std::string_view);
template std::string to_json(const DistributionSummary&);
template Result<DistributionSummary> row_from_json(std::string_view);
template std::string to_json(const ServerStatus&);
template Result<ServerStatus> row_from_json(std::string_view);
template std::string to_json(const Explanation&);
template Result<Explanation> row_from_json(std::string_view);
template std::string to_json(const Eviction&);
template Result<Eviction> row_from_json(std::string_view);
template std::string to_json(const Retirement&);
template Result<Retirement> row_from_json(std::string_view);
template std::string to_json(const RobotRemoval&);
template Result<RobotRemoval> row_from_json(std::string_view);
template std::string to_json(const Job&);
template Result<Job> row_from_json(std::string_view);
template std::string to_json(const ClientUse&);
template Result<ClientUse> row_from_json(std::string_view);
template std::string to_json(const BackupSummary&);
template Result<BackupSummary> row_from_json(std::string_view);
template std::string to_json(const AuditEntry&);
template Result<AuditEntry> row_from_json(std::string_view);

std::string download_to_json(const std::string& file, std::uint64_t bytes, const Digest& sha256) {
  OrderedJson object;
  object["file"] = file;
  object["bytes"] = bytes;
  object["sha256"] = sha256.hex();
  return write(object);
}

}  // namespace kinship::json
