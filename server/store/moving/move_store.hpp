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
  std::string from, to;  ///< names as for --store
  std::function<void(const MoveProgress&)> progress = [](const MoveProgress&) {};
};

struct MoveResult {
  std::string from, to;  ///< without passwords
  /// Rows written by this call, by table.
  std::map<std::string, std::uint64_t> written;
  /// The server of the source, as text: then its current content was copied, and the move is not
  /// done. Empty: all rows were compared; if they are equal, servers may open the target and no
  /// longer the source.
  std::string served_by;
  double copy_s = 0;       ///< all copies of this call
  double last_copy_s = 0;  ///< the last copy, of changes during the one before
  double verify_s = 0;
  bool was_done = false;              ///< by an earlier call; this one did nothing
  moving::Verification verification;  ///< beside a server: of rows that did not change meanwhile
};

/// Moves a store to another engine. After any interruption another call goes on. While a server has
/// the source open, it copies the current content and reports the server. Otherwise it copies the
/// rest, compares each row, opens the target for servers and closes the source to them.
///
/// \throws Failure(InvalidInput) if the names give no move between engines or databases;
///         Failure(NotFound) if there is no source; Failure(Conflict) if the target has content of
///         another origin; Failure(Unavailable) if a server has the target open, or another program
///         wrote to the source meanwhile; Failure(Storage). After each a new call can go on.
MoveResult move_store(const MoveOptions& options);

/// Gives up a move: removes the rows written to a target (`to`), or lets servers open a source
/// again (`from`).
/// \return text on the actions done, a line each.
/// \throws Failure(InvalidInput) if the store is in no move.
std::string give_up_move(const std::string& from, const std::string& to);

}  // namespace kinship::store
