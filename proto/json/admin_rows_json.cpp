#include "proto/json/admin_rows_json.hpp"

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

}  // namespace

std::string to_json(const Explanation& explanation) {
  OrderedJson object;
  object["distribution"] = distribution_object(explanation.distribution);
  object["experience"] = json_of(explanation.experience);
  object["behind"] = explanation.behind;
  object["next_fit"] = explanation.next_fit;
  object["rehearsal"] = json_of(explanation.rehearsal);
  return write(object);
}

std::string to_json(const Retirement& retirement) { return write_fields(retirement); }
std::string to_json(const RobotRemoval& removal) { return write_fields(removal); }
std::string to_json(const Job& job) { return write_fields(job); }
std::string to_json(const AuditEntry& entry) { return write_fields(entry); }

std::string eviction_to_json(const Digest& distribution_id) {
  OrderedJson object;
  object["evicted"] = distribution_id.hex();
  return write(object);
}

Result<Explanation> explanation_from_json(std::string_view text) {
  return read_document(text, "explanation", read_explanation);
}

Result<Retirement> retirement_from_json(std::string_view text) {
  return read_fields<Retirement>(text, "retirement");
}

Result<RobotRemoval> robot_removal_from_json(std::string_view text) {
  return read_fields<RobotRemoval>(text, "robot removal");
}

Result<Job> job_from_json(std::string_view text) { return read_fields<Job>(text, "job"); }

Result<AuditEntry> audit_entry_from_json(std::string_view text) {
  return read_fields<AuditEntry>(text, "audit entry");
}

Result<Digest> eviction_from_json(std::string_view text) {
  return read_document(text, "eviction",
                       [](const Reader& reader) { return reader.at("evicted").digest(); });
}

}  // namespace kinship::json
