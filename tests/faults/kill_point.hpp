#pragma once

#include <functional>

namespace kinship::test {

/// Runs `work` in a child process that kills itself with SIGKILL before its change number `change`
/// to the file system, counted from 0: each write, sync, truncation, rename, link and removal, by
/// our code or by SQLite. The program that calls this must be linked with kill_point.cpp, which
/// stands in front of the C library's functions.
/// \return true if it was killed; false if it made fewer changes and ended by itself.
/// \throws std::runtime_error if it failed.
bool killed_before_change(int change, const std::function<void()>& work);

}  // namespace kinship::test
