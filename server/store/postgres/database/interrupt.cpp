#include "server/store/postgres/database/interrupt.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include "proto/types/failure.hpp"

namespace kinship::store::postgres {

Interrupt::Interrupt() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0)
    throw Failure(ErrorCode::Internal, "no descriptor is left for an eventfd");
}

Interrupt::~Interrupt() { close(descriptor_); }

void Interrupt::raise() noexcept { static_cast<void>(eventfd_write(descriptor_, 1)); }

}  // namespace kinship::store::postgres
