#pragma once

#include <string>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "server/service/admin_page.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// An admin request of a caller whose certificate is for some tasks or robots only: what it asks
/// for by name is refused in the same words whether it is there or not, what it asks for by an id
/// is not found, and of a listing the rows of others are left out (so a page may be short, or
/// empty, before the last one). Does nothing for other callers.
class Narrowing {
 public:
  /// Both outlive it.
  Narrowing(const store::Store& store, const Caller& caller) : store_(store), caller_(caller) {}

  /// \throws Failure(InvalidInput, NotFound), before anything is done.
  void check(const AdminRequest& request) const;

  /// Takes out of an answer what is about others.
  void apply(AdminPage& page) const;

 private:
  std::string label_of(const Digest& robot) const;
  std::string label_of(const std::string& name) const;
  void check_argument(const AdminRequest& request) const;
  void check_report(const std::string& uuid) const;
  void check_distribution(const std::string& prefix) const;
  bool keeps(AdminRow& row) const;

  const store::Store& store_;
  const Caller& caller_;
};

}  // namespace kinship::service
