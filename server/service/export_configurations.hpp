#pragma once

#include <string>

#include "proto/types/distribution.hpp"
#include "proto/types/result.hpp"
#include "server/fitting/fit_distribution.hpp"
#include "server/service/jobs.hpp"

namespace kinship::service {

/// The job that reproduces the configurations to which a distribution was fitted: the same paths,
/// transferred and weighted the same way, without later paths. Its rows are lines of CSV,
/// `path_id,source_robot,pose_index,solution_index,weight,held_out,q_1,...,q_n`: path_id is the
/// UUID of the report, source_robot a digest, the weights sum to their number, and held_out is 0 as
/// long as K is not chosen by held-out configurations.
///
/// The job fails if a source gives another number of configurations than in the fit, e.g. because a
/// path was found to be damaged meanwhile.
///
/// \param context  its references outlive the job.
/// \param request_key    see Jobs::Task.
/// \return Conflict, with a remedy, if the distribution was made by another version of the code, or
///         paths were retired since; InvalidInput if it has no configurations.
Result<Jobs::Task> export_configurations_job(const fitting::FitContext& context,
                                             Distribution distribution,
                                             const std::string& request_key);

}  // namespace kinship::service
