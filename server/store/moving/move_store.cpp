#include "server/store/moving/move_store.hpp"

#include <chrono>
#include <memory>
#include <utility>

#include "server/store/moving/copying.hpp"
#include "server/store/moving/side.hpp"
#include "server/store/open_store.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store {
namespace {

using moving::Side;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

constexpr std::string_view kMovingEpoch = "moving_epoch";  // target: of the source, when it began
constexpr std::string_view kMovedToStore = "moved_to_store";  // source: which one, beside its name

bool is_database(const std::string& name) {
  return kind_of_store(name).value_or_throw() == StoreKind::PostgresDatabase;
}

void require_move(const MoveOptions& options) {
  if (is_database(options.from) || is_database(options.to))
    return;
  throw Failure(ErrorCode::InvalidInput, "migrate-store: '" + options.from + "' and '" +
                                             options.to +
                                             "' are both files: 'kinshipd backup --store " +
                                             options.from + " " + options.to + "' copies one");
}

std::unique_ptr<Side> open_source(const std::string& name) {
  return is_database(name) ? moving::open_postgres_source(name) : moving::open_sqlite_source(name);
}

std::unique_ptr<Side> open_target(const std::string& name) {
  return is_database(name) ? moving::open_postgres_target(name) : moving::open_sqlite_target(name);
}

/// In one transaction.
void mark_moved(Side& source, Side& target) {
  source.in_last_transaction([&] {
    source.put_setting(kMovedTo, target.name());
    source.put_setting(kMovedToStore, target.identity());
  });
}

void unmark_moved(Side& source) {
  source.in_last_transaction([&] {
    source.put_setting(kMovedTo, std::nullopt);
    source.put_setting(kMovedToStore, std::nullopt);
  });
}

/// A move under way, from one opened store to another.
class Move {
 public:
  Move(const MoveOptions& options, Side& source, Side& target)
      : options_(options), source_(source), target_(target) {
    result_.from = source.name();
    result_.to = target.name();
  }

  MoveResult run() {
    if (is_done_already()) {
      result_.was_done = true;
      return std::move(result_);
    }
    require_or_begin_target();
    if (std::string server = source_.served_by(); !server.empty()) {
      copy_beside_server();
      compare([this](const moving::RowsDone& rows_done) {
        return moving::verify_beside_server(source_, target_, rows_done);
      });
      if (!result_.verification.is_equal()) {
        result_.served_by = std::move(server);
        return std::move(result_);
      }
      // It may have ended meanwhile.
      if (server = source_.served_by(); !server.empty()) {
        result_.served_by = std::move(server);
        return std::move(result_);
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  bool is_done_already() {
    return !source_.setting(kMovedTo).empty() && !was_moved_elsewhere() &&
           target_.setting(kMovingFrom).empty() && target_.setting(kMovedFrom) == origin();
  }

  /// A target has many names: a database can be asked for by each host, with any parameters.
  bool was_moved_elsewhere() {
    return !source_.setting(kMovedTo).empty() &&
           source_.setting(kMovedToStore) != target_.identity();
  }

  /// Names the source, also if it is at another place by now.
  std::string origin() { return source_.epoch().text(); }

  void require_or_begin_target() {
    const std::string to = "store '" + target_.name() + "'";
    if (was_moved_elsewhere())
      throw Failure(ErrorCode::Conflict, "store '" + source_.name() + "' was moved to '" +
                                             source_.setting(kMovedTo) + "' already");
    if (const std::string server = target_.served_by(); !server.empty())
      throw Failure(ErrorCode::Unavailable, server + "; a move fills a store that nobody serves");
    const std::string from = target_.setting(kMovingFrom);
    if (from.empty() && target_.has_content())
      throw Failure(ErrorCode::Conflict, to + " holds a store already; a move needs an empty one");
    if (!from.empty() && target_.setting(kMovingEpoch) != origin())
      throw Failure(ErrorCode::Conflict,
                    to + " is being filled from '" + from + "' of epoch " +
                        target_.setting(kMovingEpoch) + ", not from '" + source_.name() +
                        "' of epoch " + origin() +
                        "; to give that up: 'kinshipd migrate-store --give-up --to THIS'");
    target_.claim();
    target_.in_transaction([&] {
      target_.put_setting(kMovingFrom, source_.name());
      target_.put_setting(kMovingEpoch, origin());
    });
  }

  /// Copies until the changes during one copy take the next one less than a second.
  void copy_beside_server() {
    constexpr int kMaxCopies = 5;
    constexpr double kShort_s = 1;
    for (int copies = 0; copies < kMaxCopies; ++copies) {
      copy();
      if (copies > 0 && result_.last_copy_s < kShort_s)
        return;
    }
  }

  void copy() {
    const auto begin = Clock::now();
    moving::Copying copying(source_, target_, [&](std::uint64_t rows, std::uint64_t total) {
      options_.progress({MoveStep::Copying, rows, total});
    });
    copying.run();
    for (const auto& [table, rows] : copying.written())
      result_.written[table] += rows;
    result_.last_copy_s = seconds_since(begin);
    result_.copy_s += result_.last_copy_s;
  }

  template <typename Verify>
  void compare(Verify verify) {
    const auto begin = Clock::now();
    result_.verification = verify([&](std::uint64_t rows, std::uint64_t total) {
      options_.progress({MoveStep::Verifying, rows, total});
    });
    result_.verify_s += seconds_since(begin);
  }

  /// No server serves the source. mark_moved() closes it first, so that none will.
  void finish() {
    mark_moved(source_, target_);
    try {
      const std::string writes = source_.writes_seen();
      require_unserved(writes);
      copy();
      compare([this](const moving::RowsDone& rows_done) {
        return moving::verify(source_, target_, rows_done);
      });
      require_unserved(writes);
    } catch (...) {
      reopen_source();
      throw;
    }
    if (!result_.verification.is_equal())
      return reopen_source();
    AuditEntry entry;
    entry.verb = "migrate-store";
    entry.is_local = true;
    entry.target = target_.name();
    entry.outcome = AuditOutcome::Done;
    entry.before = "'" + source_.name() + "', epoch " + origin();
    target_.in_last_transaction([&] {
      target_.put_setting(kMovedFrom, origin());
      target_.complete();
      target_.add_audit(entry);
      target_.put_setting(kMovingEpoch, std::nullopt);
      target_.put_setting(kMovingFrom, std::nullopt);
    });
  }

  /// Throws if a server opened the source just before it was closed, or wrote to it.
  void require_unserved(const std::string& writes) {
    if (const std::string server = source_.served_by(); !server.empty())
      throw Failure(ErrorCode::Unavailable, server + "; stop it and go on");
    if (source_.writes_seen() != writes)
      throw Failure(ErrorCode::Unavailable,
                    "store '" + source_.name() + "': somebody wrote to it meanwhile");
    if (const std::string server = target_.served_by(); !server.empty())
      throw Failure(ErrorCode::Unavailable, server + "; a move fills a store that nobody serves");
  }

  void reopen_source() noexcept {
    try {
      unmark_moved(source_);
    } catch (const std::exception&) {
      // The next opening says how to go on.
    }
  }

  const MoveOptions& options_;
  Side& source_;
  Side& target_;
  MoveResult result_;
};

std::string give_up_target(const std::string& name) {
  static_cast<void>(open_source(name));  // nothing is made where there is nothing
  const std::unique_ptr<Side> target = open_target(name);
  const std::string from = target->setting(kMovingFrom);
  if (from.empty())
    throw Failure(ErrorCode::InvalidInput,
                  "store '" + target->name() + "' is not being filled by a move");
  target->remove_all();
  return "store '" + target->name() + "': what was copied from '" + from + "' is removed\n";
}

std::string give_up_source(const std::string& name) {
  const std::unique_ptr<Side> source = open_source(name);
  const std::string to = source->setting(kMovedTo);
  if (to.empty())
    throw Failure(ErrorCode::InvalidInput, "store '" + source->name() + "' was not moved");
  if (const std::string server = source->served_by(); !server.empty())
    throw Failure(ErrorCode::Unavailable, server);
  unmark_moved(*source);
  return "store '" + source->name() + "': may be served again; it had been moved to '" + to +
         "', which must not be served too\n";
}

}  // namespace

MoveResult move_store(const MoveOptions& options) {
  require_move(options);
  const std::unique_ptr<Side> source = open_source(options.from);
  const std::unique_ptr<Side> target = open_target(options.to);
  return Move(options, *source, *target).run();
}

std::string give_up_move(const std::string& from, const std::string& to) {
  std::string done;
  if (!to.empty())
    done += give_up_target(to);
  if (!from.empty())
    done += give_up_source(from);
  return done;
}

}  // namespace kinship::store
