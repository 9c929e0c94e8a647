/* kinship.h as a compiler of C99 reads it. */
#include "client/c/kinship.h"

int version_is_told_in_c(void) { return kinship_version()[0] != '\0'; }

int a_proof_is_asked_for_in_c(kinship_world* world, const double* q, size_t dof) {
  kinship_proof proof = {.size = sizeof proof};
  if (kinship_world_edge_free(world, q, q, dof, KINSHIP_CLEARANCE_M, &proof) != KINSHIP_OK)
    return -1;
  return proof.is_free && proof.first == NULL;
}

static int is_free(void* user, const double* q, size_t dof) {
  int answer = 0;
  return kinship_world_is_free(user, q, dof, &answer) == KINSHIP_OK ? answer : -1;
}

static int is_line_free(void* user, const double* from, const double* to, size_t dof) {
  kinship_proof proof = {.size = sizeof proof};
  const kinship_code code =
      kinship_world_edge_free(user, from, to, dof, KINSHIP_CLEARANCE_M, &proof);
  return code == KINSHIP_OK ? proof.is_free : -1;
}

/* The number of its waypoints; 0: nothing is recalled. */
int a_path_is_recalled_in_c(kinship_recall* recall, kinship_world* world,
                            const kinship_recall_query* query, double* waypoints) {
  kinship_recall_query proven = *query;
  kinship_recalled recalled = {.size = sizeof recalled};
  proven.is_free = is_free;
  proven.is_line_free = is_line_free;
  proven.user = world;
  if (kinship_recall_path(recall, &proven, waypoints, KINSHIP_RECALL_WAYPOINTS, &recalled) !=
      KINSHIP_OK)
    return -1;
  return recalled.is_recalled ? (int)recalled.waypoint_count : 0;
}
