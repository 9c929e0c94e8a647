#include "tests/support/cell.hpp"

#include <stdexcept>
#include <utility>

#include "proto/json/admin_rows_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"

namespace kinship::test {
namespace {

constexpr const char* kTask = "sweep";

Cell::Options with_folder(Cell::Options options) {
  std::filesystem::create_directories(options.folder);
  if (options.store.empty())
    options.store = options.folder / "fleet.db";
  return options;
}

}  // namespace

Cell::Cell(Options options)
    : options_(with_folder(std::move(options))),
      client_({.domain = domain_.number(),
               .outbox = options_.folder / "outbox",
               .timeout = std::chrono::seconds(60)}) {}

void Cell::start() {
  server_.reset();
  server_ = std::make_unique<ServerProcess>(ServerProcess::Options{.store = options_.store,
                                                                   .domain = domain_.number(),
                                                                   .arguments = options_.arguments,
                                                                   .log = options_.folder / "log"});
}

Answer Cell::run(const std::string& program, const std::string& line) const {
  return run_to_end(program, words(line + " --timeout 60 --domain " + std::to_string(domain())));
}

RegisterReply Cell::register_model(const std::string& model) {
  RegisterReply reply = client_.register_robot(model_description(model)).value_or_throw();
  if (reply.status == RegisterStatus::Refused)
    throw std::runtime_error("robot " + model + " is refused: " + reply.message);
  return reply;
}

std::vector<Uuid> Cell::report(const Digest& panda, std::uint64_t first, std::uint64_t count) {
  const std::size_t refused_before = client_.outbox().refused;
  std::vector<Uuid> reports;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const Attempt attempt = panda_attempt(panda, kTask, seed);
    reports.push_back(attempt.report_uuid);
    client_.report(attempt);
  }
  const link::Client::OutboxState state = client_.flush(kEnough);
  if (state.pending > 0 || state.refused > refused_before)
    throw std::runtime_error(std::to_string(state.pending) + " reports have no receipt, " +
                             std::to_string(state.refused - refused_before) + " are refused");
  return reports;
}

FetchReply Cell::fetch(const Digest& robot, std::uint64_t minimum_generation) {
  FetchRequest request;
  request.task = kTask;
  request.robot = robot;
  request.profile = "paper";  // the cheapest fits
  request.minimum_generation = minimum_generation;
  request.deadline = std::chrono::seconds(30);
  return client_.fetch(request).value_or_throw();
}

AdminReply Cell::ask(AdminVerb verb, const std::string& argument) {
  AdminRequest request;
  request.verb = verb;
  request.argument = argument;
  return ask(request);
}

ServerStatus Cell::status() {
  return json::row_from_json<ServerStatus>(ask(AdminRequest()).rows.at(0)).value_or_throw();
}

}  // namespace kinship::test
