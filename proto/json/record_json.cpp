#include "proto/json/record_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::json {
OrderedJson record_object(const PlanningRecord& record) {
  OrderedJson object;
  object["outcome"] = to_text(record.outcome);
  object["planner"] = record.planner;
  object["planner_options"] = record.planner_options;
  object["planning_time_s"] = record.planning_time_s;
  object["collision_checks"] = record.collision_checks;
  object["projections"] = record.projections;
  object["time_limit_s"] = record.time_limit_s;
  object["arm"] = to_text(record.arm);
  object["share"] = record.share;
  object["distribution_id"] =
      record.distribution_id ? OrderedJson(record.distribution_id->hex()) : OrderedJson(nullptr);
  object["distribution_revision"] = record.distribution_revision;
  return object;
}

PlanningRecord read_record(const Reader& reader) {
  PlanningRecord record;
  record.outcome = parse_outcome(reader.at("outcome").text(kMaxWordBytes)).value_or_throw();
  record.planning_time_s = reader.at("planning_time_s").number(0);
  record.collision_checks = reader.at("collision_checks").count();
  if (const auto planner = reader.find("planner")) {
    record.planner = planner->text(kMaxPlannerBytes);
    if (const auto error = check_planner(record.planner))
      reader.refuse(error->message);
  }
  if (const auto options = reader.find("planner_options"))
    record.planner_options = options->text(kMaxPlannerOptionsBytes);
  if (const auto projections = reader.find("projections"))
    record.projections = projections->count();
  if (const auto limit = reader.find("time_limit_s"))
    record.time_limit_s = limit->number(0);
  if (const auto arm = reader.find("arm"))
    record.arm = parse_arm(arm->text(kMaxWordBytes)).value_or_throw();
  if (const auto share = reader.find("share"))
    record.share = share->number(0, 1);
  if (const auto id = reader.find("distribution_id"))
    record.distribution_id = id->digest();
  if (const auto revision = reader.find("distribution_revision"))
    record.distribution_revision = revision->count();
  return record;
}

}  // namespace kinship::json
