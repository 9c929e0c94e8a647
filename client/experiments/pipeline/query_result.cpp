#include "client/experiments/pipeline/query_result.hpp"

#include <nlohmann/json.hpp>

#include "proto/types/enum_text.hpp"

namespace kinship::experiments {

std::string to_json(const QueryResult& result) {
  nlohmann::ordered_json line;
  line["robot"] = result.key.robot;
  line["guidance"] = result.key.guidance;
  line["instance"] = result.key.instance;
  line["seed"] = result.key.seed;
  line["distribution"] = nullptr;
  if (result.distribution)
    line["distribution"] = result.distribution->hex();
  line["solved"] = result.solved;
  line["checks"] = result.checks;
  line["goal_checks"] = result.goal_checks;
  line["projections"] = result.projections;
  line["cpu_s"] = result.cpu_s;
  line["length"] = result.length;
  if (result.gate_fired)
    line["gate_fired"] = *result.gate_fired;
  if (result.guided_share)
    line["guided_share"] = *result.guided_share;
  if (result.track_share)
    line["track_share"] = *result.track_share;
  if (result.found_by)
    line["found_by"] = to_text(*result.found_by);
  if (result.guide)
    line["guide"] = to_text(*result.guide);
  return line.dump();
}

Result<QueryResult> query_result_from_json(std::string_view text) {
  try {
    const auto line = nlohmann::json::parse(text);
    QueryResult result;
    result.key = {line.at("robot"), line.at("guidance"), line.at("instance"), line.at("seed")};
    if (!line.at("distribution").is_null())
      result.distribution = Digest::from_hex(line.at("distribution").get<std::string>());
    result.solved = line.at("solved");
    result.checks = line.at("checks");
    result.goal_checks = line.at("goal_checks");
    result.projections = line.at("projections");
    result.cpu_s = line.at("cpu_s");
    result.length = line.at("length");
    if (line.contains("gate_fired"))
      result.gate_fired = line.at("gate_fired").get<bool>();
    if (line.contains("guided_share"))
      result.guided_share = line.at("guided_share").get<double>();
    if (line.contains("track_share"))
      result.track_share = line.at("track_share").get<double>();
    if (line.contains("found_by"))
      result.found_by =
          parse_word<FoundBy>(line.at("found_by").get<std::string>()).value_or_throw();
    if (line.contains("guide"))
      result.guide = parse_word<Guide>(line.at("guide").get<std::string>()).value_or_throw();
    return result;
  } catch (const nlohmann::json::exception& exception) {
    return Error{ErrorCode::InvalidInput, exception.what()};
  }
}

}  // namespace kinship::experiments
