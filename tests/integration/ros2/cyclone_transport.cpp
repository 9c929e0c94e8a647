#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/integration/ros2/transport.hpp"

namespace kinship::test {
namespace {

dds_entity_t checked(dds_entity_t handle) {
  if (handle < 0)
    throw std::runtime_error(dds_strretcode(-handle));
  return handle;
}

/// As rmw_cyclonedds has it with ROS_LOCALHOST_ONLY: the loopback interface, other nodes by
/// unicast.
class CycloneTransport final : public Transport {
 public:
  explicit CycloneTransport(std::uint32_t domain) {
    domain_ = checked(dds_create_domain(
        domain,
        variable("ROS_LOCALHOST_ONLY") == std::string("0")
            ? "<Domain Id=\"any\"/>"
            : "<Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
              "<AllowMulticast>false</AllowMulticast></General><Discovery>"
              "<ParticipantIndex>auto</ParticipantIndex>"
              "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
              "<Peers><Peer address=\"localhost\"/></Peers></Discovery></Domain>"));
    const Qos qos = security();
    participant_ = checked(dds_create_participant(domain, qos.get(), nullptr));
  }

  ~CycloneTransport() override { dds_delete(domain_); }  // others hear of it at once

  int open_writer(const std::string& topic, const TopicType& type) override {
    const dds_entity_t handle = make_topic(topic, type);
    return entity(dds_create_writer(participant_, handle, qos(false).get(), nullptr),
                  DDS_PUBLICATION_MATCHED_STATUS);
  }

  void close_writer(int writer) override { dds_delete(writer); }

  int open_reader(const std::string& topic, const TopicType& type, bool is_late) override {
    const dds_entity_t handle = make_topic(topic, type);
    return entity(dds_create_reader(participant_, handle, qos(is_late).get(), nullptr),
                  DDS_SUBSCRIPTION_MATCHED_STATUS | DDS_DATA_AVAILABLE_STATUS);
  }

  bool wait_for_writer_match(int writer, Deadline deadline) override {
    return wait(writer, deadline, [writer] {
      dds_publication_matched_status_t status{};
      dds_get_publication_matched_status(writer, &status);
      return status.current_count > 0;
    });
  }

  bool wait_for_reader_match(int reader, Deadline deadline) override {
    return wait(reader, deadline, [reader] {
      dds_subscription_matched_status_t status{};
      dds_get_subscription_matched_status(reader, &status);
      return status.current_count > 0;
    });
  }

  void write(int writer, const Outgoing& message) override {
    checked(dds_write(writer, message.sample));
  }

  std::optional<std::vector<std::uint8_t>> take(int reader, Deadline deadline) override {
    std::optional<std::vector<std::uint8_t>> bytes;
    wait(reader, deadline, [&] {
      std::uint32_t status = 0;
      dds_take_status(reader, &status, DDS_DATA_AVAILABLE_STATUS);
      ddsi_serdata* data = nullptr;
      dds_sample_info_t info{};
      while (!bytes && dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE) == 1) {
        if (info.valid_data) {
          bytes.emplace(ddsi_serdata_size(data));
          ddsi_serdata_to_ser(data, 0, bytes->size(), bytes->data());
        }
        ddsi_serdata_unref(data);
      }
      return bytes.has_value();
    });
    return bytes;
  }

 private:
  using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

  static const char* variable(const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : "";
  }

  /// As rmw_cyclonedds reads SROS 2's environment.
  static Qos security() {
    Qos qos(dds_create_qos(), &dds_delete_qos);
    if (variable("ROS_SECURITY_ENABLE") != std::string("true"))
      return qos;
    const std::string enclave = variable("ROS_SECURITY_KEYSTORE") + std::string("/enclaves") +
                                variable("ROS_SECURITY_ENCLAVE_OVERRIDE");
    const auto set = [&](const std::string& name, const std::string& value) {
      dds_qset_prop(qos.get(), ("dds.sec." + name).c_str(), value.c_str());
    };
    using Three = std::array<const char*, 3>;
    using Two = std::pair<const char*, const char*>;
    for (const auto& [role, file, suffix] :
         std::initializer_list<Three>{{"auth", "auth", "authentication"},
                                      {"access", "ac", "access_control"},
                                      {"crypto", "crypto", "crypto"}}) {
      const std::string library = std::string(role) + ".library.";
      set(library + "path", KINSHIP_DDS_PLUGINS "/libdds_security_" + std::string(file) + ".so");
      set(library + "init", "init_" + std::string(suffix));
      set(library + "finalize", "finalize_" + std::string(suffix));
    }
    for (const auto& [name, file] :
         std::initializer_list<Two>{{"auth.identity_ca", "identity_ca.cert.pem"},
                                    {"auth.identity_certificate", "cert.pem"},
                                    {"auth.private_key", "key.pem"},
                                    {"access.permissions_ca", "permissions_ca.cert.pem"},
                                    {"access.governance", "governance.p7s"},
                                    {"access.permissions", "permissions.p7s"}})
      set(name, "file:" + enclave + '/' + file);
    return qos;
  }

  static Qos qos(bool is_late) {
    Qos qos(dds_create_qos(), &dds_delete_qos);
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 10);
    dds_qset_durability(qos.get(),
                        is_late ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    return qos;
  }

  dds_entity_t make_topic(const std::string& topic, const TopicType& type) const {
    return checked(
        dds_create_topic(participant_, type.descriptor, topic.c_str(), nullptr, nullptr));
  }

  static int entity(dds_entity_t handle, std::uint32_t statuses) {
    checked(handle);
    checked(dds_set_status_mask(handle, statuses));
    return handle;
  }

  bool wait(dds_entity_t entity, Deadline deadline, const std::function<bool()>& holds) const {
    const dds_entity_t waitset = checked(dds_create_waitset(participant_));
    dds_waitset_attach(waitset, entity, 1);
    bool does_hold = holds();
    while (!does_hold && std::chrono::steady_clock::now() < deadline) {
      const std::chrono::nanoseconds left = deadline - std::chrono::steady_clock::now();
      dds_waitset_wait(waitset, nullptr, 0, std::max<dds_duration_t>(left.count(), 0));
      does_hold = holds();
    }
    dds_delete(waitset);
    return does_hold;
  }

  dds_entity_t domain_ = 0, participant_ = 0;
};

}  // namespace

std::unique_ptr<Transport> join(std::uint32_t domain) {
  return std::make_unique<CycloneTransport>(domain);
}

}  // namespace kinship::test
