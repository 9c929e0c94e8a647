#pragma once

namespace kinship::evidence {

/// How fast this machine computes, as a factor to the reference machine: processor times of two
/// machines, each times its speed, can be compared.
///
/// Measured by the first call of a process, in less than 1 ms of the caller's processor time, from
/// turns in space as forward kinematics chains them; the fastest of several tries counts, since
/// what disturbs one only makes it slower.
double machine_speed();

}  // namespace kinship::evidence
