#include "server/store/sqlite/upkeep/store_backup.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "server/store/sqlite/database/call_item.hpp"
#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/files/store_file.hpp"

namespace kinship::store {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPagesOfACall = 128;  // 512 KB: between two looks at the clock
// For so long reports wait at a step: a quarter of the writer's time, so that the share of the
// backup is the same whether batches are short or long.
constexpr Clock::duration kShortestStep = std::chrono::milliseconds(1);
constexpr Clock::duration kLongestStep = std::chrono::milliseconds(10);
constexpr int kPagesOfASync = 8192;  // so that no step meets more dirty pages than the disk takes

template <typename Function>
std::invoke_result_t<Function, Database&> between_batches(Writer& writer, Function function) {
  return answer_to(writer, std::make_unique<AfterCommitItem<Function>>(std::move(function)));
}

/// The steps of one backup. The connection owns their state, so that it can close at any time; then
/// the next step finds nothing to go on with.
class Steps {
 public:
  Steps(Writer& writer, const std::filesystem::path& target) : writer_(&writer) {
    between_batches(writer, [&](Database& source) {
      if (source.backup())
        throw Failure(ErrorCode::Unavailable, "another backup is on its way");
      source.backup() = std::make_unique<OnlineBackup>(source, target);
      return true;
    });
  }
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;
  ~Steps() {
    if (done_)
      return;
    try {
      between_batches(*writer_, [](Database& source) {
        source.backup().reset();
        return true;
      });
    } catch (const std::exception&) {
      // The writer closed its connection, and the backup with it.
    }
  }

  /// \return how far it is; 1: complete.
  double next() {
    return between_batches(*writer_, [this](Database& source) {
      if (!source.backup())
        throw Failure(ErrorCode::Storage, "the store had to be opened again meanwhile");
      const Clock::time_point start = Clock::now();
      const Clock::time_point end =
          start + std::clamp((start - last_end_) / 3, kShortestStep, kLongestStep);
      do {
        done_ = source.backup()->step(kPagesOfACall);
        pages_ += kPagesOfACall;
      } while (!done_ && Clock::now() < end);
      const double progress = done_ ? 1 : source.backup()->progress();
      if (done_)
        source.backup().reset();
      last_end_ = Clock::now();
      return progress;
    });
  }
  bool done() const { return done_; }
  int pages() const { return pages_; }  ///< copied so far, some of them again

 private:
  Writer* writer_;
  bool done_ = false;
  int pages_ = 0;
  Clock::time_point last_end_ = Clock::now();  // of a step
};

/// \return false if `progress` ended it.
bool copy(Writer& writer, const files::NewFile& target,
          const std::function<bool(double)>& progress) {
  Steps steps(writer, target.part());
  int synced = 0;
  while (!steps.done()) {
    if (!progress(steps.next()))
      return false;
    if (steps.pages() - synced >= kPagesOfASync) {
      target.sync();
      synced = steps.pages();
    }
  }
  return true;
}

}  // namespace

Result<bool> back_up(Writer& writer, const std::filesystem::path& file,
                     const std::function<bool(double)>& progress) {
  try {
    files::NewFile target(file, kNewDatabase);
    if (!copy(writer, target, progress))
      return false;
    make_plain(target.part());
    target.publish();
    return true;
  } catch (const Failure& failure) {
    const std::string named = "backup '" + file.string() + "': " + failure.what();
    if (failure.code() == ErrorCode::Conflict)
      return failure.error();
    if (failure.code() == ErrorCode::Unavailable)
      return Error{ErrorCode::Unavailable, named};
    throw Failure(failure.code(), named);
  }
}

}  // namespace kinship::store
