/** \file kinship.h
 * Kinship for C and for whatever calls C: register a robot, report paths, fetch or follow the
 * distribution that the fleet's experience gives it, draw configurations from it; recall whole
 * paths; without a server prove that edges touch nothing. kinship_planning.h plans.
 *
 * - Functions that can fail return a kinship_code; kinship_error_text() then says in words what
 * went wrong in the last call of this thread, with the thing, its value and the limit. What they
 * would have made is NULL then.
 * - Handles are made by ..._open, ..._create or a fetch and freed once, by ..._close or ..._free,
 * which take NULL. Text and numbers that are passed in are copied.
 * - Any thread may use any handle, several at once; a handle is closed after its last use.
 * - Structures begin with their size in bytes: `kinship_request request = {.size = sizeof
 * request};`. All else that is 0 is as if it were not said, so what a later version adds at the end
 * does not disturb who was compiled before.
 * - Lengths in m, angles in rad. A pose is x y z qx qy qz qw. Functions that may wait say so.
 */
#ifndef KINSHIP_H
#define KINSHIP_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define KINSHIP_API __attribute__((visibility("default")))
#else
#define KINSHIP_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Names as C has them. NOLINTBEGIN(readability-identifier-naming,readability-function-size) */

typedef enum kinship_code {
  KINSHIP_OK = 0,
  KINSHIP_INVALID_INPUT = 1, /**< a value breaks a rule */
  KINSHIP_NOT_FOUND = 2,     /**< no robot or task of this name */
  KINSHIP_CONFLICT = 3,      /**< a label is another robot's */
  KINSHIP_TOO_LARGE = 4,     /**< a size limit is exceeded */
  KINSHIP_UNAVAILABLE = 5, /**< no server answered in time: plan uniformly, reports wait on disk */
  KINSHIP_STORAGE = 6,     /**< a file could not be written */
  KINSHIP_INTERNAL = 7,    /**< a bug of ours, or an answer that nobody expects */
  KINSHIP_PENDING = 8,     /**< the distribution is still being made: ask again later */
  KINSHIP_NO_EXPERIENCE = 9,      /**< nobody has done the task yet */
  KINSHIP_UNKNOWN_ROBOT = 10,     /**< register it first */
  KINSHIP_REFUSED = 11,           /**< a rule is against it; the same again is refused again */
  KINSHIP_CODE_WIDTH = 0x7fffffff /**< no code: enumerations are as wide as int everywhere */
} kinship_code;

/** Version of the library that runs, e.g. "0.2.0"; never freed. */
KINSHIP_API const char* kinship_version(void);

/** Why the last call of this thread that returned another code than KINSHIP_OK did; "" before there
 * was one. Valid until the next call of this thread that fails. */
KINSHIP_API const char* kinship_error_text(void);

/** A robot: the digest of its kinematics and transfer frame, the same on every machine. */
typedef struct kinship_robot {
  uint8_t digest[32];
} kinship_robot;

/* ----------------------------------------------------------------------------------------------
 * client */

typedef struct kinship_client kinship_client;

#define KINSHIP_ENVIRONMENT 0xffffffffu /**< the domain that KINSHIP_DOMAIN says, or 0 */

typedef struct kinship_client_options {
  size_t size;
  uint32_t domain;      /**< DDS domain, 0 to 230, or KINSHIP_ENVIRONMENT */
  const char* server;   /**< host of kinshipd; NULL: as KINSHIP_SERVER says, or 127.0.0.1 */
  const char* outbox;   /**< folder of reports that wait; NULL: below XDG_STATE_HOME or HOME */
  int without_outbox;   /**< not 0: delivers nothing, kinship_report() is refused */
  uint32_t timeout_ms;  /**< to register, or fetch without deadline; 0: KINSHIP_TIMEOUT, or 5000 */
  const char* security; /**< folder of credentials; NULL: as KINSHIP_SECURITY says, or none */
  const char* resend; /**< old reports to a store never seen: "all", "none"; NULL: unacknowledged */
} kinship_client_options;

/** Needs no server. \param options  NULL: all as the environment says. */
KINSHIP_API kinship_code kinship_client_open(const kinship_client_options* options,
                                             kinship_client** client);
/** Reports that have no receipt yet stay on disk and are sent by the next client of the outbox. */
KINSHIP_API void kinship_client_close(kinship_client* client);

/** What to tell people after kinship_client_open(), and now and then later: that the credentials
 * are valid for less than 30 days, for how long, and how to get new ones; "" before that, without
 * security, and of NULL. Valid until the next such call of this thread. Waits for nobody. */
KINSHIP_API const char* kinship_client_warning(const kinship_client* client);

/** A joint beside the chain that stands still. Has no `size`: later versions leave it as it is. */
typedef struct kinship_held_joint {
  const char* name;
  double value; /**< rad or m */
} kinship_held_joint;

/** A robot by the text of its URDF; kinship_register_file() reads files, meshes too. */
typedef struct kinship_robot_description {
  size_t size;
  const char* label;                  /**< for people; unique at a server */
  const char* urdf;                   /**< text of the URDF */
  const char* base_link;              /**< where the chain begins */
  const char* tip_link;               /**< where it ends */
  const double* T_tip_transfer;       /**< of the frame that robots place alike; NULL: the tip's */
  const char* const* never_colliding; /**< 2 n names of links, pair by pair; NULL: none */
  size_t never_colliding_pairs;       /**< n */
  const char* axes; /**< of that frame that the task prescribes, e.g. "x,y,yaw"; NULL: all six */
  const kinship_held_joint* held_joints; /**< NULL: none */
  size_t held_joint_count;
} kinship_robot_description;

/** Waits up to the client's timeout.
 * \param robot  its identity; set also with KINSHIP_UNAVAILABLE: the description is kept in the
 * outbox, and reports of the robot can be handed over.
 * \param dof    number of joints; may be NULL. */
KINSHIP_API kinship_code kinship_register(kinship_client* client,
                                          const kinship_robot_description* description,
                                          kinship_robot* robot, size_t* dof);

/** A robot in files, with all that `kinship robots register` takes. */
typedef struct kinship_robot_file {
  size_t size;
  const char* source;           /**< a folder with chain.toml, or a URDF file */
  const char* base_link;        /**< NULL: the folder's */
  const char* tip_link;         /**< NULL: the folder's */
  const char* label;            /**< NULL: the folder's, or the file's name without ending */
  const double* T_tip_transfer; /**< NULL: the folder's, or the tip's */
  const char* axes;             /**< as above; NULL: the folder's, or all six */
  const kinship_held_joint* held_joints;
  size_t held_joint_count;
  const char* srdf;            /**< a file whose disabled pairs never collide; NULL: none */
  const char* const* packages; /**< "NAME=FOLDER" each, for meshes named package://NAME/... */
  size_t package_count;
  int collision_from_visual; /**< not 0: what is drawn of links without solids is solid */
  const char* const* without_collision; /**< links that are drawn and need no solid; NULL: none */
  size_t without_collision_count;
  const char* const* xacro; /**< "NAME:=VALUE" each, for a URDF or SRDF that is xacro */
  size_t xacro_count;
  int without_meshes; /**< not 0: the meshes stay here, a server gets solids around them alone */
} kinship_robot_file;

/** Reads the files and registers the robot as kinship_register() does. A server that takes
 * meshes is sent them, and solids around them, which are fitted here; that may take seconds.
 * Meshes that cannot be read are an error. */
KINSHIP_API kinship_code kinship_register_file(kinship_client* client,
                                               const kinship_robot_file* file, kinship_robot* robot,
                                               size_t* dof);

/* ----------------------------------------------------------------------------------------------
 * report */

typedef enum kinship_sampling {
  KINSHIP_UNIFORM = 0,
  KINSHIP_GUIDED = 1,
  KINSHIP_CONTROL = 2,
  KINSHIP_SAMPLING_WIDTH = 0x7fffffff
} kinship_sampling;

typedef enum kinship_shape {
  KINSHIP_BOX = 0,      /**< full extents along x, y and z */
  KINSHIP_CYLINDER = 1, /**< radius, length along z */
  KINSHIP_SPHERE = 2,   /**< radius */
  KINSHIP_CAPSULE = 3,  /**< radius, length of its cylindrical part along z */
  KINSHIP_MESH = 4,     /**< triangles: three points each */
  KINSHIP_VOXELS = 5,   /**< cubes: edge; points: middles, odd multiples of half an edge */
  KINSHIP_SHAPE_WIDTH = 0x7fffffff
} kinship_shape;

/** Something that is or was in the way: `{.size = sizeof(kinship_object), .name = "table", .shape =
 * KINSHIP_BOX, .sizes = {0.8, 1.2, 0.1}, .pose = {0.6, 0, -0.05, 0, 0, 0, 1}}`. */
typedef struct kinship_object {
  size_t size; /**< the same in all of an array */
  const char* name;
  kinship_shape shape;
  int is_held;     /**< not 0: the robot holds it */
  double sizes[3]; /**< as the shape says, the others are not looked at */
  double pose[7];  /**< of its centre, in the task's frame; if it is held in the transfer frame */
  const double* points; /**< x y z each, m, in the object's own frame; else not looked at */
  size_t point_count;
} kinship_object;

/** What a planner says about one query. */
typedef struct kinship_attempt {
  size_t size;
  const kinship_robot* robot;
  const char* task;          /**< name of the task */
  const char* machine;       /**< which of the fleet's; NULL: "" */
  const double* T_task_base; /**< of the base in the task's frame; NULL: not known, as identity */
  int solved;                /**< 0: there is no path, and waypoints are not looked at */
  const double* waypoints;   /**< dof numbers each, one waypoint after the other, joint units */
  size_t waypoint_count;     /**< at least 2 */
  size_t dof;
  const char* planner; /**< its name; NULL: "" */
  double planning_time_s;
  double time_limit_s;       /**< 0: none */
  uint64_t collision_checks; /**< configurations of which any collision question was asked */
  kinship_sampling sampling; /**< CONTROL: uniform on purpose although there was guidance */
  double share;              /**< of samples drawn from the distribution, 0 to 1 */
  /** The scene, so that another robot's distribution keeps out of it; meshes are told as solids
   * around them. NULL: the scene is not told; not NULL, with object_count 0: nothing was there. */
  const kinship_object* objects;
  size_t object_count;
  const char* const* allowed_collisions; /**< 2 n names of objects that may touch, pair by pair */
  size_t allowed_collision_pairs;        /**< n; 0 without objects */
  /** Processor time on this machine of the query with everything that guidance costs, samples too;
   * 0: unknown. The server compares sampling modes by it, of whatever machines. */
  double processor_time_s;
} kinship_attempt;

/** Puts the attempt into the outbox: durable on return, sent in the background. Never waits for the
 * network. \return KINSHIP_NOT_FOUND for a robot that was never registered with the outbox,
 * KINSHIP_INVALID_INPUT if its joints are not those of the path. */
KINSHIP_API kinship_code kinship_report(kinship_client* client, const kinship_attempt* attempt);

/** The same of a line of an experience file, as `kinship paths export` writes them: what
 * kinship_attempt has no member for can be said there: the region that the hand had to stay in, and
 * what explains a failure ("search", see proto/FORMATS.md). The robot is its digest in hex.
 *
 *   {"report_uuid": "7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55", "task": "carry", "robot": "30a1...",
 *    "machine": "cell 3", "T_task_base": [0, 0, 0, 0, 0, 0, 1],
 *    "waypoints": [[0, 0.5], [1, 0.5]], "record": {"outcome": "solved", "planner": "mine",
 *    "planner_options": "", "planning_time_s": 0.5, "collision_checks": 1000, "projections": 0,
 *    "time_limit_s": 10, "sampling_mode": "uniform", "share": 0, "distribution_id": null,
 *    "distribution_revision": 0}, "scene": {"boxes": [{"name": "table",
 *    "pose": [0.6, 0, -0.05, 0, 0, 0, 1], "size": [0.8, 1.2, 0.1]}]}} */
KINSHIP_API kinship_code kinship_report_line(kinship_client* client, const char* line);

typedef struct kinship_outbox {
  size_t size;
  size_t pending;           /**< wait for their receipt */
  size_t accepted;          /**< since the client was opened */
  size_t refused;           /**< since then; kept on disk with the reason */
  const char* last_refusal; /**< why; "": none was. Valid until this thread's next flush */
  size_t kept; /**< that stores acknowledged which the server had before: `kinship outbox` */
} kinship_outbox;

/** Waits until nothing is pending or the time has passed. \param outbox  what is then; may be NULL.
 * \return KINSHIP_UNAVAILABLE if reports still wait. */
KINSHIP_API kinship_code kinship_flush(kinship_client* client, uint32_t timeout_ms,
                                       kinship_outbox* outbox);

/* ----------------------------------------------------------------------------------------------
 * fetch and follow */

/** A mixture of Gaussians over the configurations of one robot, with its provenance. Never changes.
 */
typedef struct kinship_distribution kinship_distribution;

typedef struct kinship_request {
  size_t size;
  const kinship_robot* robot;
  const char* task;
  /** Where this robot stands; NULL: as it last reported the task (two requests of role reader, each
   * within the client's timeout; a follower asks the first server it finds); if never, identity. */
  const double* T_task_base;
  const char* profile;  /**< NULL: "default" */
  uint32_t deadline_ms; /**< 0: what is there, within the client's timeout */
  /** Where queries of the robot usually begin, joint units: what other robots recorded is planned
   * from there for kinship_recall; NULL: the server looks for a start. */
  const double* start;
  size_t start_dof; /**< of start */
  int with_recall;  /**< not 0: the follower holds what kinship_follower_recall() gives, too */
  /** Where the transfer frame is to go in the next query, in the task frame: for kinship_recall
   * the server plans for that goal in recorded scenes if no report reached it, or in the place of
   * recorded goals that the robot cannot plan to. NULL: not told. */
  const double* T_task_goal;
  int to_configuration; /**< not 0: queries ask for one configuration, not for any at a pose */
} kinship_request;

/** Waits until the distribution is made, up to the deadline.
 * \return KINSHIP_PENDING, _NO_EXPERIENCE, _UNKNOWN_ROBOT, _REFUSED or _UNAVAILABLE if there is
 * none: plan uniformly. */
KINSHIP_API kinship_code kinship_fetch(kinship_client* client, const kinship_request* request,
                                       kinship_distribution** distribution);
KINSHIP_API void kinship_distribution_free(kinship_distribution* distribution);

typedef struct kinship_distribution_info {
  size_t size;
  size_t dof;
  size_t components;
  uint64_t revision;        /**< grows with the experience */
  uint64_t paths;           /**< of all sources */
  double recommended_share; /**< of samples to draw from it, 0 to 1; the others uniform */
} kinship_distribution_info;

KINSHIP_API kinship_code kinship_distribution_describe(const kinship_distribution* distribution,
                                                       kinship_distribution_info* info);
/** Copies the mixture. Each pointer may be NULL.
 * \param weights      components numbers.
 * \param means        components x dof, one component after the other.
 * \param covariances  components x dof x dof. */
KINSHIP_API kinship_code kinship_distribution_copy(const kinship_distribution* distribution,
                                                   double* weights, double* means,
                                                   double* covariances);

/** Holds the newest distribution of a request. */
typedef struct kinship_follower kinship_follower;

/** Does not wait. The request's deadline is not used. The follower may outlive the client. */
KINSHIP_API kinship_code kinship_follower_open(kinship_client* client,
                                               const kinship_request* request,
                                               kinship_follower** follower);
KINSHIP_API void kinship_follower_close(kinship_follower* follower);
/** The newest distribution, a handle of its own. With a timeout of 0 the call never blocks,
 * otherwise it waits for another distribution than `held`.
 * \param held  the distribution that the caller has; NULL: any will do.
 * \return KINSHIP_OK with one that differs from `held`, KINSHIP_PENDING without: `held` is the
 * newest still, or the codes of kinship_fetch() while there is none. */
KINSHIP_API kinship_code kinship_follower_newer(kinship_follower* follower,
                                                const kinship_distribution* held,
                                                uint32_t timeout_ms,
                                                kinship_distribution** distribution);

/* ----------------------------------------------------------------------------------------------
 * sampler */

/** Draws configurations within the limits of the joints. Never changes: threads share one and take
 * seeds of their own. */
typedef struct kinship_sampler kinship_sampler;

KINSHIP_API kinship_code kinship_sampler_create(const kinship_distribution* distribution,
                                                kinship_sampler** sampler);
KINSHIP_API void kinship_sampler_free(kinship_sampler* sampler);

typedef enum kinship_layout {
  /** Joint j of configuration i at out[i * stride + j]; stride >= dof, and what is beyond dof is
     set to 0. */
  KINSHIP_ROWS = 0,
  /** Joint j of configuration i at out[j * stride + i], a structure of arrays; stride >= count,
     beyond count untouched. */
  KINSHIP_ARRAYS = 1,
  KINSHIP_LAYOUT_WIDTH = 0x7fffffff
} kinship_layout;

/** Equal seeds and counts give equal numbers. `out` needs no alignment.
 * \return KINSHIP_INTERNAL, and nothing is written, if the mixture lies outside the limits. */
KINSHIP_API kinship_code kinship_sampler_fill(const kinship_sampler* sampler, double* out,
                                              size_t count, size_t stride, kinship_layout layout,
                                              uint64_t seed);
/** The same, rounded to single precision, and then not beyond the limits. */
KINSHIP_API kinship_code kinship_sampler_fill_float(const kinship_sampler* sampler, float* out,
                                                    size_t count, size_t stride,
                                                    kinship_layout layout, uint64_t seed);

/* ----------------------------------------------------------------------------------------------
 * worlds */

/** A robot among obstacles, which tells where it touches nothing: needs no server. Threads may
 * share one and are answered one after the other. */
typedef struct kinship_world kinship_world;

/** What a robot stands among and holds. */
typedef struct kinship_surroundings {
  size_t size;
  const double* T_task_base; /**< pose of the base in the task's frame; NULL: used as identity */
  const kinship_object* objects; /**< those that are held hang on the tip link; NULL: none */
  size_t object_count;
  const char* const* allowed_collisions; /**< 2 n names of links or objects, pair by pair */
  size_t allowed_collision_pairs;        /**< n */
} kinship_surroundings;

/** Reads the robot's files as kinship_register_file() does, by the same rules, but keeps meshes as
 * their triangles; that may take seconds.
 * \param surroundings  NULL: nothing, so that the robot can touch only itself.
 * \param dof  number of joints; may be NULL.
 * \return KINSHIP_INVALID_INPUT also if a link that moves is drawn and has no solid, an object is
 * not proper, or an allowed pair names what is not there. */
KINSHIP_API kinship_code kinship_world_create(const kinship_robot_file* file,
                                              const kinship_surroundings* surroundings,
                                              kinship_world** world, size_t* dof);
KINSHIP_API void kinship_world_free(kinship_world* world);

/** What of the files and obstacles can hardly be meant, a sentence a line: names in an SRDF that
 * are no links, links without solids or of sizes that no arm has, obstacles out of reach. "" if
 * nothing, and of NULL. Valid until the world is freed. */
KINSHIP_API const char* kinship_world_warning(const kinship_world* world);

/** Whether one configuration touches nothing. Limits of joints are not checked.
 * \param q        dof finite numbers, joint units. \param dof  the world's.
 * \param is_free  1 or 0. What touches is told by kinship_world_edge_free() from q to q. */
KINSHIP_API kinship_code kinship_world_is_free(kinship_world* world, const double* q, size_t dof,
                                               int* is_free);

/** The clearance of edges that Kinship's planners use, m. */
#define KINSHIP_CLEARANCE_M 0.001

/** What is known of straight lines between configurations. */
typedef struct kinship_proof {
  size_t size;
  int is_free;  /**< 1: no configuration of any edge touches anything; 0: not so, or not proven */
  size_t edge;  /**< the first that is not free, 0 of the first two waypoints; 0 if all are */
  double share; /**< of that edge, 0 to 1: where it is not free */
  const char* first;  /**< name of what touches there, or is too near; NULL if all are free */
  const char* second; /**< what it touches. Both are valid until the world is freed */
  double clearance_m; /**< between the two, at most the one asked for; 0 if all are free */
  /** Least distance between two bodies that was measured, m, to 1 % (of meshes and 0.1 mm), up to
   * that edge; INFINITY where nothing came so near that it had to be. Between the configurations
   * that were looked at bodies may come nearer, but do not touch if the edge is free. */
  double least_clearance_m;
} kinship_proof;

/** Whether the straight line between two configurations is proven to touch nothing: what bodies
 * move along it is bounded against their distances, so nothing is stepped over, however thin.
 * Limits of joints are not checked; continuous joints turn the way their numbers say.
 * \param from, to     dof finite numbers each, joint units. \param dof  the world's.
 * \param clearance_m  KINSHIP_CLEARANCE_M, or another one from 1e-5 to 0.1: what comes nearer to an
 * obstacle, where it is looked at, counts as touching; of the robot's own links at most 1 mm is
 * asked. The smaller, the longer an edge along a surface takes.
 * \param proof        set with KINSHIP_OK, whether the edge is free or not. */
KINSHIP_API kinship_code kinship_world_edge_free(kinship_world* world, const double* from,
                                                 const double* to, size_t dof, double clearance_m,
                                                 kinship_proof* proof);
/** The same of all edges of a path, up to the first that is not free.
 * \param waypoints  dof numbers each, one waypoint after the other. \param count  at least 2. */
KINSHIP_API kinship_code kinship_world_path_free(kinship_world* world, const double* waypoints,
                                                 size_t count, size_t dof, double clearance_m,
                                                 kinship_proof* proof);

/* ----------------------------------------------------------------------------------------------
 * recall */

/** Whole paths of a robot for a task, to be moved onto a query and tried before any search. The
 * handle learns from tries how far to trust its paths, else it never changes. */
typedef struct kinship_recall kinship_recall;

/** Waits until the server has planned the recorded queries again, up to the request's deadline.
 * \param request  its robot was registered by this client: the paths are moved by its kinematics.
 * \return as kinship_fetch(); KINSHIP_PENDING while the server still makes the first paths (for
 * ever with `kinshipd --rehearsal-cpu 0`), KINSHIP_NO_EXPERIENCE if it could make none, e.g. as no
 * scenes were reported, KINSHIP_NOT_FOUND if the client did not register the robot. */
KINSHIP_API kinship_code kinship_fetch_recall(kinship_client* client,
                                              const kinship_request* request,
                                              kinship_recall** recall);
/** The newest paths of a follower whose request said `with_recall`, a handle of its own. Never
 * waits.
 * \param held  the paths that the caller has; NULL: any will do.
 * \return KINSHIP_OK with paths that differ from `held`, KINSHIP_PENDING without: `held` are the
 * newest still, or none have come yet; KINSHIP_NO_EXPERIENCE if the server took back what the
 * follower had, e.g. as paths were retired: free `held`. */
KINSHIP_API kinship_code kinship_follower_recall(kinship_follower* follower,
                                                 const kinship_recall* held,
                                                 kinship_recall** recall);
KINSHIP_API void kinship_recall_free(kinship_recall* recall);

/** Goals that a query has at most. */
#define KINSHIP_RECALL_GOALS 32

/** A query, and the caller's collision checker, which is called by the calling thread alone. */
typedef struct kinship_recall_query {
  size_t size;
  const double* T_task_base; /**< where the robot stands; NULL: used as identity */
  size_t dof;
  const double* start; /**< dof numbers, joint units */
  const double* goals; /**< dof numbers each, one after the other; any of them will do */
  size_t goal_count;   /**< at most KINSHIP_RECALL_GOALS; 0: any configuration at T_task_goal */
  const double* T_task_goal; /**< of the transfer frame, in the task's frame; else not looked at */
  /** The scene: paths are moved with the furniture that is named as in the reports. Only names and
   * poses count; what is held is not looked at. NULL: none is known. */
  const kinship_object* objects;
  size_t object_count;
  /** Whether the robot may be at a configuration of dof numbers, within the limits of its joints:
   * 1 yes, 0 no; below 0 gives up. */
  int (*is_free)(void* user, const double* q, size_t dof);
  /** The same of the straight line between two that are free. NULL: it is if is_free says so of
   * configurations at most `step` apart. */
  int (*is_line_free)(void* user, const double* from, const double* to, size_t dof);
  void* user;  /**< the first argument of both */
  double step; /**< between checked configurations, joint units; 0: 0.05 */
} kinship_recall_query;

/** Waypoints that a recalled path has at most. */
#define KINSHIP_RECALL_WAYPOINTS 32

typedef struct kinship_recalled {
  size_t size;
  int is_recalled;       /**< 1: there is a path; 0: none was free, or none worth a try: search */
  int is_straight_line;  /**< 1: the straight line was free, which takes no experience */
  size_t waypoint_count; /**< 0 without a path */
  uint64_t tries;        /**< paths that were tried; 0 if a callback gave up */
  uint64_t checks;       /**< calls of is_free */
} kinship_recalled;

/** Tries paths on a query, the most promising first, as long as that is cheaper in the mean than a
 * search. A path begins in the start, ends in a goal or at T_task_goal, and is straight between its
 * waypoints; the callbacks said of each of its configurations or lines that they are free. Paths
 * are not projected onto a constraint: only the callbacks can refuse what leaves one.
 * \param waypoints  the path, dof numbers each, start first; untouched without one.
 * \param room       configurations that fit there, at least KINSHIP_RECALL_WAYPOINTS.
 * \param recalled   set with KINSHIP_OK, whether there is a path or not. */
KINSHIP_API kinship_code kinship_recall_path(kinship_recall* recall,
                                             const kinship_recall_query* query, double* waypoints,
                                             size_t room, kinship_recalled* recalled);

/* NOLINTEND(readability-identifier-naming,readability-function-size) */
#ifdef __cplusplus
}
#endif

#endif
