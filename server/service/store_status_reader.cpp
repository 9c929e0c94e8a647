#include "server/service/store_status_reader.hpp"

#include <string>
#include <utility>

namespace kinship::service {

StoreStatusReader::StoreStatusReader(const store::Store& store, runtime::Clock clock,
                                     std::chrono::milliseconds patience)
    : store_(store), clock_(std::move(clock)), patience_(patience), thread_([this] { run(); }) {}

void StoreStatusReader::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  asked_for_.notify_all();
  answered_for_.notify_all();
  if (thread_.joinable())
    thread_.join();
}

void StoreStatusReader::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    asked_for_.wait(lock, [this] { return is_stopping_ || asked_ > answered_; });
    if (is_stopping_)
      return;
    const std::uint64_t answers = asked_;  // all requests until now
    const auto asked_at = clock_.now();
    lock.unlock();
    std::optional<store::StoreStatus> status;
    std::exception_ptr failure;
    try {
      status = store_.status();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    answered_ = answers;
    is_silent_ = false;
    failure_ = failure;
    if (status) {
      last_ = std::move(status);
      last_at_ = asked_at;
    }
    answered_for_.notify_all();
  }
}

store::StoreStatus StoreStatusReader::read() {
  std::unique_lock lock(mutex_);
  const std::uint64_t question = ++asked_;
  asked_for_.notify_all();
  const auto is_over = [&] { return is_stopping_ || answered_ >= question; };
  if (!last_)
    answered_for_.wait(lock, is_over);
  else if (!is_silent_)
    is_silent_ = !answered_for_.wait_for(lock, patience_, is_over) || is_silent_;
  if (is_stopping_) {
    lock.unlock();
    return store_.status();
  }
  if (answered_ < question)
    return of_before();
  if (failure_)
    std::rethrow_exception(failure_);
  return *last_;
}

store::StoreStatus StoreStatusReader::of_before() const {
  store::StoreStatus status = *last_;
  const auto age = std::chrono::duration_cast<std::chrono::seconds>(clock_.now() - last_at_);
  status.epoch = store_.epoch();
  status.writable = false;
  status.message = "the store does not answer: what is counted was so " +
                   std::to_string(age.count()) + " s ago" +
                   (status.message.empty() ? "" : "; " + status.message);
  return status;
}

}  // namespace kinship::service
