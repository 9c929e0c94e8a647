#include "tests/faults/bystander.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"

namespace kinship::test {
namespace {

using Clock = std::chrono::steady_clock;

FetchRequest sweep_request(const Digest& robot) {
  FetchRequest request;
  request.task = "sweep";
  request.robot = robot;
  return request;
}

/// \param call  returns what was answered instead of what was asked for; empty: nothing.
template <typename Call>
void time_call(Bystander::Calls& calls, const Call& call) {
  const Clock::time_point start = Clock::now();
  if (std::string answer = call(); !answer.empty()) {
    ++calls.unanswered;
    calls.answer = std::move(answer);
  }
  calls.times_s.push_back(std::chrono::duration<double>(Clock::now() - start).count());
}

/// What came instead of what was asked for; empty if that came.
template <typename Reply>
std::string instead(const std::string& call, const Result<Reply>& reply, bool is_good) {
  if (is_good)
    return "";
  if (!reply)
    return call + ": " + reply.error().message;
  return call + ": status " + std::to_string(static_cast<int>(reply->status)) + ", '" +
         reply->message + "'";
}

std::string median_and_longest_ms(std::vector<double> times_s) {
  std::sort(times_s.begin(), times_s.end());
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << 1e3 * times_s.at(times_s.size() / 2) << "/"
       << 1e3 * times_s.back();
  return text.str();
}

}  // namespace

Bystander::Bystander(std::uint32_t domain, const std::filesystem::path& outbox)
    : client_({.domain = domain, .outbox = outbox, .timeout = std::chrono::seconds(20)}),
      panda_(client_.register_robot(model_description("panda")).value_or_throw().robot) {
  for (std::uint64_t i = 0; i < 10; ++i)
    client_.report(panda_attempt(panda_, "sweep", i));
  FetchRequest request = sweep_request(panda_);
  request.deadline = std::chrono::minutes(1);
  if (client_.flush(std::chrono::minutes(1)).accepted != 10 ||
      client_.fetch(request).value_or_throw().status != FetchStatus::Ready)
    throw std::runtime_error("the bystander has no distribution");
}

Bystander::Rounds Bystander::live(int rounds) {
  Rounds result;
  for (int round = 0; round < rounds && result.unanswered() == 0; ++round) {
    time_call(result.status, [&] {
      const auto reply = client_.admin({});
      return instead("status", reply, reply && reply->status == AdminStatus::Ok);
    });
    time_call(result.fetch, [&] {
      const auto reply = client_.fetch(sweep_request(panda_));
      return instead("cached fetch", reply, reply && reply->status == FetchStatus::Ready);
    });
    time_call(result.report, [&] {
      auto receipts = client_.deliver({panda_attempt(panda_, "beside", 100 + reports_++)});
      const Result<Receipt> receipt =
          receipts ? Result<Receipt>(receipts->at(0)) : Result<Receipt>(receipts.error());
      return instead("report", receipt, receipt && receipt->status == ReceiptStatus::Stored);
    });
  }
  return result;
}

std::string table_row(const std::string& beside_whom, const Bystander::Rounds& alone,
                      const Bystander::Rounds& beside) {
  const auto pair = [](const Bystander::Calls& without, const Bystander::Calls& with) {
    return median_and_longest_ms(without.times_s) + " -> " + median_and_longest_ms(with.times_s);
  };
  return beside_whom + ", median/longest in ms: status " + pair(alone.status, beside.status) +
         "; cached fetch " + pair(alone.fetch, beside.fetch) + "; durable report " +
         pair(alone.report, beside.report);
}

}  // namespace kinship::test
