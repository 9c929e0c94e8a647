#include "server/console/questions.hpp"

#include <future>
#include <memory>

namespace kinship::console {
namespace {

constexpr const char* kName = "console";

Caller caller_of(bool is_admin) {
  return {.client = kName,
          .name = kName,
          .role = is_admin ? AccessRole::Admin : AccessRole::Operator,
          .is_local = true};
}

ErrorCode code_of(AdminStatus status) {
  switch (status) {
    case AdminStatus::NotFound:
      return ErrorCode::NotFound;
    case AdminStatus::Refused:
      return ErrorCode::InvalidInput;
    case AdminStatus::Ok:
    case AdminStatus::Failed:
      break;
  }
  return ErrorCode::Unavailable;
}

}  // namespace

Questions::Questions(service::AdminService& service, bool is_admin)
    : service_(service), caller_(caller_of(is_admin)) {}

void Questions::ask(const AdminRequest& request,
                    const std::function<void(const service::AdminPage&)>& done) {
  service_.administer(request, std::string(kName) + ' ' + std::to_string(++asked_), done, caller_);
}

service::AdminPage Questions::answer(const AdminRequest& request) {
  const auto answered = std::make_shared<std::promise<service::AdminPage>>();
  ask(request, [answered](const service::AdminPage& page) { answered->set_value(page); });
  service::AdminPage page = answered->get_future().get();
  if (page.status != AdminStatus::Ok)
    throw Failure(code_of(page.status), page.message);
  return page;
}

}  // namespace kinship::console
