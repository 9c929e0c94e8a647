#pragma once

namespace kinship::test {

/// Moves this thread, and the threads and processes it starts, into a network namespace of its own
/// that holds a loopback interface and nothing else: no other software has a port there, and no
/// other test.
///
/// A process started by one that has entered stays with it.
///
/// An ordinary user gets a user namespace with it, as the same user and without capabilities; that
/// is possible only while the process has one thread.
/// \return whether it is in one now; if that was not permitted, nothing has changed.
bool enter_own_network();

}  // namespace kinship::test
