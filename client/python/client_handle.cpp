#include "client/python/client_handle.hpp"

#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "client/link/robot_names.hpp"
#include "proto/types/limits.hpp"

namespace kinship::python {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kSlice = 500ms;  // so long a signal may have to wait

milliseconds left_until(Clock::time_point deadline) {
  return std::max(0ms, std::chrono::duration_cast<milliseconds>(deadline - Clock::now()));
}

bool is_final(const Result<FetchReply>& reply) {
  return reply && reply->status != FetchStatus::Pending && reply->status != FetchStatus::Busy;
}

/// Of a final reply with experience: whether its rehearsal goes on.
bool is_being_rehearsed(const FetchReply& reply) {
  return (reply.status == FetchStatus::Ready || reply.status == FetchStatus::Failed) &&
         !(reply.rehearsal && reply.rehearsal->is_complete);
}

/// An error that tells of its slice, telling of the whole time.
Error in_all(Error error, milliseconds asked_for) {
  if (error.code == ErrorCode::Unavailable && asked_for > kSlice)
    error.message += ", asked anew until " + std::to_string(asked_for.count()) + " ms had passed";
  return error;
}

}  // namespace

ClientHandle::ClientHandle(const link::ClientOptions& options) {
  const py::gil_scoped_release unlocked;
  client_ = std::make_shared<link::Client>(options);
}

std::shared_ptr<link::Client> ClientHandle::line() const {
  if (!client_)
    throw Failure(ErrorCode::InvalidInput, "the client is closed");
  client_->require_own_process();
  return client_;
}

void ClientHandle::close() {
  std::shared_ptr<link::Client> client = std::move(client_);
  client_.reset();
  auto abandoned = std::exchange(abandoned_, {});
  if (client && client->is_forked()) {  // calls under way are those of the other process
    static_cast<void>(std::make_unique<decltype(abandoned)>(std::move(abandoned)).release());
    return;
  }
  const py::gil_scoped_release unlocked;
  if (client)
    client->cancel();
  abandoned.clear();  // waits for them, which does not take long now
  client.reset();
}

Result<FetchReply> ClientHandle::fetch(FetchRequest request) const {
  const milliseconds asked_for = request.deadline;
  const Clock::time_point deadline = Clock::now() + asked_for;
  std::optional<Result<FetchReply>> last;
  while (true) {
    const std::shared_ptr<link::Client> client = line();
    request.deadline = std::min(kSlice, left_until(deadline));
    const Clock::time_point slice_end = Clock::now() + request.deadline;
    {
      const py::gil_scoped_release unlocked;
      Result<FetchReply> reply = client->fetch(request);
      const bool is_too_early = !reply || reply->status == FetchStatus::Busy;  // to ask again
      if (reply || !last)  // no answer this time does not undo that of last time
        last.emplace(std::move(reply));
      if (is_too_early)
        std::this_thread::sleep_until(std::min(slice_end, deadline));
    }
    if (is_final(*last))
      return *std::move(last);
    hear_signals();
    if (Clock::now() >= deadline - 1ms)
      return *last ? *std::move(last) : in_all(last->error(), asked_for);
  }
}

Result<FetchReply> ClientHandle::fetch_rehearsed(FetchRequest request) const {
  const Clock::time_point deadline = Clock::now() + request.deadline;
  while (true) {
    request.deadline = std::min(left_until(deadline), milliseconds(kMaxFetchDeadline_ms));
    Result<FetchReply> reply = wait_for<Result<FetchReply>>(
        [request](link::Client& client) { return client.fetch(request); });
    if (!reply || !is_being_rehearsed(*reply) || Clock::now() >= deadline - 1ms)
      return reply;
    wait_until([&](milliseconds slice) {
      std::this_thread::sleep_for(slice);
      return true;
    });
  }
}

link::Client::OutboxState ClientHandle::flush(milliseconds timeout) const {
  const Clock::time_point deadline = Clock::now() + timeout;
  while (true) {
    const std::shared_ptr<link::Client> client = line();
    link::Client::OutboxState state;
    {
      const py::gil_scoped_release unlocked;
      state = client->flush(std::min(kSlice, left_until(deadline)));
    }
    if (state.pending == 0 || Clock::now() >= deadline)
      return state;
    hear_signals();
  }
}

Digest ClientHandle::find(const RobotName& robot) const {
  if (const auto* known = std::get_if<std::shared_ptr<Robot>>(&robot))
    return (*known)->digest();
  const auto& name = std::get<std::string>(robot);
  if (const auto digest = Digest::from_hex(name))
    return *digest;
  return wait_for<Result<RobotSummary>>(
             [name](link::Client& client) { return link::find_robot(client, name); })
      .value_or_throw()
      .robot;
}

std::shared_ptr<const Distribution> wait_for_newer(const link::Follower& follower,
                                                   const std::shared_ptr<const Distribution>& held,
                                                   milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  while (true) {
    std::shared_ptr<const Distribution> newest;
    {
      const py::gil_scoped_release unlocked;
      newest = follower.wait_for_newer(held, std::min(deadline, Clock::now() + kSlice));
    }
    const bool is_newer = newest && (!held || newest->revision != held->revision ||
                                     newest->store_epoch != held->store_epoch);
    if (is_newer || Clock::now() >= deadline)
      return newest;
    hear_signals();
  }
}

}  // namespace kinship::python
