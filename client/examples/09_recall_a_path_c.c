/* 09 in C: Recall a path. A whole path of the fleet's experience is tried on the query by a checker
 * of one's own: an answer without a planner. Run 08 before: experience with scenes.
 *
 *   09_recall_a_path_c MODELS        the robots that are installed with Kinship */
#include <kinship.h>
#include <stdio.h>
#include <string.h>

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, kinship_error_text());
  return 1;
}

/* Stand for a checker of one's own; `user` is what the query says. */
static int is_free(void* user, const double* q, size_t dof) {
  int answer = 0;
  return kinship_world_is_free(user, q, dof, &answer) == KINSHIP_OK ? answer : -1;
}
static int is_line_free(void* user, const double* from, const double* to, size_t dof) {
  kinship_proof proof = {.size = sizeof proof};
  const double clearance = KINSHIP_CLEARANCE_M;
  return kinship_world_edge_free(user, from, to, dof, clearance, &proof) ? -1 : proof.is_free;
}

int main(int count, char** words) {
  static const double start[6] = {-0.9, -1.4, 1.9, -2.07, -1.57, 0};
  static const double goal[6] = {0.8, -1.3, 1.8, -2.07, -1.57, 0};
  static const kinship_object post = {.size = sizeof post,
                                      .name = "post",
                                      .shape = KINSHIP_CYLINDER,
                                      .sizes = {0.05, 1.0, 0},
                                      .pose = {0.75, 0, 0.5, 0, 0, 0, 1}};
  static double path[KINSHIP_RECALL_WAYPOINTS][6];
  kinship_client* client = NULL;
  kinship_recall* recall = NULL;
  kinship_world* world = NULL;
  kinship_robot robot;
  char folder[4096];
  kinship_robot_file arm = {.size = sizeof arm, .source = folder};
  static const double at_the_station[7] = {0, 0, 0, 0, 0, 0, 1};
  kinship_surroundings around = {.size = sizeof around, .objects = &post, .object_count = 1};
  kinship_request request = {.size = sizeof request, .robot = &robot, .task = "sweep"};
  kinship_recall_query query = {sizeof query, NULL, 6,       start,        goal, 1, NULL,
                                &post,        1,    is_free, is_line_free, NULL, 0};
  kinship_recalled recalled = {.size = sizeof recalled};
  if (count != 2 || strlen(words[1]) + sizeof "/ur10e" > sizeof folder)
    return fprintf(stderr, "usage: 09_recall_a_path_c MODELS\n"), 2;
  request.T_task_base = query.T_task_base = around.T_task_base = at_the_station;
  snprintf(folder, sizeof folder, "%s/ur10e", words[1]);
  if (kinship_client_open(NULL, &client) || kinship_world_create(&arm, &around, &world, NULL) ||
      kinship_register_file(client, &arm, &robot, NULL))
    return failed("no robot");
  query.user = world;
  request.deadline_ms = 60000;
  request.start = start;
  request.start_dof = 6;
  if (kinship_fetch_recall(client, &request, &recall) ||
      kinship_recall_path(recall, &query, path[0], KINSHIP_RECALL_WAYPOINTS, &recalled))
    return failed("no paths to recall"); /* whatever the reason: search */
  printf("%s: %zu waypoints after %zu tries\n", recalled.is_recalled ? "recalled" : "nothing",
         recalled.waypoint_count, (size_t)recalled.tries);
  kinship_recall_free(recall);
  kinship_world_free(world);
  kinship_client_close(client);
  return 0;
}
