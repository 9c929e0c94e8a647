#pragma once

#include "server/service/admin_page.hpp"
#include "server/service/jobs.hpp"

/// The admin verbs about jobs that are on their way or ended.
namespace kinship::service {

AdminPage list_jobs(const Jobs& jobs, const AdminRequest& request);

/// The rows of a job that is done, kMaxPageBytes a page.
AdminPage job_rows(const Jobs& jobs, const AdminRequest& request);

}  // namespace kinship::service
