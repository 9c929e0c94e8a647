#include "server/app/migrate_store.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <string>

#include "proto/types/exit_code.hpp"
#include "proto/types/failure.hpp"
#include "server/store/moving/move_store.hpp"

namespace kinship::app {
namespace {

using Clock = std::chrono::steady_clock;

/// Rows, their rate and how long the rest will take, on one line of a terminal.
class MoveLine {
 public:
  MoveLine(std::ostream& err, bool show) : err_(&err), show_(show) {}
  MoveLine(const MoveLine&) = delete;
  MoveLine& operator=(const MoveLine&) = delete;
  ~MoveLine() { clear(); }

  void show(const store::MoveProgress& progress) {
    const Clock::time_point now = Clock::now();
    if (progress.step != step_ || progress.rows < rows_) {
      step_ = progress.step;
      begin_ = now;
      first_rows_ = progress.rows;
    }
    rows_ = progress.rows;
    if (!show_ || now - shown_ < std::chrono::milliseconds(200))
      return;
    shown_ = now;
    std::ostringstream line;
    line << (step_ == store::MoveStep::Copying ? "copied " : "compared ") << progress.rows << " of "
         << progress.total << " rows";
    const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
    if (const double done = static_cast<double>(rows_ - first_rows_); elapsed_s > 1 && done > 0) {
      const double per_s = done / elapsed_s;
      line << ", " << std::fixed << std::setprecision(0) << per_s << "/s, "
           << static_cast<double>(progress.total - std::min(progress.total, rows_)) / per_s
           << " s left";
    }
    clear();
    length_ = line.str().size();
    *err_ << line.str() << std::flush;
  }

 private:
  void clear() {
    if (length_ > 0)
      *err_ << '\r' << std::string(length_, ' ') << '\r' << std::flush;
    length_ = 0;
  }

  std::ostream* err_;
  bool show_;
  store::MoveStep step_ = store::MoveStep::Copying;
  std::uint64_t rows_ = 0, first_rows_ = 0;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point shown_{};
  std::size_t length_ = 0;
};

void print_tables(const store::MoveResult& result, std::ostream& out) {
  for (const store::moving::VerifiedTable& table : result.verification.tables) {
    out << "  " << std::left << std::setw(24) << table.name << std::right << std::setw(10)
        << table.source.rows << " rows" << std::setw(10) << table.target.rows << " there  "
        << std::hex << std::setfill('0') << std::setw(8) << table.target.digest << std::dec
        << std::setfill(' ');
    if (table.differences > 0)
      out << "  " << table.differences << " differ";
    if (table.damaged > 0)
      out << "  " << table.damaged << " damaged";
    out << '\n';
  }
}

void print_messages(const store::MoveResult& result, std::ostream& out) {
  for (const std::string& message : result.verification.messages)
    out << message << '\n';
  if (!result.verification.is_equal())
    out << result.verification.differences
        << " rows differ: not done; the source may be served on\n";
}

std::uint64_t rows_written(const store::MoveResult& result) {
  std::uint64_t rows = 0;
  for (const auto& [table, count] : result.written)
    rows += count;
  return rows;
}

int print(const store::MoveResult& result, std::ostream& out) {
  if (result.was_done) {
    out << "'" << result.from << "' was moved to '" << result.to << "' already\n";
    return kDone;
  }
  out << std::fixed << std::setprecision(1) << "copied " << rows_written(result) << " rows from '"
      << result.from << "' to '" << result.to << "' in " << result.copy_s << " s, compared in "
      << result.verify_s << " s\n";
  if (!result.served_by.empty()) {
    print_messages(result, out);
    out << "not done yet: " << result.served_by
        << "\nStop it and run the same command again. To bring what came meanwhile took "
        << result.last_copy_s << " s\n";
    return kFailed;
  }
  print_tables(result, out);
  print_messages(result, out);
  if (!result.verification.is_equal())
    return kFailed;
  out << "all rows are the same\ndone: serve '" << result.to << "' now; '" << result.from
      << "' is closed to servers, and can be removed\n";
  return kDone;
}

}  // namespace

int run_migrate_store(const MigrateStoreOptions& options, std::ostream& out, std::ostream& err,
                      bool show_progress) {
  try {
    if (options.give_up) {
      out << store::give_up_move(options.from, options.to);
      return kDone;
    }
    MoveLine line(err, show_progress);
    store::MoveOptions move{options.from, options.to,
                            [&line](const store::MoveProgress& progress) { line.show(progress); }};
    return print(store::move_store(move), out);
  } catch (const Failure& failure) {
    err << "kinshipd: " << failure.what() << '\n';
    // A server that has a store open is a failure here; code 4 speaks of servers that answer.
    return failure.code() == ErrorCode::Unavailable ? kFailed : exit_code(failure.code());
  }
}

}  // namespace kinship::app
