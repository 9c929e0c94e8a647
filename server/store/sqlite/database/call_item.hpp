#pragma once

#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "server/store/sqlite/database/writer.hpp"

namespace kinship::store {

/// Waits for what an item of the writer's queue comes to.
/// \throws Failure(Unavailable) if there was no memory for an answer, and what the item failed
/// with.
template <typename Item>
auto answer_to(Writer& writer, std::unique_ptr<Item> item) {
  auto result = item->result();
  writer.submit(std::move(item));
  try {
    return result.get();
  } catch (const std::future_error&) {  // the item ended without one
    throw Failure(ErrorCode::Unavailable, "no memory");
  }
}

/// A function on the write batch whose result a caller waits for.
template <typename Function>
class CallItem : public WriteItem {
 public:
  using Value = std::invoke_result_t<Function, Batch&>;

  explicit CallItem(Function function) : function_(std::move(function)) {}

  std::future<Value> result() { return promise_.get_future(); }
  void apply(Batch& batch) override { value_.emplace(function_(batch)); }
  void finish(const Error* error) override {
    if (error != nullptr)
      promise_.set_exception(std::make_exception_ptr(Failure(*error)));
    else
      promise_.set_value(std::move(*value_));
  }

 private:
  Function function_;
  std::optional<Value> value_;
  std::promise<Value> promise_;
};

/// A function on the connection between two batches, outside of any transaction, whose result a
/// caller waits for. Reports wait while it runs.
template <typename Function>
class AfterCommitItem : public WriteItem {
 public:
  using Value = std::invoke_result_t<Function, Database&>;

  explicit AfterCommitItem(Function function) : function_(std::move(function)) {}

  std::future<Value> result() { return promise_.get_future(); }
  void apply(Batch& batch) override { database_ = &batch.database(); }
  void finish(const Error* error) override {
    try {
      if (error != nullptr)
        throw Failure(*error);
      promise_.set_value(function_(*database_));
    } catch (...) {
      promise_.set_exception(std::current_exception());
    }
  }

 private:
  Function function_;
  Database* database_ = nullptr;
  std::promise<Value> promise_;
};

}  // namespace kinship::store
