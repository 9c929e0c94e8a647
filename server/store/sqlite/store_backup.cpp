#include "server/store/sqlite/store_backup.hpp"

#include <memory>
#include <string>
#include <utility>

#include "server/store/sqlite/call_item.hpp"
#include "server/store/sqlite/new_file.hpp"
#include "server/store/sqlite/online_backup.hpp"

namespace kinship::store {
namespace {

constexpr int kPagesOfAStep = 64;  // 512 KB: for so long reports wait
constexpr int kStepsOfASync = 64;  // so that no step meets more dirty pages than the disk takes

template <typename Function>
std::invoke_result_t<Function, Database&> between_batches(Writer& writer, Function function) {
  auto item = std::make_unique<AfterCommitItem<Function>>(std::move(function));
  auto result = item->result();
  writer.submit(std::move(item));
  return result.get();
}

/// The steps of one backup. The connection owns what it is doing, so that it can close at any
/// time; then the next step finds nothing to go on with.
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
      done_ = source.backup()->step(kPagesOfAStep);
      const double progress = done_ ? 1 : source.backup()->progress();
      if (done_)
        source.backup().reset();
      return progress;
    });
  }
  bool done() const { return done_; }

 private:
  Writer* writer_;
  bool done_ = false;
};

/// \return false if `progress` ended it.
bool copy(Writer& writer, const NewFile& target, const std::function<bool(double)>& progress) {
  Steps steps(writer, target.part());
  for (int step = 1; !steps.done(); ++step) {
    if (!progress(steps.next()))
      return false;
    if (step % kStepsOfASync == 0)
      target.sync();
  }
  return true;
}

}  // namespace

Result<bool> back_up(Writer& writer, const std::filesystem::path& file,
                     const std::function<bool(double)>& progress) {
  try {
    NewFile target(file);
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
