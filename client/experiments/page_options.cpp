#include "client/experiments/page_options.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "client/arguments/command_options.hpp"
#include "client/experiments/commands.hpp"
#include "proto/files/output_file.hpp"

namespace kinship::experiments {
namespace {

constexpr const char* kPageExamples = R"(
A run is one robot that planned the same problems with uniform and with guided sampling, and the distribution that guided it. The
page shows besides, where their files are there, the robots whose experience it is, how searches grew and what the server advises.

Examples:
  kinship-experiments page --run build/quickstart --models robots/models --output quickstart.html
      a folder as deploy/quickstart leaves it: ROBOT.problems.jsonl, ROBOT-uniform.results.jsonl, ROBOT-guided.results.jsonl,
      distribution.json; if there are, ROBOT-uniform.searches.jsonl, ROBOT-guided.searches.jsonl, ROBOT-GUIDE.results.jsonl of
      a guide alone (mixture, ways, retreat), advice.json and of teachers TEACHER.problems.jsonl, TEACHER.results.jsonl
  kinship-plan cell.jsonl --robot robots/models/ur10e --task weld --guidance none --output uniform.jsonl --searches uniform.trees
  kinship-plan cell.jsonl --robot robots/models/ur10e --task weld --guidance always --output guided.jsonl --searches guided.trees
  kinship distributions fetch --task weld --robot ur10e --placement "0 0 0 0 0 0 1" --json > weld.json
  kinship-experiments page --model robots/models/ur10e --problems cell.jsonl --uniform uniform.jsonl --guided guided.jsonl
      --uniform-searches uniform.trees --guided-searches guided.trees --distribution weld.json --output weld.html
      any robot and task, every file named
  kinship-experiments page ... --teacher robots/models/panda,panda.jsonl,panda.results.jsonl
      with what a robot did whose experience it is

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 a file or folder does not exist.)";

void add_files(CLI::App& page, PageOptions& options) {
  RunFiles& files = options.run.files;
  page.add_option(
      "--model", files.robot.source,
      "model folder of the robot, or a URDF file with --base and --tip; MODELS/ROBOT if "
      "missing");
  arguments::add_robot_options(page, files.robot);
  page.add_option("--problems", files.problems, "what was planned with both");
  page.add_option("--uniform", files.uniform, "results of kinship-plan without guidance");
  page.add_option("--guided", files.guided, "results of kinship-plan with guidance");
  page.add_option("--distribution", files.distribution,
                  "what kinship distributions fetch --json wrote before");
  page.add_option("--advice", files.advice,
                  "the same fetched after the attempts, for what the server advises now");
  page.add_option("--uniform-searches", files.uniform_searches,
                  "what kinship-plan --searches wrote, without guidance");
  page.add_option("--guided-searches", files.guided_searches, "and with guidance");
  page.add_option("--also", options.also,
                  "NAME=FILE: results over the same problems to show beside those, e.g. of one "
                  "guide alone; may be repeated")
      ->take_all();
  page.add_option("--teacher", options.teachers,
                  "MODEL,PROBLEMS,RESULTS of a robot whose experience it is; may be repeated")
      ->take_all();
}

}  // namespace

void add_page_command(CLI::App& app, PageOptions& options) {
  CLI::App* const page = app.add_subcommand(
      "page",
      "write an HTML page that shows what experience was worth to a robot; it needs nothing "
      "else");
  page->footer(kPageExamples);
  page->add_option("--run", options.run.folder,
                   "folder in which files that are not named are looked for");
  page->add_option("--models", options.run.models, "folder of model folders");
  page->add_option("--robot", options.run.robot,
                   "beginning of the robot's files in the folder; needed if there are several");
  page->add_option("--teachers,--fleet", options.run.teachers,
                   "those of the experienced robots; all that are there if missing")
      ->delimiter(',');
  add_files(*page, options);
  page->add_option("--output", options.output, "file to write; standard output if missing");
}

void run_page_command(PageOptions options) {
  for (const std::string& teacher : options.teachers)
    options.run.files.teachers.push_back(parse_teacher(teacher));
  for (const std::string& also : options.also)
    options.run.files.also.push_back(parse_also(also));
  files::OutputFile output(options.output, std::cout);
  write_page(options.run, output.stream());
  output.keep();
}

}  // namespace kinship::experiments
