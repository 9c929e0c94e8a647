#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/failure.hpp"
#include "server/service/admin_service.hpp"

namespace kinship::console {

/// Asks the service as the console does, under one name, which quotas and the audit log see. May
/// be shared between threads.
class Questions {
 public:
  /// \param service  outlives the questions.
  /// \param is_admin  may change something.
  Questions(service::AdminService& service, bool is_admin);

  bool is_admin() const noexcept { return caller_.role == AccessRole::Admin; }

  /// Answers on a thread of the service, see AdminService::administer().
  void ask(const AdminRequest& request, const std::function<void(const service::AdminPage&)>& done);

  /// Waits for the answer: not for the network's thread.
  /// \throws Failure with the answer's message if it is not Ok.
  service::AdminPage answer(const AdminRequest& request);

  /// All rows of one kind that a listing has, `max_rows` at most.
  template <typename Row>
  std::vector<Row> rows(AdminRequest request, std::size_t max_rows);

  /// The row of one kind among those of an answer. \throws Failure(NotFound) without one.
  template <typename Row>
  Row row(const AdminRequest& request);

 private:
  service::AdminService& service_;
  const Caller caller_;
  std::atomic<std::uint64_t> asked_ = 0;
};

template <typename Row>
std::vector<Row> Questions::rows(AdminRequest request, std::size_t max_rows) {
  std::vector<Row> rows;
  request.limit = kMaxPageRows;
  do {
    service::AdminPage page = answer(request);
    for (service::AdminRow& row : page.rows)
      if (auto* const wanted = std::get_if<Row>(&row); wanted && rows.size() < max_rows)
        rows.push_back(std::move(*wanted));
    request.cursor = page.next_cursor;
  } while (!request.cursor.empty() && rows.size() < max_rows);
  return rows;
}

template <typename Row>
Row Questions::row(const AdminRequest& request) {
  for (service::AdminRow& row : answer(request).rows)
    if (auto* const wanted = std::get_if<Row>(&row))
      return std::move(*wanted);
  throw Failure(ErrorCode::NotFound, "there is none");
}

}  // namespace kinship::console
