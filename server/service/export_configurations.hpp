#pragma once

#include <string>

#include "proto/types/distribution.hpp"
#include "proto/types/result.hpp"
#include "server/fitting/fit_distribution.hpp"
#include "server/service/jobs.hpp"

namespace kinship::service {

/// The job that makes the configurations again to which a distribution was fitted: the same paths,
/// transferred and weighed the same way. Paths that came later do not matter. Its rows are lines of
/// CSV, `path_id,source_robot,pose_index,solution_index,weight,held_out,q_1,...,q_n`: path_id is
/// the UUID of the report, source_robot a digest, the weights sum to their number, and held_out is
/// 0 as long as K is not chosen by held-out configurations.
///
/// The job fails if it does not come to as many configurations of each source as the fit did, e.g.
/// because a path was found to be damaged meanwhile.
///
/// \param context  what it refers to outlives the job.
/// \param request_key    see Jobs::Task.
/// \return Conflict, with what to do, if the distribution was made by other code than this
/// server's,
///         or paths were retired since; InvalidInput if it has no configurations.
Result<Jobs::Task> export_configurations_job(const fitting::FitContext& context,
                                             Distribution distribution,
                                             const std::string& request_key);

}  // namespace kinship::service
