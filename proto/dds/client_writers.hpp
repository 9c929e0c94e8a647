#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "proto/dds/entity.hpp"
#include "proto/dds/matched_readers.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/wait_loop.hpp"

namespace kinship::dds {

/// The server's writers of one topic in a domain with security: one for each client, in the
/// partition that only this client may read. For sources of proto/dds only; may be shared between
/// threads.
///
/// A client's is made when a reader of the client is discovered, or a reply to it is sent; it is
/// freed some time after the last reader has gone. So there are as many as connected clients. A
/// client that the directory does not know when it is discovered gets its writer once the directory
/// knows it. A publication's writer (on_new) is freed, with its samples for late readers, a second
/// or two after its client was revoked or the client's rights changed; in the latter case a new one
/// is made.
class ClientWriters {
 public:
  /// Called with a new writer made for a discovered reader of its client.
  using OnNew = std::function<void(const std::string& name, const Entity& writer)>;

  /// \param topic   of these writers; outlives them.
  /// \param name    of the topic.
  /// \param loop    whose thread notices readers.
  /// \param matched_readers  used to make the writers, if any; outlive them.
  ClientWriters(const Participant& participant, WaitLoop& loop, const Entity& topic,
                std::string name, Qos qos, MatchedReaders* matched_readers = nullptr);
  ClientWriters(const ClientWriters&) = delete;
  ClientWriters& operator=(const ClientWriters&) = delete;

  /// To be set before the loop runs.
  void on_new(OnNew handler) { on_new_ = std::move(handler); }

  /// The client's writer, made if there is none. Shared: another thread may drop it during a write.
  /// \throws Failure(Internal) if it cannot be made.
  std::shared_ptr<const Entity> of(const std::string& name);

  /// Null if there is none.
  std::shared_ptr<const Entity> find(const std::string& name);

  /// Calls `use` for every client's writer, not under a lock.
  void for_each(
      const std::function<void(const std::string& name, const Entity& writer)>& use) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Writer {
    std::shared_ptr<const Entity> writer;  // owns its publisher too
    Clock::time_point used;                // last time that it was used or had a reader
    Caller rights = {};                    // for which it was made, if for a reader
  };

  /// Null if there is one.
  std::shared_ptr<const Entity> make(const std::string& name, const Caller& rights);
  bool notice_readers();
  void let_in(const std::string& name);
  void look_again();
  void replace_changed();
  void free_unread(Clock::time_point now);

  Handle participant_;
  Directory directory_;
  Handle topic_;
  std::string name_;
  Qos qos_;
  MatchedReaders* matched_readers_;  // null: the writers are made without it
  OnNew on_new_;
  Entity readers_;                 // reader of the built-in topic of readers
  std::set<std::string> unknown_;  // clients with a reader, not admitted; of the loop's thread
  mutable std::mutex mutex_;       // guards what follows
  std::map<std::string, Writer> writers_;
  Clock::time_point swept_;
};

}  // namespace kinship::dds
