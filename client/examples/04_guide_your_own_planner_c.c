/* 04 in C: Guide a planner of one's own that draws from a pool of floats. Rows are as wide as the
 * planner's registers; a structure of arrays has its arrays as long as they are wide. Most of the
 * pool comes from the experience, the rest is left to the planner's own uniform samples.
 *
 *   04_guide_your_own_planner_c MODELS        the robots that are installed with Kinship */
#include <kinship.h>
#include <stdio.h>
#include <string.h>

enum { kPool = 1000, kLanes = 8, kDof = 6, kPadded = (kPool + kLanes - 1) / kLanes * kLanes };

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, kinship_error_text());
  return 1;
}

/* Stands for a kernel of one's own: samples whose elbow is up, for a whole pool at once. */
static int elbows_up(float arrays[kDof][kPadded], size_t count) {
  int up = 0;
  for (size_t i = 0; i < count; ++i)
    up += arrays[1][i] < 0 && arrays[2][i] > 0;
  return up;
}

int main(int count, char** words) {
  static const double at_the_station[7] = {0, 0, 0, 0, 0, 0, 1};
  static float rows[kPool][kLanes], arrays[kDof][kPadded];
  kinship_client* client = NULL;
  kinship_distribution* distribution = NULL;
  kinship_sampler* sampler = NULL;
  kinship_robot robot;
  kinship_robot_file arm = {.size = sizeof arm};
  kinship_request request = {.size = sizeof request, .robot = &robot, .task = "sweep"};
  kinship_distribution_info info = {.size = sizeof info};
  char folder[4096];
  if (count != 2 || strlen(words[1]) + sizeof "/ur10e" > sizeof folder)
    return fprintf(stderr, "usage: 04_guide_your_own_planner_c MODELS\n"), 2;
  snprintf(folder, sizeof folder, "%s/ur10e", words[1]);
  arm.source = folder;
  request.T_task_base = at_the_station;
  request.deadline_ms = 60000;
  if (kinship_client_open(NULL, &client) != KINSHIP_OK ||
      kinship_register_file(client, &arm, &robot, NULL) != KINSHIP_OK ||
      kinship_fetch(client, &request, &distribution) != KINSHIP_OK ||
      kinship_distribution_describe(distribution, &info) != KINSHIP_OK ||
      kinship_sampler_create(distribution, &sampler) != KINSHIP_OK)
    return failed("no distribution"); /* whatever the reason: plan uniformly */
  const size_t guided = (size_t)(info.recommended_share * kPool);
  if (kinship_sampler_fill_float(sampler, rows[0], guided, kLanes, KINSHIP_ROWS, 1) ||
      kinship_sampler_fill_float(sampler, arrays[0], guided, kPadded, KINSHIP_ARRAYS, 1))
    return failed("fill");
  printf("%zu of %d samples guided, %d with the elbow up; arrays hold the rows: %s\n", guided,
         kPool, elbows_up(arrays, guided), rows[7][2] == arrays[2][7] ? "yes" : "no");
  kinship_sampler_free(sampler);
  kinship_distribution_free(distribution);
  kinship_client_close(client);
  return 0;
}
