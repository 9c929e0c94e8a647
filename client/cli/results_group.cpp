#include <iterator>

#include "client/arguments/command_options.hpp"
#include "client/cli/session.hpp"
#include "client/results/page/run_page.hpp"
#include "client/results/python_program.hpp"
#include "proto/files/output_file.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kCompareExamples =
    "kinship results compare uniform.jsonl guided.jsonl\n"
    "  kinship results compare uniform.jsonl guided.jsonl mixture.jsonl \"retreat "
    "alone=retreat.jsonl\" --json";

/// Python compares.
void add_results_compare(CLI::App& results, Session& session) {
  CLI::App* const command = add_command(
      results, "compare", "Compare runs of kinship-plan over the same problems", kCompareExamples);
  const auto files = std::make_shared<std::vector<std::string>>();
  command
      ->add_option("files", *files,
                   "Result files: of planning without guidance, of planning with it, and others to "
                   "show beside, as FILE or NAME=FILE")
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size)
      ->type_name("FILE");
  add_json(*command, session);
  on_run(*command, session, [&session, files]() -> int {
    results::Words words{{"files", *files}};
    if (session.json)
      words["json"] = {};
    results::become_python(results::script("compare.py"), std::move(words));
  });
}

constexpr const char* kPageExamples =
    "kinship results page --run build/quickstart --models robots/models --output quickstart.html\n"
    "      a folder as deploy/quickstart leaves it: ROBOT.problems.jsonl, "
    "ROBOT-uniform.results.jsonl,\n"
    "      ROBOT-guided.results.jsonl, distribution.json; if there are, "
    "ROBOT-uniform.searches.jsonl,\n"
    "      ROBOT-guided.searches.jsonl, ROBOT-GUIDE.results.jsonl of a guide alone (mixture, ways, "
    "retreat),\n"
    "      advice.json and of teachers TEACHER.problems.jsonl, TEACHER.results.jsonl\n"
    "  kinship results page --model robots/models/ur10e --problems cell.jsonl --uniform "
    "uniform.jsonl\n"
    "      --guided guided.jsonl --uniform-searches uniform.trees --guided-searches guided.trees\n"
    "      --distribution weld.json --output weld.html\n"
    "      any robot and task, every file named; weld.json: kinship distributions fetch --json\n"
    "  kinship results page ... --teacher robots/models/panda,panda.jsonl,panda.results.jsonl\n"
    "      with what a robot did whose experience it is";

/// The command line of `page`. Python finds the run's files and figures, which is told the other
/// options as they were given, and calls the command again to draw them.
struct PageOptions {
  models::RobotArguments robot;
  std::filesystem::path output;  ///< empty: standard output
  bool draws = false;            ///< the run that standard input describes
};

int write_page(const PageOptions& options, std::istream& in, std::ostream& out) {
  const std::string document{std::istreambuf_iterator<char>(in), {}};
  files::OutputFile output(options.output, out);
  results::write_page(results::parse_run(document, options.robot), output.stream());
  output.keep();
  return kDone;
}

void add_page_options(CLI::App& page, PageOptions& options) {
  const auto add = [&](const char* name, const char* text, const char* type) {
    return page.add_option(name, CLI::callback_t(), text)->type_name(type);
  };
  add("--run", "Folder in which files that are not named are looked for", "FOLDER");
  add("--models", "Folder of model folders", "FOLDER");
  add("--robot", "Beginning of the robot's files in the folder; needed if there are several",
      "TEXT");
  add("--teachers,--fleet", "Those of the experienced robots; all that are there if missing",
      "TEXT")
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->delimiter(',');
  add("--model",
      "Model folder of the robot, or a URDF file with --base and --tip; MODELS/ROBOT if missing",
      "FILE");
  arguments::add_robot_options(page, options.robot);
  add("--problems", "What was planned with both", "FILE");
  add("--uniform", "Results of kinship-plan without guidance", "FILE");
  add("--guided", "Results of kinship-plan with guidance", "FILE");
  add("--distribution", "What kinship distributions fetch --json wrote before", "FILE");
  add("--advice", "The same fetched after the attempts, for what the server advises now", "FILE");
  add("--uniform-searches", "What kinship-plan --searches wrote, without guidance", "FILE");
  add("--guided-searches", "And with guidance", "FILE");
  add("--also",
      "NAME=FILE: results over the same problems to show beside those, e.g. of one guide alone; "
      "may be repeated",
      "TEXT")
      ->expected(1, CLI::detail::expected_max_vector_size);
  add("--teacher",
      "MODEL,PROBLEMS,RESULTS of a robot whose experience it is, MODEL its folder; may be repeated",
      "TEXT")
      ->expected(1, CLI::detail::expected_max_vector_size);
  page.add_option("--output", options.output, "HTML file (default: standard output)")
      ->type_name("FILE");
  page.add_flag("--draws", options.draws, "Draw the run that standard input describes")->group("");
}

void add_results_page(CLI::App& results, Session& session) {
  CLI::App* const command = add_command(
      results, "page",
      "Write an HTML page that shows what experience was worth to a robot; it needs nothing else",
      kPageExamples);
  const auto options = std::make_shared<PageOptions>();
  add_page_options(*command, *options);
  on_run(*command, session, [&session, command, options]() -> int {
    if (options->draws)
      return write_page(*options, std::cin, session.out);
    results::Words words = results::words_of(*command);
    words["arguments"] = session.arguments;
    results::become_python(results::script("page.py"), std::move(words));
  });
}

}  // namespace

void add_results(CLI::App& app, Session& session) {
  CLI::App* results =
      add_group(app, session, "results", "Results of kinship-plan: comparisons, pages (no server)");
  add_results_compare(*results, session);
  add_results_page(*results, session);
}

}  // namespace kinship::cli
