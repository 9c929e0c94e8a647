#pragma once

namespace kinship::dds {

/// Keeps the waits of Cyclone DDS to the steady clock. Those of 0.10.2 end at a time of the wall
/// clock: set back by an hour it can leave a thread of it waiting for that hour, and set ahead it
/// ends handshakes that have just begun. Clients with security that join meanwhile stay outside.
///
/// In front of Cyclone DDS: to itself its `dds_time()` is the wall clock as this process first read
/// it, going on steadily, and its conditions wait by that; to its plugins, which compare with the
/// dates in certificates, and to programs it is the wall clock.
///
/// - The source timestamp of a sample is therefore as far from the wall clock as that was set since
///   the process began. Within a writer it never goes back. Nobody here orders by it (the order is
///   that of reception) or reads it, and lifespans are counted by the steady clock of the reader.
/// - The end of a certificate's life is as far away as it was when the certificate was seen. In a
///   program that loads this library for itself alone (Python), whose plugins find Cyclone DDS
///   first, that end is off by how much the clock was set before.
///
/// \return whether Cyclone DDS calls these functions: not if a program loaded it before this
///         library, which then has its waits.
bool are_waits_steady();

}  // namespace kinship::dds
