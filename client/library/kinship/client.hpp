#pragma once

/// All of the component `client`: register a robot, report attempts, fetch and follow
/// distributions, draw from them. Include this header; the headers it includes may move, names in
/// namespace kinship do so only with a new minor version.
#include <kinship/version.hpp>

#include "client/link/client.hpp"
#include "client/link/environment.hpp"
#include "client/link/follower.hpp"
#include "client/link/watcher.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/mixture/sampler.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/pose.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
