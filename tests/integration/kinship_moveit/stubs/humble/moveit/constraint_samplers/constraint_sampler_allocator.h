#pragma once

#define KINSHIP_STUB_HUMBLE 1
#include "stub/planning.hpp"
