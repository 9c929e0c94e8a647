#include "server/store/postgres/replica.hpp"

#include <algorithm>
#include <utility>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/transaction.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::chrono::seconds kPatience{3};  // the primary can be asked instead
constexpr std::chrono::seconds kFirstPause{1}, kLongestPause{60}, kPauseOfAPrimary{10};

/// Whether the server ended only the reading, in favour of its replay, and goes on.
bool is_conflict(const PostgresError& error) {
  return error.kind() == ErrorKind::Conflict || error.kind() == ErrorKind::Busy;
}

}  // namespace

Replica::Replica(const ConnectionString& host, const ConnectionOptions& options)
    : host_(host.to_any_role()),
      options_{.patience = std::min<std::chrono::milliseconds>(options.patience, kPatience),
               .interrupt = options.interrupt,
               .is_pooled = &is_pooled_},
      pool_([this] { return std::make_unique<Connection>(host_, options_); }) {
  use_.host = host_.description();
}

Replica::Answer Replica::read(const Read& read) {
  if (!begin())
    return Answer::LeftOut;
  try {
    const Answer answer = pool_.use([&](Connection& connection) {
      const Transaction snapshot(connection, Transaction::Kind::Snapshot);
      return read(connection);
    });
    end(answer, "", false);
    return answer;
  } catch (const PostgresError& error) {
    if (!is_conflict(error))
      pool_.forget();
    end(Answer::Failed, error.what(), !is_conflict(error));
    return Answer::Failed;
  } catch (...) {
    end(Answer::Failed, "the reading failed", false);
    throw;
  }
}

/// \return whether it may be asked.
bool Replica::begin() {
  const std::lock_guard lock(mutex_);
  if (!is_left_alone_)
    return true;
  if (is_tried_ || Clock::now() < left_until_)
    return false;
  is_tried_ = true;
  return true;
}

void Replica::end(Answer answer, const std::string& message, bool is_away) {
  const std::lock_guard lock(mutex_);
  is_tried_ = false;
  use_.message = message;
  if (answer == Answer::Failed)
    ++use_.failed;
  // Several that were on their way when it went away are one time.
  if (is_away && is_left_alone_ && Clock::now() < left_until_)
    return;
  pause_ = is_away ? std::clamp<Clock::duration>(2 * pause_, kFirstPause, kLongestPause)
                   : Clock::duration::zero();
  is_left_alone_ = is_away || answer == Answer::Primary;
  left_until_ = Clock::now() + (is_away ? pause_ : kPauseOfAPrimary);
  if (answer == Answer::Primary)
    use_.message = "it is the primary";
  if (answer == Answer::Read)
    ++use_.readings;
  if (answer == Answer::Behind) {
    ++use_.behind;
    use_.message = "it is behind the primary";
  }
  if (answer == Answer::Damaged) {
    ++use_.failed;
    use_.message = "what it has is damaged";
  }
}

ReplicaUse Replica::use() const {
  const std::lock_guard lock(mutex_);
  return use_;
}

}  // namespace kinship::store::postgres
