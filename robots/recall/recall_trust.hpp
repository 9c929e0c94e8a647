#pragma once

#include <algorithm>

namespace kinship::recall {

/// How far the chances hold that a library of paths to recall tells: by what the tries of this
/// client were to solve, and solved.
class RecallTrust {
 public:
  /// Factor of each chance, 0 to 1.
  double value() const { return std::min(1.0, (recalled_ + 1) / (expected_ + 1)); }

  /// \param expected  chance that one of a query's tries works, 0 to 1.
  void add(double expected, bool is_recalled) {
    expected_ += expected;
    recalled_ += is_recalled ? 1 : 0;
  }

 private:
  double expected_ = 0, recalled_ = 0;
};

}  // namespace kinship::recall
