#include "server/store/values/move_marks.hpp"

#include "proto/types/failure.hpp"

namespace kinship::store {

void refuse_moving_store(const std::string& name, const std::string& moving_from,
                         const std::string& moved_to) {
  if (!moving_from.empty())
    throw Failure(ErrorCode::Unavailable,
                  name + " is half a store: it is being filled from '" + moving_from +
                      "'. To go on: 'kinshipd migrate-store --from " + moving_from +
                      " --to THIS'; to give up and remove it: 'kinshipd migrate-store --give-up "
                      "--to THIS'");
  if (!moved_to.empty())
    throw Failure(ErrorCode::Unavailable,
                  name + " was moved to '" + moved_to +
                      "', or is being moved: serve that one. To serve this one again: 'kinshipd "
                      "migrate-store --give-up --from THIS'");
}

}  // namespace kinship::store
