#pragma once

#include <unistd.h>

#include <string>

namespace kinship::dds {

/// The process that made something with threads of Cyclone DDS or of Kinship. A process forked from
/// it has what was made and none of the threads: nothing there answers, and an end waits for ever.
class OwningProcess {
 public:
  /// Whether this is a process forked from the owner.
  bool is_forked() const { return getpid() != id_; }

 private:
  pid_t id_ = getpid();
};

/// What to do in a forked process, in words.
std::string forked_process_advice();

}  // namespace kinship::dds
