#include "pages/plots/plot_pages.hpp"

#include <ostream>
#include <string_view>
#include <utility>

#include "pages/page/document.hpp"
#include "pages/page/json_text.hpp"
#include "pages/plots/plot_texts.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_answers_json.hpp"

namespace kinship::plots {

namespace {

using page::json_string;
using page::list;
using page::number;
using page::object;

std::string number_or_null(const std::optional<double>& value) {
  return value ? number(*value) : "null";
}

std::string whole(std::uint64_t count) { return std::to_string(count); }

std::string json_of(const Component& component) {
  return "[" + number(component.weight) + "," + number(component.cumulated) + "]";
}

std::string json_of(const Marginal& marginal) {
  return object({{"joint", json_string(marginal.joint)},
                 {"unit", json_string(marginal.is_length ? "m" : "rad")},
                 {"lower", number(marginal.lower)},
                 {"upper", number(marginal.upper)},
                 {"cut", number_or_null(marginal.cut)},
                 {"counts", list(marginal.counts, whole)}});
}

std::string json_of(const Posture& posture) {
  return object({{"weight", number(posture.weight)}, {"bones", page::json_of(posture.bones)}});
}

std::string json_of(const ModeCounts& mode) {
  return object({{"attempts", whole(mode.attempts)},
                 {"solved", whole(mode.solved)},
                 {"lower", number_or_null(mode.checks.lower)},
                 {"median", number_or_null(mode.checks.median)},
                 {"upper", number_or_null(mode.checks.upper)}});
}

std::string json_of(const RobotBin& bin) {
  return object({{"bin", whole(bin.bin)},
                 {"attempts", whole(bin.attempts)},
                 {"paths", whole(bin.paths)},
                 {"modes", list(bin.modes, [](const ModeCounts& mode) { return json_of(mode); })}});
}

std::string json_of(const Benefit& benefit) {
  return object({{"time_ms", std::to_string(benefit.time_ms)},
                 {"ratio", number(benefit.ratio)},
                 {"low", number(benefit.low)},
                 {"high", number(benefit.high)},
                 {"guided", whole(benefit.guided)},
                 {"control", whole(benefit.control)}});
}

std::string json_of(const RobotHistory& robot) {
  return object(
      {{"robot", json_string(robot.robot.hex())},
       {"label", json_string(robot.label)},
       {"attempts", whole(robot.attempts)},
       {"solved", whole(robot.solved)},
       {"unsolved", whole(robot.unsolved)},
       {"not_planned", whole(robot.not_planned)},
       {"bins", list(robot.bins, [](const RobotBin& bin) { return json_of(bin); })},
       {"planner", json_string(robot.planner)},
       {"other_planners", whole(robot.other_planners)},
       {"benefit", list(robot.benefit, [](const Benefit& benefit) { return json_of(benefit); })}});
}

std::string json_of(const Revision& revision) {
  return object({{"id", json_string(revision.id.hex())},
                 {"revision", whole(revision.revision)},
                 {"label", json_string(revision.label)},
                 {"attempts", whole(revision.attempts)},
                 {"first_ms", std::to_string(revision.first_ms)},
                 {"fitted_ms", std::to_string(revision.fitted_ms)}});
}

}  // namespace

std::string to_json(const DistributionPlot& plot) {
  Distribution distribution = plot.distribution;
  const std::optional<Mixture> mixture = std::exchange(distribution.mixture, std::nullopt);
  return object(
      {{"label", json_string(plot.label)},
       {"distribution", json::to_json(distribution)},
       {"mixture_size", whole(static_cast<std::uint64_t>(mixture->size()))},
       {"are_kernels", mixture->shares_covariance() ? "true" : "false"},
       {"components",
        list(plot.components, [](const Component& component) { return json_of(component); })},
       {"hands", page::millimetres(plot.hands)},
       {"marginals",
        list(plot.marginals, [](const Marginal& marginal) { return json_of(marginal); })},
       {"postures", list(plot.postures, [](const Posture& posture) { return json_of(posture); })},
       {"shapes", json_string(plot.shapes)}});
}

std::string to_json(const TaskHistory& history) {
  return object(
      {{"task", json_string(history.task)},
       {"from_ms", std::to_string(history.from_ms)},
       {"bin_ms", std::to_string(history.bin_ms)},
       {"bins", whole(history.bins)},
       {"robots", list(history.robots, [](const RobotHistory& robot) { return json_of(robot); })},
       {"revisions",
        list(history.revisions, [](const Revision& revision) { return json_of(revision); })}});
}

namespace {

/// A page of this room: NAME.html with NAME.js, and the shared files.
page::Document document_of(const std::string& name, std::string title, std::string data) {
  const auto text = [](const std::string& file) { return page::text_of(plot_texts(), file); };
  page::Document document;
  document.title = std::move(title);
  document.body = text(name + ".html");
  document.data = std::move(data);
  document.styles = {text("plots.css")};
  document.scripts = {text("plots.js"), text(name + ".js")};
  return document;
}

}  // namespace

void write_page(const DistributionPlot& plot, std::ostream& out) {
  page::Document document = document_of(
      "distribution", plot.label + " on " + plot.distribution.task + " - Kinship", to_json(plot));
  document.draws_scenes = document.draws_charts = true;
  page::write_document(document, out);
}

void write_page(const TaskHistory& history, std::ostream& out) {
  page::Document document = document_of("task", history.task + " - Kinship", to_json(history));
  document.draws_charts = true;
  page::write_document(document, out);
}

void write_page(const std::string& task, const std::vector<Transferability>& pairs,
                std::ostream& out) {
  page::write_document(
      document_of("worths", "Experience of " + task + " - Kinship", json::to_json(task, pairs)),
      out);
}

}  // namespace kinship::plots
