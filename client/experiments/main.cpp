#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <sstream>

#include "client/arguments/command_options.hpp"
#include "client/experiments/commands.hpp"
#include "client/experiments/page_options.hpp"
#include "client/experiments/study_options.hpp"
#include "client/files/output_file.hpp"
#include "proto/manual/manual.hpp"
#include "proto/manual/suggestion.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"

namespace {

using namespace kinship;               // NOLINT: a program's main file
using namespace kinship::experiments;  // NOLINT

constexpr const char* kExamples = R"(
Examples:
  kinship-experiments shelf --model robots/models/panda --count 60 --seed 1 --output panda.problems.jsonl
  kinship-experiments placement --model robots/models/ur10e
  kinship-experiments compare --uniform uniform.results.jsonl --guided guided.results.jsonl

  kinship-experiments page --run build/quickstart --models robots/models --output quickstart.html
      any run: kinship-experiments page --help
  kinship-experiments planar --out build/experiments --quick
      the whole first experiment with few instances: learning sets, distributions, queries
  kinship-experiments planar --out client/experiments/results --resume
      goes on with what is there
  kinship-experiments planar --out build/tuning --tuning --overshoot 1.5 --share 0.9
      the same on tuning instances, to choose options by

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 a file or folder does not exist, 4 its kinshipd did not start.)";

struct CommandLine {
  ShelfOptions shelf;
  std::string placement;
  std::filesystem::path output;
  models::RobotArguments placed;
  CompareOptions compare;
  PageOptions page;
  StudyOptions study;
};

void add_shelf(CLI::App& app, CommandLine& line) {
  CLI::App* const shelf = app.add_subcommand(
      "shelf", "write planning problems: a held box goes from a table into a shelf");
  shelf
      ->add_option("--model", line.shelf.robot.source,
                   "model folder of the robot, or a URDF file with --base and --tip")
      ->required();
  arguments::add_robot_options(*shelf, line.shelf.robot);
  shelf->add_option("--count", line.shelf.count, "problems to write")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  shelf->add_option("--seed", line.shelf.seed, "equal seeds give equal scenes for every robot")
      ->capture_default_str();
  shelf->add_option("--placement", line.placement,
                    "base of the robot in the task frame, \"x y z qx qy qz qw\"; known for the "
                    "robots of robots/models, otherwise identity");
  shelf->add_option("--output", line.output, "file to write; standard output if missing");
}

void add_placement(CLI::App& app, CommandLine& line) {
  CLI::App* const placement =
      app.add_subcommand("placement", "print where the robot stands in the shelf task");
  placement
      ->add_option("--model", line.placed.source,
                   "model folder of the robot, or a URDF file with --base and --tip")
      ->required();
  arguments::add_robot_options(*placement, line.placed);
}

void add_compare(CLI::App& app, CommandLine& line) {
  CLI::App* const compare = app.add_subcommand(
      "compare", "compare two result files of kinship-plan over the same problems");
  compare->add_option("--uniform", line.compare.uniform, "results without guidance")->required();
  compare->add_option("--guided", line.compare.guided, "results with guidance")->required();
  compare->add_flag("--json", line.compare.json, "one JSON document instead of a table");
}

Eigen::Isometry3d read_placement(const std::string& text) {
  std::istringstream stream(text);
  PoseArray numbers{};
  std::string rest;
  for (double& number : numbers)
    stream >> number;
  if (!stream || stream >> rest)
    throw CLI::ValidationError("--placement", "'" + text + "' is not seven numbers");
  const Result<Eigen::Isometry3d> pose = from_pose_array(numbers);
  if (!pose)
    throw CLI::ValidationError("--placement", pose.error().message);
  return *pose;
}

void write_shelf(const CommandLine& line) {
  files::OutputFile output(line.output, std::cout);
  write_shelf_problems(line.shelf, output.stream(), std::cerr);
  output.keep();
}

int run(int argc, char** argv) {
  CommandLine line;
  CLI::App app{"kinship-experiments: planning problems and comparisons for experiments",
               "kinship-experiments"};
  manual::add_manual(app);
  app.footer(kExamples);
  app.require_subcommand(1);
  add_shelf(app, line);
  add_placement(app, line);
  add_compare(app, line);
  add_page_command(app, line.page);
  add_study_commands(app, line.study);
  try {
    app.parse(argc, argv);
    if (!line.placement.empty())
      line.shelf.T_task_base = read_placement(line.placement);
  } catch (const CLI::ParseError& error) {
    return manual::explain(app, error, std::cout, std::cerr);
  }
  if (!line.study.study.empty())
    run_study_command(line.study, std::cout, std::cerr);
  else if (app.got_subcommand("shelf"))
    write_shelf(line);
  else if (app.got_subcommand("placement"))
    write_placement(line.placed, std::cout);
  else if (app.got_subcommand("page"))
    run_page_command(line.page);
  else
    write_comparison(line.compare, std::cout);
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const kinship::Failure& failure) {
    std::cerr << "kinship-experiments: " << failure.what() << '\n';
    return exit_code(failure.code());
  } catch (const std::exception& error) {
    std::cerr << "kinship-experiments: " << error.what() << '\n';
    return kFailed;
  }
}
