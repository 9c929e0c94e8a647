#include "client/experiments/page_options.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <iterator>

#include "client/arguments/command_options.hpp"
#include "client/experiments/page/run_page.hpp"
#include "client/experiments/python_program.hpp"
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

}  // namespace

void add_page_command(CLI::App& app, PageOptions& options) {
  CLI::App* const page = app.add_subcommand(
      "page",
      "write an HTML page that shows what experience was worth to a robot; it needs nothing "
      "else");
  page->footer(kPageExamples);
  page->callback([&options, page] { options.command = page; });
  const auto add = [&](const char* name, const char* text) {
    return page->add_option(name, CLI::callback_t(), text)->type_name("TEXT");
  };
  add("--run", "folder in which files that are not named are looked for");
  add("--models", "folder of model folders");
  add("--robot", "beginning of the robot's files in the folder; needed if there are several");
  add("--teachers,--fleet", "those of the experienced robots; all that are there if missing")
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->delimiter(',');
  add("--model",
      "model folder of the robot, or a URDF file with --base and --tip; MODELS/ROBOT if "
      "missing");
  arguments::add_robot_options(*page, options.robot);
  add("--problems", "what was planned with both");
  add("--uniform", "results of kinship-plan without guidance");
  add("--guided", "results of kinship-plan with guidance");
  add("--distribution", "what kinship distributions fetch --json wrote before");
  add("--advice", "the same fetched after the attempts, for what the server advises now");
  add("--uniform-searches", "what kinship-plan --searches wrote, without guidance");
  add("--guided-searches", "and with guidance");
  add("--also",
      "NAME=FILE: results over the same problems to show beside those, e.g. of one guide alone; "
      "may be repeated")
      ->expected(1, CLI::detail::expected_max_vector_size);
  add("--teacher",
      "MODEL,PROBLEMS,RESULTS of a robot whose experience it is, MODEL a folder as 'kinship robots "
      "init' makes it; may be "
      "repeated")
      ->expected(1, CLI::detail::expected_max_vector_size);
  page->add_option("--output", options.output, "file to write; standard output if missing");
  page->add_flag("--draws", options.draws, "draw the run that standard input describes")->group("");
}

void run_page_command(const PageOptions& options, const std::vector<std::string>& arguments) {
  if (!options.draws)
    become_python("page.py", *options.command, {{"arguments", arguments}});
  const std::string document{std::istreambuf_iterator<char>(std::cin), {}};
  files::OutputFile output(options.output, std::cout);
  write_page(parse_run(document, options.robot), output.stream());
  output.keep();
}

}  // namespace kinship::experiments
