#pragma once

namespace kinship::dds {

/// Keeps the waits of Cyclone DDS to the steady clock. Those of 0.10.2 end at a time of the wall
/// clock: set back by an hour it stops discovery, heartbeats and handshakes for that hour.
///
/// In front of Cyclone DDS: to itself its `dds_time()` is the wall clock as this process first read
/// it, going on steadily, and its conditions wait by that; to its plugins, which compare with the
/// dates in certificates, and to programs it is the wall clock. The end of a certificate's life is
/// as far away as it was when the certificate was seen.
///
/// \return whether Cyclone DDS calls these functions: not if a program loaded it before this
///         library, which then has its waits.
bool are_waits_steady();

}  // namespace kinship::dds
