#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace kinship::dds {

/// Receives a line of Cyclone DDS's log, without its line feed. Called from threads of Cyclone
/// DDS, one at a time; must not call back into DDS.
using LogSink = std::function<void(std::string_view line)>;

/// Sets the sink of the log of Cyclone DDS; the default is stderr. At most 20 lines in 10 s are
/// passed on, then one with the number left out: a peer that sends garbage makes Cyclone DDS write
/// a line per packet. For the whole process.
void set_log_sink(LogSink sink);

/// Limits the rate of Cyclone DDS's log; called by the first participant.
void limit_log();

/// The newest line, to explain a failure; may be empty.
std::string last_log_line();

}  // namespace kinship::dds
