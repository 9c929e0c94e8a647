#include "client/experiments/page/page_json.hpp"

#include <optional>
#include <vector>

#include "client/page/json_text.hpp"

namespace kinship::experiments {
namespace {

constexpr double kPercent = 100;

using page::json_string;
using page::list;
using page::number;

std::string json_of(const Poses& poses) {
  return "{\"positions\":" + page::millimetres(poses.positions) +
         ",\"directions\":" + page::whole(poses.directions, kPercent) + "}";
}

std::string json_of(const Demonstration& demonstration) {
  return "{\"problem\":" + json_string(demonstration.problem) +
         ",\"checks\":" + std::to_string(demonstration.checks) +
         ",\"obstacles\":" + page::json_of(demonstration.obstacles) +
         ",\"way\":" + page::millimetres(demonstration.way.positions) + ",\n\"frames\":" +
         list(demonstration.frames,
              [](const Frame& frame) {
                return "{\"bones\":" + page::json_of(frame.bones) +
                       ",\"held\":" + page::json_of(frame.held) + "}";
              }) +
         "}";
}

std::string json_of(const FleetMember& member) {
  return "{\"label\":" + json_string(member.label) +
         ",\"problems\":" + std::to_string(member.problems) +
         ",\"paths\":" + list(member.paths, [](const Poses& path) { return json_of(path); }) +
         ",\"example\":" + (member.example.frames.empty() ? "null" : json_of(member.example)) + "}";
}

template <typename Number>
std::string numbers(const std::vector<Number>& values) {
  return list(values, [](Number value) { return std::to_string(value); });
}

std::string json_of(const GrownSearch& search) {
  return "{\"hand\":" + page::millimetres(search.hand) + ",\"parents\":" + numbers(search.parents) +
         ",\"checks\":" + numbers(search.checks) + ",\"path\":" + numbers(search.path) + "}";
}

std::string json_of(const SearchPair& pair) {
  return "{\"uniform\":" + json_of(pair.uniform) + ",\n\"guided\":" + json_of(pair.guided) + "}";
}

std::string json_of(const DrawnSamples& samples) {
  return "{\"hand\":" + json_of(samples.hand) + ",\"free_share\":" + number(samples.free_share) +
         ",\"uniform_free_share\":" + number(samples.uniform_free_share) + ",\"postures\":" +
         list(samples.postures,
              [](const std::vector<page::Bone>& posture) { return page::json_of(posture); }) +
         "}";
}

std::string json_of(const Advice& advice) {
  return "{\"share\":" + number(advice.recommended_share) +
         ",\"evidence\":" + json_string(advice.evidence) + "}";
}

template <typename Value>
std::string or_null(const std::optional<Value>& value) {
  return value ? json_of(*value) : "null";
}

std::string json_of(const Source& source) {
  return "{\"label\":" + json_string(source.label) + ",\"paths\":" + std::to_string(source.paths) +
         ",\"poses\":" + std::to_string(source.poses) +
         ",\"poses_solved\":" + std::to_string(source.poses_solved) + "}";
}

std::string json_of(const Distribution& distribution) {
  return "{\"id\":" + json_string(distribution.id.short_hex()) +
         ",\"revision\":" + std::to_string(distribution.revision) +
         ",\"task\":" + json_string(distribution.task) +
         ",\"profile\":" + json_string(distribution.profile) +
         ",\"components\":" + std::to_string(distribution.mixture->size()) +
         ",\"joints\":" + std::to_string(distribution.mixture->dimension()) +
         ",\"configurations\":" + std::to_string(distribution.configurations) +
         ",\"transfer_time_s\":" + number(distribution.transfer_time_s) +
         ",\"fit_time_s\":" + number(distribution.fit_time_s) + ",\"sources\":" +
         list(distribution.sources, [](const Source& source) { return json_of(source); }) + "}";
}

std::string members_of(const nlohmann::ordered_json& object) {
  std::string members;
  for (const auto& [name, value] : object.items())
    members += ",\n" + json_string(name) + ":" + value.dump();
  return members;
}

}  // namespace

std::string to_json(const PageData& data) {
  return "{\"robot\":" + json_string(data.robot) + ",\"held\":" + list(data.held, json_string) +
         ",\n\"fleet\":" +
         list(data.fleet, [](const FleetMember& member) { return json_of(member); }) +
         ",\n\"distribution\":" + json_of(data.distribution) +
         ",\n\"advice\":" + or_null(data.advice) +
         ",\n\"obstacles\":" + page::json_of(data.obstacles) +
         ",\n\"newcomer\":" + or_null(data.newcomer) + ",\n\"searches\":" + or_null(data.searches) +
         ",\n\"samples\":" + json_of(data.samples) + members_of(data.figures) + "}";
}

}  // namespace kinship::experiments
