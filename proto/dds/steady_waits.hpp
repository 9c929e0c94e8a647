#pragma once

namespace kinship::dds {

/// Keeps the waits of Cyclone DDS to the steady clock. Waits of Cyclone DDS 0.10.2 end at a time of
/// the wall clock: a clock that is set back by an hour can leave a thread waiting for that hour,
/// and a clock that is set ahead ends handshakes that have just begun. Clients with security that
/// join meanwhile stay outside.
///
/// The functions of this library stand in front of those of Cyclone DDS. To Cyclone DDS itself
/// `dds_time()` is the wall clock as this process first read it, going on steadily, and conditions
/// wait by that time. To its plugins, which compare with the dates in certificates, and to programs
/// `dds_time()` is the wall clock.
///
/// - The source timestamp of a sample is therefore as far from the wall clock as the wall clock was
///   set since the process began. Within a writer timestamps never go back. No program here reads
///   them or orders by them (the order is that of reception), and readers count lifespans by their
///   steady clock.
/// - The end of a certificate's life is as far away as it was when the certificate was seen. In a
///   program that loads this library for itself alone (Python) the plugins find Cyclone DDS first:
///   there that end is off by how much the clock was set before.
///
/// \return whether Cyclone DDS calls these functions: not if a program loaded it before this
///         library, which then has its waits.
bool are_waits_steady();

}  // namespace kinship::dds
