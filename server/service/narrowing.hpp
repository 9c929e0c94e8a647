#pragma once

#include <string>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "server/service/admin_page.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Restricts the admin requests of a caller whose certificate is for some tasks or robots only: a
/// request for another name is refused with the same text whether it exists or not, one for another
/// id is NotFound, and rows of others are left out of a listing (so a page may be short, or empty,
/// before the last one). Does nothing for other callers.
class Narrowing {
 public:
  /// Both outlive the object.
  Narrowing(const store::Store& store, const Caller& caller) : store_(store), caller_(caller) {}

  /// \throws Failure(InvalidInput, NotFound); call it before the request is handled.
  void check(const AdminRequest& request) const;

  /// Removes rows about other tasks and robots from an answer.
  void apply(AdminPage& page) const;

 private:
  std::string label_of(const Digest& robot) const;
  std::string label_of(const std::string& name) const;
  void check_argument(const AdminRequest& request) const;
  void check_filters_of_restoration(const AdminRequest& request) const;
  void check_report(const std::string& uuid) const;
  void check_distribution(const std::string& prefix) const;
  bool keeps(AdminRow& row) const;

  const store::Store& store_;
  const Caller& caller_;
};

}  // namespace kinship::service
