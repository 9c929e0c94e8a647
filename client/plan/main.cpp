#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "client/plan/plan_options.hpp"
#include "client/plan/plan_run.hpp"
#include "proto/types/failure.hpp"

namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// The first signal ends the run cleanly, the second one at once.
void interrupt(int number) {
  interrupted = true;
  std::signal(number, SIG_DFL);
}

int run(const kinship::plan::PlanOptions& options) {
  std::ifstream problem_file;
  if (options.problems != "-") {
    problem_file.open(options.problems);
    if (!problem_file)
      throw kinship::Failure(kinship::ErrorCode::NotFound,
                             "cannot read '" + options.problems.string() + "'");
  }
  std::ofstream result_file;
  if (!options.output.empty()) {
    std::error_code ignored;  // there is no output file yet
    if (std::filesystem::equivalent(options.problems, options.output, ignored))
      throw kinship::Failure(kinship::ErrorCode::InvalidInput,
                             "--output '" + options.output.string() + "' is the problem file");
    result_file.open(options.output);
    if (!result_file)
      throw kinship::Failure(kinship::ErrorCode::Storage,
                             "cannot write '" + options.output.string() + "'");
  }
  const kinship::plan::RunStreams streams = {options.problems == "-" ? std::cin : problem_file,
                                             options.output.empty() ? std::cout : result_file,
                                             std::cerr, isatty(STDERR_FILENO) == 1};
  return kinship::plan::run_plan(options, streams, [] { return interrupted.load(); });
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto options = kinship::plan::parse_plan_options(argc, argv, std::cout, std::cerr);
    if (const int* const code = std::get_if<int>(&options))
      return *code;
    std::signal(SIGINT, interrupt);
    std::signal(SIGTERM, interrupt);
    return run(std::get<kinship::plan::PlanOptions>(options));
  } catch (const kinship::Failure& failure) {
    std::cerr << "kinship-plan: " << failure.what() << '\n';
    return kinship::exit_code(failure.code());
  } catch (const std::exception& error) {
    std::cerr << "kinship-plan: " << error.what() << '\n';
    return kinship::kFailed;
  }
}
