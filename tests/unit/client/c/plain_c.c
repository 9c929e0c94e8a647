/* kinship.h as a compiler of C99 reads it. */
#include "client/c/kinship.h"

int version_is_told_in_c(void) { return kinship_version()[0] != '\0'; }

int a_proof_is_asked_for_in_c(kinship_world* world, const double* q, size_t dof) {
  kinship_proof proof = {.size = sizeof proof};
  if (kinship_world_edge_free(world, q, q, dof, KINSHIP_CLEARANCE_M, &proof) != KINSHIP_OK)
    return -1;
  return proof.is_free && proof.first == NULL;
}
