#include "client/experiments/page/page_json.hpp"

#include <sstream>

#include "client/experiments/comparison_table.hpp"
#include "client/page/json_text.hpp"

namespace kinship::experiments {
namespace {

constexpr double kPercent = 100;

using page::list;
using page::number;
using page::json_string;

std::string json_of(const Poses& poses) {
  return "{\"positions\":" + page::millimetres(poses.positions) +
         ",\"directions\":" + page::whole(poses.directions, kPercent) + "}";
}

std::string json_of(const FleetMember& member) {
  return "{\"label\":" + json_string(member.label) + ",\"problems\":" + std::to_string(member.problems) +
         ",\"paths\":" + list(member.paths, [](const Poses& path) { return json_of(path); }) + "}";
}

std::string json_of(const Source& source) {
  return "{\"label\":" + json_string(source.label) + ",\"paths\":" + std::to_string(source.paths) +
         ",\"poses\":" + std::to_string(source.poses) +
         ",\"poses_solved\":" + std::to_string(source.poses_solved) + "}";
}

std::string json_of(const Distribution& distribution) {
  return "{\"id\":" + json_string(distribution.id.short_hex()) +
         ",\"revision\":" + std::to_string(distribution.revision) +
         ",\"task\":" + json_string(distribution.task) + ",\"profile\":" + json_string(distribution.profile) +
         ",\"components\":" + std::to_string(distribution.mixture->size()) +
         ",\"joints\":" + std::to_string(distribution.mixture->dimension()) +
         ",\"configurations\":" + std::to_string(distribution.configurations) +
         ",\"transfer_time_s\":" + number(distribution.transfer_time_s) +
         ",\"fit_time_s\":" + number(distribution.fit_time_s) + ",\"sources\":" +
         list(distribution.sources, [](const Source& source) { return json_of(source); }) + "}";
}

std::string json_of(const MeanInterval& interval) {
  return "{\"mean\":" + number(interval.mean) + ",\"low\":" + number(interval.low) +
         ",\"high\":" + number(interval.high) + "}";
}

std::string json_of(const Comparison& comparison) {
  std::ostringstream text;
  write_json(comparison, text);
  return text.str();
}

}  // namespace

std::string to_json(const PageData& data) {
  const auto bones = [](const std::vector<page::Bone>& posture) { return page::json_of(posture); };
  return "{\"robot\":" + json_string(data.robot) + ",\n\"fleet\":" +
         list(data.fleet, [](const FleetMember& member) { return json_of(member); }) +
         ",\n\"scene\":" + page::json_of(data.scene.objects) +
         ",\n\"distribution\":" + json_of(data.distribution) +
         ",\n\"samples\":" + json_of(data.samples) +
         ",\n\"advice\":{\"share\":" + number(data.advice.recommended_share) +
         ",\"evidence\":" + json_string(data.advice.evidence) + "}" +
         ",\n\"free_share\":" + number(data.free_share) +
         ",\"uniform_free_share\":" + number(data.uniform_free_share) +
         ",\n\"postures\":" + list(data.postures, bones) +
         ",\n\"comparison\":" + json_of(data.comparison) +
         ",\n\"uniform_checks\":" + json_of(data.uniform_checks) +
         ",\"guided_checks\":" + json_of(data.guided_checks) + "}";
}

}  // namespace kinship::experiments
