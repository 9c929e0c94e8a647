#include "proto/json/admin_rows_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/parts.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

Explanation read_explanation(const Reader& reader) {
  Explanation explanation;
  explanation.distribution =
      read_distribution(reader.at("distribution"), MixturePart::MayBeMissing);
  for (const Reader& element : reader.at("experience").elements(kMaxSources)) {
    Explanation::Now now;
    now.robot = element.at("robot").digest();
    now.label = element.at("label").text(kMaxLabelBytes);
    now.paths = element.at("paths").count();
    now.generation = element.at("generation").count();
    explanation.experience.push_back(std::move(now));
  }
  explanation.behind = reader.at("behind").boolean();
  explanation.next_fit = reader.at("next_fit").text(kMaxMessageBytes);
  return explanation;
}

Retirement read_retirement(const Reader& reader) {
  Retirement retirement;
  retirement.task = reader.at("task").text(kMaxTaskBytes);
  retirement.paths = reader.at("paths").count();
  for (const Reader& robot : reader.at("robots").elements(kMaxSources))
    retirement.robots.push_back(robot.digest());
  return retirement;
}

Job read_job(const Reader& reader) {
  Job job;
  job.id = reader.at("id").text(kMaxWordBytes);
  job.verb = reader.at("verb").text(kMaxWordBytes);
  job.argument = reader.at("argument").text(kMaxFileNameBytes);
  job.state = parse_job_state(reader.at("state").text(kMaxWordBytes)).value_or_throw();
  job.progress = reader.at("progress").number(0, 1);
  job.message = reader.at("message").text(kMaxMessageBytes);
  job.rows = reader.at("rows").count();
  job.started_ms = reader.at("started_ms").integer();
  job.ended_ms = reader.at("ended_ms").integer();
  return job;
}

}  // namespace

std::string to_json(const Explanation& explanation) {
  OrderedJson object;
  object["distribution"] = distribution_object(explanation.distribution);
  object["experience"] = OrderedJson::array();
  for (const Explanation::Now& now : explanation.experience)
    object["experience"].push_back({{"robot", now.robot.hex()},
                                    {"label", now.label},
                                    {"paths", now.paths},
                                    {"generation", now.generation}});
  object["behind"] = explanation.behind;
  object["next_fit"] = explanation.next_fit;
  return write(object);
}

std::string to_json(const Retirement& retirement) {
  OrderedJson object;
  object["task"] = retirement.task;
  object["paths"] = retirement.paths;
  object["robots"] = OrderedJson::array();
  for (const Digest& robot : retirement.robots)
    object["robots"].push_back(robot.hex());
  return write(object);
}

std::string to_json(const Job& job) {
  OrderedJson object;
  object["id"] = job.id;
  object["verb"] = job.verb;
  object["argument"] = job.argument;
  object["state"] = to_text(job.state);
  object["progress"] = job.progress;
  object["message"] = job.message;
  object["rows"] = job.rows;
  object["started_ms"] = job.started_ms;
  object["ended_ms"] = job.ended_ms;
  return write(object);
}

std::string eviction_to_json(const Digest& distribution_id) {
  OrderedJson object;
  object["evicted"] = distribution_id.hex();
  return write(object);
}

Result<Explanation> explanation_from_json(std::string_view text) {
  return read_document(text, "explanation", read_explanation);
}

Result<Retirement> retirement_from_json(std::string_view text) {
  return read_document(text, "retirement", read_retirement);
}

Result<Job> job_from_json(std::string_view text) { return read_document(text, "job", read_job); }

Result<Digest> eviction_from_json(std::string_view text) {
  return read_document(text, "eviction",
                       [](const Reader& reader) { return reader.at("evicted").digest(); });
}

}  // namespace kinship::json
