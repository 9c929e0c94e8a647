#pragma once

#include <filesystem>

namespace kinship::cli {

/// An outbox of this process alone, empty and deleted at its end. A client sends what its outbox
/// holds; a program that only looks must not send what others left in the user's outbox, perhaps
/// for a server in another domain.
class EmptyOutbox {
 public:
  /// \throws Failure(Storage) if there is no place for temporary files.
  EmptyOutbox();
  ~EmptyOutbox();
  EmptyOutbox(const EmptyOutbox&) = delete;
  EmptyOutbox& operator=(const EmptyOutbox&) = delete;

  const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace kinship::cli
