/* 05 in C: Follow and replan when it improves. A follower always holds the newest distribution and
 * never blocks who plans.
 *
 *   05_follow_and_replan_c MODELS ROUNDS        ends after so many plans */
#include <kinship.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, kinship_error_text());
  return 1;
}

int main(int count, char** words) {
  static const double at_the_station[7] = {0, 0, 0, 0, 0, 0, 1};
  /* Who reports nothing leaves sending to the others. */
  kinship_client_options options = {.size = sizeof options, .without_outbox = 1};
  const char* domain = getenv("KINSHIP_DOMAIN");
  kinship_client* client = NULL;
  kinship_follower* follower = NULL;
  kinship_distribution* held = NULL; /* at first: plan uniformly until there is one */
  kinship_robot robot;
  kinship_robot_file arm = {.size = sizeof arm};
  kinship_request request = {.size = sizeof request, .robot = &robot, .task = "sweep"};
  char folder[4096];
  if (count != 3 || strlen(words[1]) + sizeof "/ur10e" > sizeof folder)
    return fprintf(stderr, "usage: 05_follow_and_replan_c MODELS ROUNDS\n"), 2;
  snprintf(folder, sizeof folder, "%s/ur10e", words[1]);
  arm.source = folder;
  request.T_task_base = at_the_station;
  options.domain = domain == NULL ? 0 : (uint32_t)atoi(domain);
  options.server = getenv("KINSHIP_SERVER"); /* NULL: here */
  if (kinship_client_open(&options, &client) != KINSHIP_OK ||
      kinship_register_file(client, &arm, &robot, NULL) != KINSHIP_OK ||
      kinship_follower_open(client, &request, &follower) != KINSHIP_OK)
    return failed("follow");
  for (int round = 0; round < atoi(words[2]); ++round) {
    kinship_distribution* newer = NULL; /* with a timeout of 0 it does not wait */
    kinship_distribution_info info = {.size = sizeof info};
    if (kinship_follower_newer(follower, held, 120000, &newer) != KINSHIP_OK)
      return failed("nothing newer");
    kinship_distribution_free(held); /* it was valid until now, whatever came meanwhile */
    held = newer;
    kinship_distribution_describe(held, &info);
    printf("revision %llu of %llu paths: plan anew with samples of %zu joints\n",
           (unsigned long long)info.revision, (unsigned long long)info.paths, info.dof);
    fflush(stdout);
  }
  kinship_distribution_free(held);
  kinship_follower_close(follower);
  kinship_client_close(client);
  return 0;
}
