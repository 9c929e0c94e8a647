#include "client/cli/srdf_command.hpp"

#include <algorithm>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/robot_answers_json.hpp"
#include "robots/collision/pair_sampling.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/geometry/srdf.hpp"
#include "robots/kinematics/link_tree.hpp"
#include "robots/models/suggested_ends.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kSuggestSrdf = "robots suggest-srdf";
constexpr double kAlways = 0.95;  // of the samples, as CollisionWorld has it
constexpr double kRuleOfThree = 3;

constexpr const char* kAdjacent = "adjacent";
constexpr const char* kTouching = "always";
constexpr const char* kDefault = "default";
constexpr const char* kNever = "never";
constexpr const char* kSometimes = "sometimes";

const char* verdict_of(const collision::SampledPair& pair, const SuggestSrdfOptions& options) {
  if (pair.is_adjacent)
    return kAdjacent;
  if (static_cast<double>(pair.touched) >= kAlways * static_cast<double>(options.samples))
    return kTouching;
  if (pair.touches_at_zero && !options.checks_default)
    return kDefault;
  return pair.touched == 0 && !pair.touches_at_zero ? kNever : kSometimes;
}

SrdfSuggestion suggest(const SuggestSrdfOptions& options, const kinematics::Chain& chain,
                       const geometry::RobotShapes& geometry, std::ostream& err) {
  SrdfSuggestion suggestion{.base_link = chain.base_link(),
                            .tip_link = chain.tip_link(),
                            .samples = options.samples,
                            .seed = options.seed,
                            .never_bound = kRuleOfThree / static_cast<double>(options.samples),
                            .pairs = {}};
  StatusLine line(err, options.progress);
  int shown_percent = -1;
  const auto name = [&](int link) { return chain.links()[static_cast<std::size_t>(link)].name; };
  for (const collision::SampledPair& pair : collision::sample_pairs(
           chain, geometry,
           {.samples = options.samples, .seed = options.seed, .progress = [&](double part) {
              const int percent = static_cast<int>(100 * part);
              if (std::exchange(shown_percent, percent) != percent)
                line.show("sampling " + std::to_string(percent) + " %");
            }}))
    suggestion.pairs.push_back(
        {name(pair.link_a), name(pair.link_b), verdict_of(pair, options), pair.touched});
  return suggestion;
}

std::string srdf_of(const std::string& robot, const SrdfSuggestion& suggestion) {
  std::vector<geometry::SrdfPair> pairs;
  for (const SampledLinks& pair : suggestion.pairs) {
    if (pair.verdict == kSometimes)
      continue;
    std::string reason = pair.verdict;
    reason.front() = static_cast<char>(reason.front() - 'a' + 'A');
    pairs.push_back({pair.link_a, pair.link_b, std::move(reason)});
  }
  return geometry::write_srdf(robot, pairs,
                              "kinship robots suggest-srdf: " + std::to_string(suggestion.samples) +
                                  " configurations, seed " + std::to_string(suggestion.seed) +
                                  ", chain " + suggestion.base_link + " to " + suggestion.tip_link);
}

void print_row(const SrdfSuggestion& suggestion, const char* verdict, const std::string& what,
               bool with_names, std::ostream& out) {
  std::vector<const SampledLinks*> pairs;
  for (const SampledLinks& pair : suggestion.pairs)
    if (pair.verdict == verdict)
      pairs.push_back(&pair);
  out << number_text(static_cast<double>(pairs.size()), 0)
      << (pairs.size() == 1 ? " pair " : " pairs ") << what << '\n';
  if (!with_names)
    return;
  for (const SampledLinks* const pair : pairs)
    out << "    " << pair->link_a << " - " << pair->link_b << ": "
        << number_text(
               100 * static_cast<double>(pair->touched) / static_cast<double>(suggestion.samples),
               2)
        << " %\n";
}

void print_suggestion(const SrdfSuggestion& suggestion, std::ostream& out) {
  out << "chain " << suggestion.base_link << " -> " << suggestion.tip_link << ", "
      << suggestion.samples << " random configurations, seed " << suggestion.seed << '\n';
  print_row(suggestion, kAdjacent, "adjacent: not checked", false, out);
  print_row(suggestion, kTouching, "touch in nearly all of them: not checked", true, out);
  print_row(suggestion, kDefault,
            "touch where all joints are at 0, taken for a fault of the shapes: not checked "
            "(--check-default checks them)",
            true, out);
  print_row(suggestion, kNever,
            "never touched: not checked; each touches in less than " +
                number_text(100 * suggestion.never_bound, 4) +
                " % of configurations (95 % confidence, rule of three)",
            false, out);
  print_row(suggestion, kSometimes, "touched now and then: checked", true, out);
}

}  // namespace

int suggest_srdf(const SuggestSrdfOptions& options, std::ostream& out, std::ostream& err) {
  models::RobotArguments arguments = options.robot;
  arguments.srdf.clear();  // all pairs are sampled, whatever a document says
  const auto links = models::complete_ends(arguments);
  if (!links)
    return refuse(kSuggestSrdf, links.error(), err);
  int code = kDone;
  const auto robot = read_robot(kSuggestSrdf, arguments, err, code);
  if (!robot)
    return code;
  const auto geometry = read_geometry(kSuggestSrdf, arguments, *robot, err);
  if (!geometry)
    return kFailed;
  if (const auto error = geometry::find_impossible_solids(robot->chain, *geometry))
    return refuse(kSuggestSrdf, *error, err);
  for (const std::string& doubt : geometry::find_doubts(robot->chain, *geometry))
    err << kSuggestSrdf << ": warning: " << doubt << '\n';
  if (links->is_suggested)
    err << kSuggestSrdf << ": base and tip are suggested ones: --base " << robot->chain.base_link()
        << " --tip " << robot->chain.tip_link() << '\n';
  const SrdfSuggestion suggestion = suggest(options, robot->chain, *geometry, err);
  const bool has_file = !options.output.empty();
  if (has_file || !options.json) {
    files::OutputFile file(options.output, out);
    file.stream() << srdf_of(kinematics::name_in_urdf(*robot), suggestion);
    file.keep();
  }
  if (options.json)
    out << json::to_json(suggestion) << '\n';
  else
    print_suggestion(suggestion, has_file ? out : err);
  return kDone;
}

}  // namespace kinship::cli
