/* 02 in C: Fetch and sample, into rows of eight floats as planners with wide registers want them.
 *
 *   02_fetch_and_sample_c URDF        of the UR10e: share/kinship/robots/ur10e/robot.urdf of the
 * installation */
#include <kinship.h>
#include <stdio.h>

#include "read_text.h"

enum { kCount = 1000, kStride = 8 };

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, kinship_error_text());
  return 1;
}

int main(int count, char** words) {
  static const double transfer[7] = {0, 0, 0.06, 0, 0, 0, 1};
  static const double at_the_station[7] = {0, 0, 0, 0, 0, 0, 1};
  static float rows[kCount][kStride];
  kinship_client* client = NULL;
  kinship_distribution* distribution = NULL;
  kinship_sampler* sampler = NULL;
  kinship_robot robot;
  kinship_robot_description arm = {.size = sizeof arm};
  kinship_request request = {.size = sizeof request};
  kinship_distribution_info info = {.size = sizeof info};
  char* urdf = count == 2 ? read_text(words[1]) : NULL;
  if (urdf == NULL) {
    fprintf(stderr, "usage: 02_fetch_and_sample_c URDF\n");
    return 2;
  }
  arm.label = "ur10e";
  arm.urdf = urdf;
  arm.base_link = "base_link";
  arm.tip_link = "tool0";
  arm.T_tip_transfer = transfer;
  request.robot = &robot;
  request.task = "sweep";
  request.T_task_base = at_the_station;
  request.deadline_ms = 60000;

  if (kinship_client_open(NULL, &client) != KINSHIP_OK ||
      kinship_register(client, &arm, &robot, NULL) != KINSHIP_OK)
    return failed("register");
  if (kinship_fetch(client, &request, &distribution) != KINSHIP_OK)
    return failed("no distribution"); /* whatever the reason: plan uniformly */
  kinship_distribution_describe(distribution, &info);
  if (kinship_sampler_create(distribution, &sampler) != KINSHIP_OK ||
      kinship_sampler_fill_float(sampler, &rows[0][0], kCount, kStride, KINSHIP_ROWS, 1) !=
          KINSHIP_OK)
    return failed("sample");
  printf("%zu components of %zu joints; the first sample: %.3f %.3f ... padded with %.0f\n",
         info.components, info.dof, rows[0][0], rows[0][1], rows[0][7]);
  kinship_sampler_free(sampler);
  kinship_distribution_free(distribution);
  kinship_client_close(client);
  free(urdf);
  return 0;
}
