#include <CLI/CLI.hpp>
#include <iostream>
#include <sstream>

#include "client/arguments/command_options.hpp"
#include "client/experiments/station_problems.hpp"
#include "client/experiments/studies/study.hpp"
#include "client/experiments/study_options.hpp"
#include "client/results/python_program.hpp"
#include "proto/files/output_file.hpp"
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
  kinship-experiments machine --model robots/models/panda --count 60 --seed 1 --output panda.problems.jsonl
  kinship-experiments placement --model robots/models/ur10e
  kinship-experiments planar --out build/experiments --quick
      the whole first experiment with few instances: learning sets, distributions, queries
  kinship-experiments planar --out build/experiments --resume
      goes on with what is there
  kinship-experiments order --out build/order --study furniture_cage --robot panda --seed 1,2
      two orders of a hundred queries each, from an empty store
  kinship-experiments planar --out build/tuning --tuning --overshoot 1.5 --share 0.9
      the same on tuning instances, to choose options by

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 a file or folder does not exist, 4 its kinshipd did not start.)";

struct CommandLine {
  StationOptions machine, shelf;
  std::string placement;
  std::filesystem::path output;
  std::string placed_at = std::string(to_text(Station::Machine));
  models::RobotArguments placed;
  StudyOptions study;
};

void add_station(CLI::App& app, const std::string& description, StationOptions& options,
                 CommandLine& line) {
  CLI::App* const station = app.add_subcommand(std::string(to_text(options.station)),
                                               "write planning problems: " + description);
  station
      ->add_option("--model", options.robot.source,
                   "model folder of the robot, or a URDF file with --base and --tip")
      ->required();
  arguments::add_robot_options(*station, options.robot);
  station->add_option("--count", options.count, "problems to write")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  station->add_option("--seed", options.seed, "equal seeds give equal scenes for every robot")
      ->capture_default_str();
  arguments::add_numbers(*station, "--placement", line.placement,
                         "base of the robot in the task frame, \"x y z qx qy qz qw\"; known for "
                         "panda, iiwa14 and ur10e of robots/models, otherwise identity");
  station->add_option("--output", line.output, "file to write; standard output if missing");
}

void add_placement(CLI::App& app, CommandLine& line) {
  CLI::App* const placement =
      app.add_subcommand("placement", "print where the robot stands in the task of such problems");
  placement
      ->add_option("--model", line.placed.source,
                   "model folder of the robot, or a URDF file with --base and --tip")
      ->required();
  arguments::add_robot_options(*placement, line.placed);
  placement->add_option("--station", line.placed_at, "the task that is meant")
      ->check(CLI::IsMember(
          {std::string(to_text(Station::Machine)), std::string(to_text(Station::Shelf))}))
      ->capture_default_str();
}

/// Python runs them, which is told the options as they were given and the studies.
void add_order(CLI::App& app) {
  CLI::App* const order = app.add_subcommand(
      "order",
      "plan a robot's queries one after another from an empty store, reporting each, beside the "
      "same queries planned uniformly");
  const auto add = [&](const char* name, const char* text, const char* type, const char* usual) {
    return order->add_option(name, CLI::callback_t(), text)->type_name(type)->default_str(usual);
  };
  const auto add_list = [&](const char* name, const char* text, const char* type) {
    return order->add_option(name, CLI::callback_t(), text)
        ->type_name(type)
        ->expected(1, CLI::detail::expected_max_vector_size)
        ->delimiter(',');
  };
  add("--out", "folder of order.jsonl and the stores", "FOLDER", "")->required();
  add("--models", "folder of the robots' model folders", "FOLDER", "robots/models");
  add("--kinshipd", "program of the server that is started (default: beside this program)", "FILE",
      "");
  add("--domain", "DDS domain of that server", "UINT", "60")
      ->envname("KINSHIP_DOMAIN")
      ->check(CLI::Range(0, 230));
  add_list("--study", "studies whose tasks are planned, or families of them", "TEXT")
      ->default_str("furniture,kitting");
  add_list("--robot", "robots, each with orders of its own", "ROBOT")->default_str("ur10e");
  add("--queries", "of an order", "UINT", "100")->check(CLI::Range(1, 1000));
  add_list("--seed", "an order for each; other seeds, other queries", "UINT")
      ->default_str("1")
      ->check(CLI::Range(1, 10));
  add("--ask", "guidance is asked for anew after so many reports", "UINT", "10")
      ->check(CLI::Range(1, 1000));
  add("--pause", "from a query to the next, s, as the robot moves", "FLOAT", "0")
      ->check(CLI::Range(0.0, 60.0));
  order->add_flag_callback(
      "--rehearsed", [] {}, "wait for a rehearsal whenever guidance is asked for");
  order->add_flag_callback(
      "--figures", [] {}, "figures as deploy/bench reads them instead of a table");
}

/// The names of the studies meant, of families each.
std::vector<std::string> studies_of(const CLI::App& order) {
  std::vector<std::string> names;
  const CLI::Option& option = *order.get_option("--study");
  for (const std::string& name :
       option.count() > 0 ? option.results() : std::vector<std::string>{"furniture", "kitting"})
    for (const Study* const study : find_studies(name))
      names.push_back(study->name);
  return names;
}

[[noreturn]] void run_orders(const CLI::App& order) {
  results::Words words = results::words_of(order);
  words["name"] = {"order"};
  words["studies"] = studies_of(order);
  run_study_program(std::move(words));
}

Eigen::Isometry3d read_placement(const std::string& text) {
  const Result<Eigen::Isometry3d> pose = models::parse_pose(text);
  if (!pose)
    throw CLI::ValidationError("--placement", pose.error().message);
  return *pose;
}

void write_problems(const CommandLine& line, StationOptions options) {
  if (!line.placement.empty())
    options.T_task_base = read_placement(line.placement);
  files::OutputFile output(line.output, std::cout);
  write_station_problems(options, output.stream(), std::cerr);
  output.keep();
}

int run(int argc, char** argv) {
  CommandLine line;
  line.shelf.station = Station::Shelf;
  CLI::App app{"kinship-experiments: studies, and the planning problems of the quickstart",
               "kinship-experiments"};
  manual::add_manual(app);
  app.footer(kExamples);
  app.require_subcommand(1);
  add_station(app, "a part goes from a pallet into a machine, through its door", line.machine,
              line);
  add_station(app, "a held box goes from a table into a shelf", line.shelf, line);
  add_placement(app, line);
  add_order(app);
  add_study_commands(app, line.study);
  try {
    manual::parse(app, argc, argv);
    if (!line.placement.empty())
      read_placement(line.placement);  // a wrong one is wrong usage
  } catch (const CLI::ParseError& error) {
    return manual::explain(app, error, std::cout, std::cerr);
  }
  if (!line.study.study.empty())
    run_study_command(line.study, std::cin, std::cout);
  else if (app.got_subcommand("machine"))
    write_problems(line, line.machine);
  else if (app.got_subcommand("shelf"))
    write_problems(line, line.shelf);
  else if (app.got_subcommand("placement"))
    write_placement(line.placed_at == to_text(Station::Shelf) ? Station::Shelf : Station::Machine,
                    line.placed, std::cout);
  else
    run_orders(*app.get_subcommand("order"));
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
