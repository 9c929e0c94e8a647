#include "server/service/job_verbs.hpp"

#include <algorithm>

#include "proto/types/limits.hpp"

namespace kinship::service {

AdminPage list_jobs(const Jobs& jobs, const AdminRequest& request) {
  const std::vector<Job> all = jobs.list();
  // The oldest are forgotten first: if the last one of the page before is gone, so are those that
  // would come after it.
  const auto last = std::find_if(all.rbegin(), all.rend(),
                                 [&](const Job& job) { return job.id == request.cursor; });
  auto next = all.rbegin();
  if (!request.cursor.empty())
    next = last == all.rend() ? all.rend() : last + 1;
  AdminPage page;
  page.status = AdminStatus::Ok;
  for (; next != all.rend() && page.rows.size() < page_size(request); ++next)
    page.rows.emplace_back(*next);
  if (next != all.rend())
    page.next_cursor = (next - 1)->id;
  return page;
}

AdminPage job_rows(const Jobs& jobs, const AdminRequest& request) {
  const Result<std::size_t> first = row_number(request.cursor);
  if (!first)
    return page_of(first.error());
  Result<Jobs::RowPage> rows =
      jobs.rows(request.argument, *first, page_size(request), kMaxPageBytes);
  if (!rows)
    return page_of(rows.error());
  AdminPage page;
  page.status = AdminStatus::Ok;
  for (const std::string& row : rows->rows)
    page.rows.emplace_back(TextLine{row});
  if (rows->next > 0)
    page.next_cursor = std::to_string(rows->next);
  return page;
}

}  // namespace kinship::service
