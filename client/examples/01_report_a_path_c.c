/* 01 in C: Report a path. What 01_report_a_path.cpp does, through the C library; every call says
 * how it went.
 *
 *   01_report_a_path_c URDF        of the Panda: share/kinship/robots/panda/robot.urdf of the
 * installation */
#include <kinship.h>
#include <stdio.h>
#include <stdlib.h>

#include "read_text.h"

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, kinship_error_text());
  return 1;
}

int main(int count, char** words) {
  static const double transfer[7] = {0, 0, 0.06, 0, 0, -0.3826834323650898, 0.9238795325112867};
  static const double at_the_station[7] = {0, 0, 0, 0, 0, 0, 1};
  static const double waypoints[3][7] = {{-0.9, -0.8, 0, -2.2, 0, 1.6, 0.8},
                                         {0.1, -0.7, 0, -2.4, 0, 1.6, 0.7},
                                         {0.9, -0.8, 0, -2.2, 0, 1.6, 0.8}};
  kinship_client* client = NULL;
  kinship_robot robot;
  kinship_robot_description arm = {.size = sizeof arm};
  kinship_attempt attempt = {.size = sizeof attempt};
  kinship_outbox outbox = {.size = sizeof outbox};
  char* urdf = count == 2 ? read_text(words[1]) : NULL;
  if (urdf == NULL) {
    fprintf(stderr, "usage: 01_report_a_path_c URDF\n");
    return 2;
  }
  arm.label = "panda";
  arm.urdf = urdf;
  arm.base_link = "panda_link0";
  arm.tip_link = "panda_link8";
  arm.T_tip_transfer = transfer;
  attempt.robot = &robot;
  attempt.task = "sweep";
  attempt.T_task_base = at_the_station;
  attempt.solved = 1;
  attempt.waypoints = &waypoints[0][0];
  attempt.waypoint_count = 3;
  attempt.planner = "mine";
  attempt.planning_time_s = 0.5;
  attempt.collision_checks = 1000;

  if (kinship_client_open(NULL, &client) != KINSHIP_OK) /* KINSHIP_DOMAIN and KINSHIP_SERVER */
    return failed("open");
  if (kinship_register(client, &arm, &robot, &attempt.dof) != KINSHIP_OK)
    return failed("register"); /* with KINSHIP_UNAVAILABLE one could go on: reports wait on disk */
  if (kinship_report(client, &attempt) != KINSHIP_OK)
    return failed("report");
  if (kinship_flush(client, 30000, &outbox) != KINSHIP_OK)
    return failed("flush");
  printf("accepted %zu, refused %zu\n", outbox.accepted, outbox.refused);
  kinship_client_close(client);
  free(urdf);
  return outbox.accepted == 1 ? 0 : 1;
}
