/** \file kinship_planning.h
 * Kinship's planners for C: a path of one query, guided by what kinship.h fetched, proven to touch
 * nothing between its waypoints, and its report. Planning needs no server. The rules of kinship.h
 * hold here too.
 */
#ifndef KINSHIP_PLANNING_H
#define KINSHIP_PLANNING_H

#include "kinship.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Names as C has them. NOLINTBEGIN(readability-identifier-naming,readability-function-size) */

/** A robot to plan for. Never changes: threads share one, and plan at once. */
typedef struct kinship_planner kinship_planner;

/** Reads the robot's files as kinship_world_create() does, once for all queries; that may take
 * seconds. \param dof  number of joints; may be NULL. */
KINSHIP_API kinship_code kinship_planner_create(const kinship_robot_file* file,
                                                kinship_planner** planner, size_t* dof);
KINSHIP_API void kinship_planner_free(kinship_planner* planner);

/** A box in the space of poses that the transfer frame must not leave along a whole path: x, y, z
 * (m) and roll, pitch, yaw (rad, R = Rz(yaw) Ry(pitch) Rx(roll)) of the frame "end" in the frame
 * "region". Both coincide where the transfer frame is at T_task_region * T_region_end. */
typedef struct kinship_region {
  size_t size;
  double T_task_region[7];
  double T_region_end[7]; /**< the transfer frame in the region's, without displacement */
  double lower[6];        /**< -INFINITY without a bound */
  double upper[6];        /**< INFINITY without a bound */
} kinship_region;

/** Sets the bounds of a region, and nothing else of it, for an orientation to be kept as MoveIt has
 * it: bounded are Rx(a) Ry(b) Rz(c), or a rotation vector. Beside a free turn the others get bounds
 * under which every tilt of the region is one of the tolerances; without one all three are made
 * smaller, so that every orientation of the region is. No position is bounded.
 * \param tolerances  of a, b and c, rad; pi or more: free.
 * \return KINSHIP_INVALID_INPUT if they bound no tilt: two are free, or b alone. */
KINSHIP_API kinship_code kinship_region_keep_orientation(const double* tolerances,
                                                         int is_rotation_vector,
                                                         kinship_region* region);

/** What is to be planned, and with which guidance. */
typedef struct kinship_query {
  size_t size;
  const kinship_surroundings* surroundings; /**< NULL: nothing */
  size_t dof;
  const double* start;       /**< dof numbers, joint units */
  const double* goals;       /**< dof numbers each, one after the other; any of them will do */
  size_t goal_count;         /**< 0: any configuration at T_task_goal */
  const double* T_task_goal; /**< of the transfer frame, in the task's frame; else not looked at */
  double time_limit_s;       /**< 0: 10 */
  uint64_t seed;             /**< equal queries with equal seeds have equal paths */
  /** "birrt", "cbirrt2", "roadmap" or "rrtconnect"; NULL: birrt, with a region cbirrt2. With one
   * cbirrt2 and roadmap alone have paths. */
  const char* algorithm;
  /** What guides it, of the robot at this placement (else: KINSHIP_INVALID_INPUT); NULL: not guided
   * by that. They are used during the call only. */
  const kinship_distribution* distribution;
  kinship_recall* recall;
  double share; /**< of samples drawn from the distribution; 0: the one it recommends */
  /** KINSHIP_CONTROL: guidance is there, but on purpose not used, to compare. Else it is used. */
  kinship_sampling sampling;
  /** Called by the calling thread before every check: not 0 ends planning. NULL: never. */
  int (*stop)(void* user);
  void* user;                   /**< its argument */
  const kinship_region* region; /**< along the whole path; NULL: none */
} kinship_query;

/** An answer: a path, or why there is none. Never changes. */
typedef struct kinship_plan kinship_plan;

/** Plans: recalled paths first, then a search, then shortcuts, and a proof of every edge.
 * \param plan  set with KINSHIP_OK, whether there is a path or not.
 * \return KINSHIP_INVALID_INPUT for a query that is not proper, as kinship_world_create() for its
 * surroundings. */
KINSHIP_API kinship_code kinship_plan_find(const kinship_planner* planner,
                                           const kinship_query* query, kinship_plan** plan);
KINSHIP_API void kinship_plan_free(kinship_plan* plan);

typedef struct kinship_plan_info {
  size_t size;
  int is_solved;
  int is_recalled;       /**< 1: a stored path, moved onto the query; nothing was searched */
  int is_stopped;        /**< 1: by `stop`; it cannot be reported */
  size_t waypoint_count; /**< 0 without a path */
  size_t dof;
  uint64_t collision_checks; /**< of planning, goals and shortcuts */
  double planning_time_s;    /**< without goal configurations and shortcuts */
  double processor_time_s;   /**< of all of it */
  const char* reason;        /**< why there is no path, in words; "" if there is */
  const char* planner;       /**< its name. Both texts are valid until the plan is freed */
} kinship_plan_info;

KINSHIP_API kinship_code kinship_plan_describe(const kinship_plan* plan, kinship_plan_info* info);
/** \param waypoints  waypoint_count x dof numbers, start first, straight between them.
 * \return KINSHIP_NOT_FOUND without a path. */
KINSHIP_API kinship_code kinship_plan_copy(const kinship_plan* plan, double* waypoints);

/** Reports the plan with its scene, as kinship_report() does. Each call measures the whole path in
 * its surroundings, which takes some milliseconds.
 * \param task  its name. \param machine  NULL: "".
 * \return KINSHIP_INVALID_INPUT also if nothing was planned: the query does not fit the robot, or
 * was stopped. */
KINSHIP_API kinship_code kinship_plan_report(kinship_client* client, const kinship_plan* plan,
                                             const char* task, const char* machine);

/* NOLINTEND(readability-identifier-naming,readability-function-size) */
#ifdef __cplusplus
}
#endif

#endif
