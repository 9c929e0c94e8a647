#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <iostream>

#include "client/planner/plan_options.hpp"
#include "client/planner/plan_run.hpp"
#include "proto/files/lines.hpp"
#include "proto/files/output_file.hpp"
#include "proto/types/failure.hpp"

namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// The first signal ends the run cleanly, the second one at once.
void interrupt(int number) {
  interrupted = true;
  std::signal(number, SIG_DFL);
}

int run(const kinship::planner::PlanOptions& options) {
  std::ifstream problem_file;
  if (options.problems != "-")
    problem_file = kinship::files::open_input(options.problems);
  if (kinship::files::overwrites(options.output, options.problems))
    throw kinship::Failure(kinship::ErrorCode::InvalidInput,
                           "--output '" + options.output.string() + "' is the problem file");
  kinship::files::OutputFile output(options.output, std::cout);
  std::ostream nowhere(nullptr);
  kinship::files::OutputFile searches(options.searches, nowhere);
  const bool is_read_by_people =
      !options.json && options.output.empty() && isatty(STDOUT_FILENO) == 1;
  const kinship::planner::RunStreams streams = {
      .problems = options.problems == "-" ? std::cin : problem_file,
      .results = output.stream(),
      .messages = std::cerr,
      .searches = options.searches.empty() ? nullptr : &searches.stream(),
      .messages_on_terminal = isatty(STDERR_FILENO) == 1 && !is_read_by_people,
      .results_for_people = is_read_by_people};
  const kinship::planner::RunSummary summary =
      kinship::planner::run_plan(options, streams, [] { return interrupted.load(); });
  if (summary.is_complete && !options.searches.empty())
    searches.keep();
  if (summary.is_complete)
    output.keep();
  else if (output.has_part())
    std::cerr << "kinship-plan: the results so far are in '" << output.part().string() << "', '"
              << options.output.string() << "' is left as it was\n";
  else if (!options.output.empty())
    std::cerr << "kinship-plan: no results, '" << options.output.string()
              << "' is left as it was\n";
  return summary.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto options = kinship::planner::parse_plan_options(argc, argv, std::cout, std::cerr);
    if (const int* const code = std::get_if<int>(&options))
      return *code;
    std::signal(SIGINT, interrupt);
    std::signal(SIGTERM, interrupt);
    return run(std::get<kinship::planner::PlanOptions>(options));
  } catch (const kinship::Failure& failure) {
    std::cerr << "kinship-plan: " << failure.what() << '\n';
    return kinship::exit_code(failure.code());
  } catch (const std::exception& error) {
    std::cerr << "kinship-plan: " << error.what() << '\n';
    return kinship::kFailed;
  }
}
