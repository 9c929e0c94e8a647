#include "pages/plots/plot_pages.hpp"

#include <ostream>
#include <string_view>
#include <utility>

#include "pages/page/document.hpp"
#include "pages/page/json_text.hpp"
#include "pages/plots/plot_texts.hpp"
#include "proto/json/admin_rows_json.hpp"
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

std::string json_of(const std::vector<Marginal>& marginals) {
  return list(marginals, [](const Marginal& marginal) { return json_of(marginal); });
}

std::string json_of(const KeptDistribution& kept) {
  return object({{"summary", json::to_json(kept.summary)},
                 {"engines", json_string(kept.engines)},
                 {"hands", page::millimetres(kept.samples.hands)},
                 {"marginals", json_of(kept.samples.marginals)}});
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

std::string to_json(const DistributionFigure& figure) {
  const DistributionPlot& plot = figure.plot;
  Distribution distribution = plot.distribution;
  const std::optional<Mixture> mixture = std::exchange(distribution.mixture, std::nullopt);
  return object(
      {{"label", json_string(plot.label)},
       {"distribution", json::to_json(distribution)},
       {"mixture_size", whole(static_cast<std::uint64_t>(mixture->size()))},
       {"are_kernels", mixture->shares_covariance() ? "true" : "false"},
       {"components",
        list(plot.components, [](const Component& component) { return json_of(component); })},
       {"hands", page::millimetres(plot.samples.hands)},
       {"marginals", json_of(plot.samples.marginals)},
       {"postures", list(plot.postures, [](const Posture& posture) { return json_of(posture); })},
       {"shapes", json_string(plot.shapes)},
       {"lost", to_json(figure.lost)},
       {"kept", list(figure.kept, [](const KeptDistribution& kept) { return json_of(kept); })}});
}

std::string to_json(const TaskFigure& figure) {
  const TaskHistory& history = figure.history;
  return object(
      {{"task", json_string(history.task)},
       {"from_ms", std::to_string(history.from_ms)},
       {"bin_ms", std::to_string(history.bin_ms)},
       {"bins", whole(history.bins)},
       {"robots", list(history.robots, [](const RobotHistory& robot) { return json_of(robot); })},
       {"revisions",
        list(history.revisions, [](const Revision& revision) { return json_of(revision); })},
       {"space", to_json(figure.paths)}});
}

namespace {

std::string_view text(std::string_view file) { return page::text_of(plot_texts(), file); }

/// A figure of this room, kinshipFigures.NAME of NAME.js, and the command that writes its page.
struct FigurePage {
  std::string name, command;
  bool draws_scenes = false, draws_charts = false;
  std::vector<std::string> parts = {};  ///< other files of its own
};

void write_figure(const FigurePage& figure, std::string title, std::string data,
                  std::ostream& out) {
  page::Document document;
  document.title = std::move(title) + " - Kinship";
  document.body = "<div id=\"figure\" data-figure=\"" + figure.name +
                  "\"></div>\n<footer>Written by kinship " + figure.command +
                  " from what the server keeps. The page holds everything it needs and loads "
                  "nothing." +
                  (figure.draws_scenes ? " Scenes are drawn with three.js (MIT)." : "") +
                  (figure.draws_charts ? " Charts are drawn with Vega (BSD 3-clause)." : "") +
                  "</footer>";
  document.data = std::move(data);
  document.styles = {text("plots.css")};
  document.scripts = {text("plots.js")};
  if (figure.draws_scenes)
    document.scripts.push_back(text("chain.js"));
  for (const std::string& file : figure.parts)
    document.scripts.push_back(text(file));
  for (const std::string& file : {figure.name + ".js", std::string("draw.js")})
    document.scripts.push_back(text(file));
  document.draws_scenes = figure.draws_scenes;
  document.draws_charts = figure.draws_charts;
  page::write_document(document, out);
}

}  // namespace

void write_page(const DistributionFigure& figure, std::ostream& out) {
  const DistributionPlot& plot = figure.plot;
  write_figure({"distribution", "distributions plot", true, true},
               plot.label + " on " + plot.distribution.task, to_json(figure), out);
}

void write_page(const TaskFigure& figure, std::ostream& out) {
  write_figure({"task", "tasks plot", true, true, {"task_space.js"}}, figure.history.task,
               to_json(figure), out);
}

void write_page(const RobotFigure& figure, std::ostream& out) {
  write_figure({"robot", "robots plot", true}, figure.summary.label, to_json(figure), out);
}

void write_page(const AttemptFigure& figure, const std::string& command, std::ostream& out) {
  write_figure({"attempt", command, true, true, {"path.js"}},
               figure.drawn.robot.description.label + " on " + figure.attempt.task, to_json(figure),
               out);
}

void write_page(const std::string& task, const std::vector<Transferability>& pairs,
                std::ostream& out) {
  write_figure({"worths", "robots compare"}, "Experience of " + task, json::to_json(task, pairs),
               out);
}

std::vector<page::EmbeddedText> figure_programs() {
  std::vector<page::EmbeddedText> programs = page::programs(true, true);
  for (const page::EmbeddedText& file : plot_texts())
    if (file.name.ends_with(".js") && file.name != "draw.js")
      programs.push_back(file);
  return programs;
}

}  // namespace kinship::plots
