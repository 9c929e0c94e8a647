#pragma once

#include "stub/planning.hpp"
