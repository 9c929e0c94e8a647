#include "client/experiments/page/page_json.hpp"

#include <optional>
#include <sstream>
#include <vector>

#include "client/experiments/comparison_table.hpp"
#include "client/page/json_text.hpp"
#include "proto/types/enum_text.hpp"

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

std::string json_of(const TypicalInstance& typical) {
  return "{\"problem\":" + json_string(typical.problem) +
         ",\"uniform_checks\":" + std::to_string(typical.uniform_checks) +
         ",\"guided_checks\":" + std::to_string(typical.guided_checks) +
         ",\"ratio\":" + number(typical.ratio) +
         ",\"median_ratio\":" + number(typical.median_ratio) +
         ",\"candidates\":" + std::to_string(typical.candidates) + "}";
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

std::string json_of(const MeanInterval& interval) {
  return "{\"mean\":" + number(interval.mean) + ",\"low\":" + number(interval.low) +
         ",\"high\":" + number(interval.high) + "}";
}

std::string json_of(const Comparison& comparison) {
  std::ostringstream text;
  write_json(comparison, {}, text);
  return text.str();
}

std::string json_of(const AlsoRow& row) {
  return list(std::vector<std::string>{row.name, row.solved, row.checks, row.checks_ratio, row.time,
                                       row.time_ratio},
              json_string);
}

std::string guide_count(const std::pair<const Guide, std::size_t>& each) {
  return "{\"guide\":" + json_string(to_text(each.first)) +
         ",\"queries\":" + std::to_string(each.second) + "}";
}

/// The rows of the terminal's table, and what stands below it.
std::string table_of(const Comparison& comparison) {
  const auto row = [](const ComparisonRow& each) {
    return list(std::vector<std::string>{each.name, each.uniform, each.guided, each.ratio, each.p},
                json_string);
  };
  return "{\"rows\":" + list(comparison_rows(comparison), row) +
         ",\"notes\":" + list(comparison_notes(comparison), json_string) + "}";
}

}  // namespace

std::string to_json(const PageData& data) {
  return "{\"robot\":" + json_string(data.robot) + ",\"held\":" + list(data.held, json_string) +
         ",\n\"fleet\":" +
         list(data.fleet, [](const FleetMember& member) { return json_of(member); }) +
         ",\n\"distribution\":" + json_of(data.distribution) +
         ",\n\"advice\":" + or_null(data.advice) + ",\n\"typical\":" + or_null(data.typical) +
         ",\n\"obstacles\":" + page::json_of(data.obstacles) +
         ",\n\"newcomer\":" + or_null(data.newcomer) + ",\n\"searches\":" + or_null(data.searches) +
         ",\n\"samples\":" + json_of(data.samples) +
         ",\n\"comparison\":" + json_of(data.comparison) +
         ",\"table\":" + table_of(data.comparison) + ",\n\"also\":" +
         list(also_rows(data.also), [](const AlsoRow& row) { return json_of(row); }) +
         ",\n\"guides\":" + list(data.guides, guide_count) +
         ",\n\"cheaper_guided\":" + std::to_string(data.cheaper_guided) +
         ",\n\"uniform_checks\":" + json_of(data.uniform_checks) +
         ",\"guided_checks\":" + json_of(data.guided_checks) +
         ",\"uniform_time_s\":" + json_of(data.uniform_time_s) +
         ",\"guided_time_s\":" + json_of(data.guided_time_s) + "}";
}

}  // namespace kinship::experiments
