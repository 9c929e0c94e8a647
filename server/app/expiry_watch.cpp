#include "server/app/expiry_watch.hpp"

namespace kinship::app {

ExpiryWatch::TimePoint ExpiryWatch::beat(TimePoint now) {
  if (!credentials_)
    return TimePoint::max();
  if (!next_ || now >= *next_) {
    if (const auto warning = security::expiry_warning(*credentials_, wall_time_()))
      warn_(*warning);
    next_ = now + kInterval;
  }
  return *next_;
}

}  // namespace kinship::app
