#pragma once

#include <string>

namespace kinship {

/// A report of an outbox that has no receipt, or not the one it wants.
struct OutboxEntry {
  std::string file;   ///< in the outbox
  std::string state;  ///< "pending", "rejected" or "set aside"
  std::string why;    ///< of a pending one: why it cannot be read; empty: it can
};

}  // namespace kinship
