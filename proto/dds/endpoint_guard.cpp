#include "proto/dds/endpoint_guard.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_plist.h>
#include <dds/ddsi/q_rtps.h>
#include <dlfcn.h>

#include <atomic>

#include "proto/dds/binding.hpp"

// Of dds/ddsi/ddsi_proxy_endpoint.h, which is no C++.
struct addrset;
struct nn_dqueue;
struct xeventq;

namespace kinship::dds {
namespace {

std::atomic<int>& guards() {
  static std::atomic<int> count = 0;
  return count;
}

/// Whether Cyclone DDS may hear of it: it states its security, or is a built-in endpoint by which
/// participants find and trust each other, which has no topic of ours.
bool is_admitted(const ddsi_guid& endpoint, const ddsi_plist_t& announced) {
  if (guards() == 0 ||
      (endpoint.entityid.u & NN_ENTITYID_SOURCE_MASK) == NN_ENTITYID_SOURCE_BUILTIN)
    return true;
  const nn_security_info_t& security = announced.endpoint_security_info;
  return (announced.present & PP_ENDPOINT_SECURITY_INFO) != 0 &&
         (security.security_attributes & NN_ENDPOINT_SECURITY_ATTRIBUTES_FLAG_IS_VALID) != 0 &&
         (security.plugin_security_attributes & NN_ENDPOINT_SECURITY_ATTRIBUTES_FLAG_IS_VALID) != 0;
}

}  // namespace

EndpointGuard::EndpointGuard() { ++guards(); }
EndpointGuard::~EndpointGuard() { --guards(); }

}  // namespace kinship::dds

/// In front of the functions of these names in Cyclone DDS, which are called for each reader and
/// writer that a peer announces: a program's own symbols come before those of libraries.
// NOLINTNEXTLINE(readability-function-size): its parameters are Cyclone DDS's
extern "C" __attribute__((visibility("default"))) int ddsi_new_proxy_writer(
    ddsi_domaingv* domain, const ddsi_guid* participant, const ddsi_guid* guid, addrset* addresses,
    const ddsi_plist* announced, nn_dqueue* queue, xeventq* events, ddsrt_wctime_t time,
    seqno_t sequence_number) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsi_new_proxy_writer)>(
      dlsym(RTLD_NEXT, "ddsi_new_proxy_writer"));  // NOLINT: what dlsym is for
  if (!kinship::dds::is_admitted(*guid, *announced))
    return -1;
  return kBehind(domain, participant, guid, addresses, announced, queue, events, time,
                 sequence_number);
}

// NOLINTNEXTLINE(readability-function-size): its parameters are Cyclone DDS's
extern "C" __attribute__((visibility("default"))) int ddsi_new_proxy_reader(
    ddsi_domaingv* domain, const ddsi_guid* participant, const ddsi_guid* guid, addrset* addresses,
    const ddsi_plist* announced, ddsrt_wctime_t time, seqno_t sequence_number, int favours_ssm) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsi_new_proxy_reader)>(
      dlsym(RTLD_NEXT, "ddsi_new_proxy_reader"));  // NOLINT: what dlsym is for
  if (!kinship::dds::is_admitted(*guid, *announced))
    return -1;
  return kBehind(domain, participant, guid, addresses, announced, time, sequence_number,
                 favours_ssm);
}

bool kinship::dds::is_endpoint_guard_in_place() {
  const auto is_in_front = [](const char* name, auto* function) {
    return is_in_front_of_cyclone(name, reinterpret_cast<void*>(function));  // NOLINT: as above
  };
  return is_in_front("ddsi_new_proxy_writer", &ddsi_new_proxy_writer) &&
         is_in_front("ddsi_new_proxy_reader", &ddsi_new_proxy_reader);
}
