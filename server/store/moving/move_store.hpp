#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "server/store/moving/verification.hpp"

/// Moves a whole store from one engine to the other, row by row.
namespace kinship::store {

enum class MoveStep { Copying, Verifying };

struct MoveProgress {
  MoveStep step = MoveStep::Copying;
  std::uint64_t rows = 0;   ///< attempts and paths, about
  std::uint64_t total = 0;  ///< of this step
};

struct MoveOptions {
  std::string from, to;  ///< as --store names stores
  std::function<void(const MoveProgress&)> progress = [](const MoveProgress&) {};
};

struct MoveResult {
  std::string from, to;  ///< without passwords
  /// Rows written by this call, by table.
  std::map<std::string, std::uint64_t> written;
  /// Who serves the source: then what it has now was copied, and the move is not done. Empty: all
  /// was compared, and if it is equal the target may be served, the source not any more.
  std::string served_by;
  double copy_s = 0;       ///< all copies of this call
  double last_copy_s = 0;  ///< how long what came during the copy before took
  double verify_s = 0;
  bool was_done = false;              ///< before this call, which did nothing
  moving::Verification verification;  ///< beside a server: of what did not change meanwhile
};

/// Brings a store to another place. It may be called again at any time, after whatever ended it:
/// then it goes on. While a server has the source open it copies what is there and says so. Once
/// none has, it copies the rest, compares each row, opens the target for servers and closes the
/// source to them.
///
/// \throws Failure(InvalidInput) for what is no move between engines or databases;
///         Failure(NotFound) if there is no source; Failure(Conflict) if the target holds anything
///         of another origin; Failure(Unavailable) if a server has the target open, or somebody
///         wrote to the source meanwhile; Failure(Storage). All of it can be gone on with.
MoveResult move_store(const MoveOptions& options);

/// Ends a move that is not to be gone on with: removes what it wrote to a target (`to`), or lets
/// servers open a source again (`from`). \return what was done, in words, a line each.
/// \throws Failure(InvalidInput) for what no move concerns.
std::string give_up_move(const std::string& from, const std::string& to);

}  // namespace kinship::store
