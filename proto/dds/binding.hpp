#pragma once

namespace kinship::dds {

/// Whether Cyclone DDS, where it calls its own function `name`, calls `function` of ours instead.
///
/// A function of ours stands in front of one of Cyclone DDS's if the dynamic linker finds it first.
/// It does not if a program has loaded Cyclone DDS before us, or another copy of this library: what
/// is loaded keeps to what it found then.
bool is_in_front_of_cyclone(const char* name, const void* function);

}  // namespace kinship::dds
