/* kinship.h as a compiler of C99 reads it. */
#include "client/c/kinship.h"

int version_is_told_in_c(void) { return kinship_version()[0] != '\0'; }
