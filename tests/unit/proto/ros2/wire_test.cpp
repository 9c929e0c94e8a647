#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>
#include <messages.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "proto/ros2/wire.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/ros2/message_cdr.hpp"

// Made by tests/support/ros2/generate.py.
#include <copies.hpp>

namespace kinship::ros2 {
namespace {

/// What Cyclone DDS sends of samples of the types in proto/ros2.
class RosWire : public testing::Test {
 public:
  ~RosWire() override { dds_delete(domain_handle_); }

 protected:
  RosWire() {
    domain_handle_ = dds_create_domain(
        domain_.number(),
        "<Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
        "<AllowMulticast>false</AllowMulticast></General></Domain>");
    participant_ = dds_create_participant(domain_.number(), nullptr, nullptr);
  }
  /// With the four bytes of the encapsulation, without padding at the end.
  std::vector<std::uint8_t> sent(const dds_topic_descriptor_t& type, const void* sample) const {
    const dds_entity_t topic = dds_create_topic(participant_, &type, "a_topic", nullptr, nullptr);
    const dds_entity_t reader = dds_create_reader(participant_, topic, nullptr, nullptr);
    const dds_entity_t writer = dds_create_writer(participant_, topic, nullptr, nullptr);
    EXPECT_EQ(dds_write(writer, sample), DDS_RETCODE_OK);
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info{};
    EXPECT_EQ(dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE), 1);
    std::vector<std::uint8_t> bytes(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data);
    dds_delete(writer);
    dds_delete(reader);
    dds_delete(topic);
    bytes.resize(bytes.size() - bytes[3]);  // its options: how many are padding
    bytes[3] = 0;
    return bytes;
  }

  template <typename Ros, typename Wire>
  void expect_alike(const rosidl_message_type_support_t* type, bool (*init)(Ros*),
                    void (*fini)(Ros*), const dds_topic_descriptor_t& descriptor, Wire wire) const {
    SCOPED_TRACE(descriptor.m_typename);
    Ros message;
    ASSERT_TRUE(init(&message));
    const std::unique_ptr<Ros, void (*)(Ros*)> content(&message, fini);
    test::fill(type, &message);
    copy(message, wire);
    std::vector<std::uint8_t> expected = test::to_cdr(type, &message);
    if constexpr (requires { wire.guid; }) {  // rmw_cyclonedds writes it before the message
      wire.guid = 0x0102030405060708;
      wire.sequence_number = 9;
      const std::vector<std::uint8_t> identity = {8, 7, 6, 5, 4, 3, 2, 1, 9, 0, 0, 0, 0, 0, 0, 0};
      expected.insert(expected.begin() + 4, identity.begin(), identity.end());
    }
    EXPECT_EQ(sent(descriptor, &wire), expected);
  }

  test::ReservedDomain domain_;
  dds_entity_t domain_handle_ = 0;
  dds_entity_t participant_ = 0;
};

/// rosidl's structure of a type, and proto/ros2's.
#define EXPECT_ALIKE(KIND, NAME)                                                                 \
  expect_alike(ROSIDL_TYPESUPPORT_INTERFACE__MESSAGE_SYMBOL_NAME(                                \
                   rosidl_typesupport_introspection_c, kinship_msgs, KIND, NAME)(),              \
               &kinship_msgs__##KIND##__##NAME##__init, &kinship_msgs__##KIND##__##NAME##__fini, \
               kinship_msgs_##KIND##_dds__##NAME##__desc, kinship_msgs_##KIND##_dds__##NAME##_{})

TEST_F(RosWire, MessagesAreWhatRosidlMakesOfThem) {
  EXPECT_ALIKE(msg, Registration);
  EXPECT_ALIKE(msg, Registered);
  EXPECT_ALIKE(msg, PlannedPath);
  EXPECT_ALIKE(msg, Receipt);
  EXPECT_ALIKE(msg, DistributionQuery);
  EXPECT_ALIKE(msg, DistributionAnswer);
  EXPECT_ALIKE(msg, Distribution);
  EXPECT_ALIKE(msg, StatusQuery);
  EXPECT_ALIKE(msg, Status);
}

TEST_F(RosWire, ServicesAreWhatRosidlMakesOfThemBehindTheIdentityOfARequest) {
  EXPECT_ALIKE(srv, Register_Request);
  EXPECT_ALIKE(srv, Register_Response);
  EXPECT_ALIKE(srv, Report_Request);
  EXPECT_ALIKE(srv, Report_Response);
  EXPECT_ALIKE(srv, Fetch_Request);
  EXPECT_ALIKE(srv, Fetch_Response);
  EXPECT_ALIKE(srv, GetStatus_Request);
  EXPECT_ALIKE(srv, GetStatus_Response);
}

}  // namespace
}  // namespace kinship::ros2
