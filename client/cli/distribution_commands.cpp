#include "client/cli/distribution_commands.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <optional>
#include <ostream>
#include <random>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/value_text.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

int print_samples(const Distribution& distribution, const FetchOptions& options, std::ostream& out,
                  std::ostream& err) {
  const mixture::DistributionSampler sampler(distribution);
  std::mt19937_64 generator(options.seed);
  for (Eigen::Index joint = 0; joint < sampler.dimension(); ++joint)
    out << (joint == 0 ? "q_" : ",q_") << joint + 1;
  out << '\n' << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (std::uint64_t i = 0; i < options.samples; ++i) {
    const auto q = sampler.sample(generator);
    if (!q) {
      err << "distributions fetch: the mixture lies outside the joint limits\n";
      return kFailed;
    }
    for (Eigen::Index joint = 0; joint < q->size(); ++joint)
      out << (joint == 0 ? "" : ",") << (*q)(joint);
    out << '\n';
  }
  return kDone;
}

std::string selection_text(const Selection& selection) {
  std::string text;
  if (selection.weighting)
    text += "weighted by " + std::string(to_text(*selection.weighting));
  if (selection.since_ms > 0)
    text += (text.empty() ? "" : ", ") + ("received since " + time_text(selection.since_ms));
  if (!selection.sources.empty())
    text += (text.empty() ? "only" : ", only") + std::string(" of");
  for (const Digest& robot : selection.sources)
    text += " " + robot.short_hex();
  return text;
}

/// Why poses had no configuration: "12 out of reach, 3 limits"; "-" if all had one.
std::string lost_text(const Source& source) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(count) + what;
  };
  add(source.out_of_reach, " out of reach");
  add(source.outside_limits, " limits");
  add(source.not_converged, " not converged");
  add(source.colliding, " colliding");
  return text.empty() ? "-" : text;
}

/// A part of a whole in percent; "-" of nothing.
std::string share_text(std::uint64_t part, std::uint64_t whole) {
  constexpr double kPercent = 100;
  if (whole == 0)
    return "-";
  return number_text(kPercent * static_cast<double>(part) / static_cast<double>(whole), 0) + " %";
}

/// How the poses of each source became configurations.
void print_source_transfers(const Distribution& distribution, std::ostream& out) {
  Table table({{"SOURCE", Fit::Cut},
               "POSES SOLVED",
               "ON TRACKS",
               "TRACKS KEPT",
               "THROUGH",
               "RANDOM",
               "SELF COLLIDING",
               "IN RECORDED SCENE",
               "PATHS WITH SCENE"});
  for (const Source& source : distribution.sources)
    table.add_row({source.label, share_text(source.poses_solved, source.poses),
                   share_text(source.poses_on_tracks, source.poses_solved),
                   source.tracks_tried == 0 ? "-"
                                            : std::to_string(source.tracks_kept) + "/" +
                                                  std::to_string(source.tracks_tried),
                   share_text(source.tracks_through, source.tracks_tried),
                   share_text(source.random_configurations, source.configurations),
                   share_text(source.self_collisions, source.filter_checks),
                   share_text(source.scene_collisions, source.filter_checks),
                   std::to_string(source.paths_with_scene)});
  table.print(out);
}

void print_size(const Mixture& mixture, std::uint64_t configurations, std::ostream& out) {
  const bool are_kernels = mixture.shares_covariance();
  out << (are_kernels ? "kernels       " : "mixture       ") << mixture.size()
      << (are_kernels ? " in " : " components in ") << mixture.dimension()
      << " dimensions, fitted to " << configurations << " configurations\n";
  if (!are_kernels)
    return;
  constexpr int kDigits = 3;
  out << "bandwidth    ";
  for (const double variance : mixture.covariance(0).diagonal())
    out << ' ' << number_text(std::sqrt(variance), kDigits);
  out << ", deviations of a kernel\n";
}

/// The score of each number of components that was tried, drawn as bars.
void print_curve(const Distribution& distribution, std::ostream& out) {
  constexpr double kWidth = 40;
  constexpr int kDigits = 3;
  const auto by_score = [](const ComponentScore& a, const ComponentScore& b) {
    return a.score < b.score;
  };
  const std::vector<ComponentScore>& scores = distribution.component_scores;
  const auto least = std::min_element(scores.begin(), scores.end(), by_score);
  const auto best = std::max_element(scores.begin(), scores.end(), by_score);  // the first of them
  Table table({"COMPONENTS", "HELD-OUT SCORE", ""});
  for (const ComponentScore& score : scores) {
    const double part = best->score > least->score
                            ? (score.score - least->score) / (best->score - least->score)
                            : 1;
    table.add_row({std::to_string(score.components), number_text(score.score, kDigits),
                   std::string(1 + static_cast<std::size_t>(kWidth * part), '#') +
                       (score == *best ? " chosen" : "")});
  }
  table.print(out);
  out << '\n';
}

/// The generation of a robot's experience that the fit read; empty if it read none.
std::string fitted_generation(const Distribution& distribution, const Digest& robot) {
  const auto source =
      std::find_if(distribution.sources.begin(), distribution.sources.end(),
                   [&](const Source& candidate) { return candidate.robot == robot; });
  return source == distribution.sources.end() ? "-" : std::to_string(source->generation);
}

void print_evidence(const char* name, const std::optional<ModeEvidence>& mode, std::ostream& out) {
  out << name;
  if (!mode) {
    out << "no attempts\n";
    return;
  }
  out << mode->attempts << " attempts, " << mode->solved << " solved";
  if (mode->solved > 0)
    out << ", " << number_text(mode->checks_per_solution, 0) << " collision checks per solution";
  out << '\n';
}

void print_explanation(const Explanation& explanation, std::ostream& out) {
  print_distribution(explanation.distribution, out);
  out << '\n';
  print_evidence("guided      ", explanation.distribution.advice.guided, out);
  print_evidence("control     ", explanation.distribution.advice.control, out);
  out << "experience  " << (explanation.behind ? "has grown since the fit" : "is that of the fit")
      << (explanation.next_fit.empty() ? "" : "; next fit: ") << explanation.next_fit << "\n\n";
  Table table({"EXPERIENCE NOW", "ROBOT", "PATHS", "GENERATION", "FITTED"});
  for (const Explanation::Now& now : explanation.experience)
    table.add_row({now.label, now.robot.short_hex(), std::to_string(now.paths),
                   std::to_string(now.generation),
                   fitted_generation(explanation.distribution, now.robot)});
  table.print(out);
  out << '\n';
  print_rehearsal(explanation.rehearsal, out);
}

}  // namespace

void print_distribution(const Distribution& distribution, std::ostream& out) {
  out << "distribution  " << distribution.id.short_hex() << " revision " << distribution.revision
      << ", " << to_text(distribution.state) << '\n'
      << "task, robot   " << distribution.task << ", " << distribution.robot.short_hex() << '\n'
      << "placement     "
      << (distribution.T_task_base ? pose_text(*distribution.T_task_base) : "not given") << '\n'
      << "profile       " << distribution.profile << " (" << distribution.engines << ")\n";
  if (distribution.mixture)
    print_size(*distribution.mixture, distribution.configurations, out);
  out << "made          " << time_text(distribution.fitted_ms) << ", transfer "
      << number_text(distribution.transfer_time_s, 2) << " s, fit "
      << number_text(distribution.fit_time_s, 2) << " s\n";
  if (distribution.fit)
    out << "fit           " << describe(*distribution.fit) << '\n';
  out << "share         " << number_text(distribution.advice.recommended_share, 2) << " recommended"
      << (distribution.advice.evidence.empty() ? "" : ": ") << distribution.advice.evidence << '\n';
  if (const std::string selection = selection_text(distribution.selection); !selection.empty())
    out << "experience    " << selection << '\n';
  if (!distribution.reason.empty())
    out << "note          " << distribution.reason << '\n';
  if (!distribution.filters.empty())
    out << "filters       " << distribution.filters << '\n';
  out << '\n';
  if (!distribution.component_scores.empty())
    print_curve(distribution, out);
  Table table({{"SOURCE", Fit::Cut},
               {"ROBOT", Fit::Wide},
               "RELATION",
               "PATHS",
               "USED",
               {"GENERATION", Fit::Wide},
               "POSES",
               "SOLVED",
               "LOST",
               {"CONFIGURATIONS", Fit::Wide},
               "MASS"});
  constexpr int kMassDigits = 3;
  for (const Source& source : distribution.sources)
    table.add_row({source.label, source.robot.short_hex(), std::string(to_text(source.relation)),
                   std::to_string(source.paths), std::to_string(source.paths_used),
                   std::to_string(source.generation), std::to_string(source.poses),
                   std::to_string(source.poses_solved), lost_text(source),
                   std::to_string(source.configurations), number_text(source.mass, kMassDigits)});
  table.print(out);
  out << '\n';
  print_source_transfers(distribution, out);
}

int fetch_distribution(link::Client& server, const FetchOptions& options, std::ostream& out,
                       std::ostream& err) {
  constexpr const char* kCommand = "distributions fetch";
  int code = kDone;
  const auto distribution = fetch_query(server, options.query, kCommand, false, err, code);
  if (!distribution)
    return code;
  if (options.samples > 0)
    return print_samples(*distribution, options, out, err);
  if (options.json)
    out << json::to_json(*distribution) << '\n';
  else
    print_distribution(*distribution, out);
  return kDone;
}

int explain_distribution(link::Client& server, const DistributionQuery& query, bool json,
                         std::ostream& out, std::ostream& err) {
  constexpr const char* kCommand = "distributions explain";
  int code = kDone;
  const std::string id = id_of_query(server, query, kCommand, true, err, code);
  if (code != kDone)
    return code;
  const auto explanation =
      link::row_of<Explanation>(server, {.verb = AdminVerb::ExplainDistribution, .argument = id});
  if (!explanation)
    return refuse(kCommand, explanation.error(), err);
  if (json)
    out << json::to_document(*explanation) << '\n';
  else
    print_explanation(*explanation, out);
  return kDone;
}

}  // namespace kinship::cli
