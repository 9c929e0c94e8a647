#pragma once

namespace kinship::dds {

/// Whether Cyclone DDS calls our `function` where it calls its own function `name`.
///
/// Our function interposes one of Cyclone DDS if the dynamic linker finds it first. It does not if
/// a program has loaded Cyclone DDS before this library, or another copy of this library: loaded
/// libraries keep their bindings.
bool is_in_front_of_cyclone(const char* name, const void* function);

}  // namespace kinship::dds
