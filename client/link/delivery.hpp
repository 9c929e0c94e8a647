#pragma once

#include <chrono>
#include <functional>
#include <vector>

#include "client/link/interruptible_sleep.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"

namespace kinship::link {

/// Sends attempts to a server in batches within its limits; repeats those that it could not store.
/// \param timeout  of a batch with its repetitions, without the pauses that the server asks for, up
///                 to 10 minutes.
/// \param sleep    ending it ends the delivery: an attempt without receipt is TryAgain.
/// \param send     sends a batch and waits for its reply until the deadline.
/// \return one receipt per attempt, in order; an error if a batch had no reply at all.
Result<std::vector<Receipt>> deliver(
    std::vector<Attempt> attempts, std::chrono::milliseconds timeout, InterruptibleSleep& sleep,
    const std::function<Result<ReportReply>(const ReportRequest&,
                                            std::chrono::steady_clock::time_point deadline)>& send);

}  // namespace kinship::link
