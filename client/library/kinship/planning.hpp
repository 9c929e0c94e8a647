#pragma once

/// All of the component `planning`: robots, collision, inverse kinematics, samplers, planners, the
/// hook into OMPL, and queries planned as kinship-plan does.
#include <kinship/client.hpp>

#include "client/guided/attempt_record.hpp"
#include "client/guided/guidance.hpp"
#include "client/guided/plan_problem.hpp"
#include "client/guided/scene_record.hpp"
#include "client/ompl/guided_state_sampler.hpp"
#include "client/ompl/ompl_planner.hpp"
#include "client/ompl/planner_choice.hpp"
#include "client/ompl/recall_planner.hpp"
#include "client/ompl/region_state_space.hpp"
#include "client/ompl/state_space.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/fitted_links.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/guided_sampler.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/repetition_roadmap.hpp"
#include "robots/planning/shortcut.hpp"
#include "robots/recall/recall.hpp"
#include "robots/recall/recall_trust.hpp"
