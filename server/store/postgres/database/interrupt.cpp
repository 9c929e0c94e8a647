#include "server/store/postgres/database/interrupt.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "proto/types/failure.hpp"

namespace kinship::store::postgres {

Interrupt::Interrupt() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0)
    throw Failure(ErrorCode::Internal, "no descriptor is left for an eventfd");
}

Interrupt::~Interrupt() { close(descriptor_); }

bool Interrupt::is_raised() const noexcept {
  pollfd waited{.fd = descriptor_, .events = POLLIN, .revents = 0};
  return poll(&waited, 1, 0) > 0;
}

void Interrupt::raise() noexcept { static_cast<void>(eventfd_write(descriptor_, 1)); }

}  // namespace kinship::store::postgres
