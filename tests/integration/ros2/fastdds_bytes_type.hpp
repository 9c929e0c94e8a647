#pragma once

/// \file
/// What Fast DDS 2 (Debian 12) and 3 (Debian 13) call differently.

#if __has_include(<fastdds/utils/IPLocator.hpp>)
#define KINSHIP_IS_FASTDDS_3
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#endif
#include <cstdint>
#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <string>
#include <vector>

namespace kinship::test {

using Bytes = std::vector<std::uint8_t>;

#ifdef KINSHIP_IS_FASTDDS_3
namespace fast_rtps = eprosima::fastdds::rtps;
using FastDuration = eprosima::fastdds::dds::Duration_t;
using FastCode = eprosima::fastdds::dds::ReturnCode_t;
constexpr FastCode kFastOk = eprosima::fastdds::dds::RETCODE_OK;
#else
namespace fast_rtps = eprosima::fastrtps::rtps;
using FastDuration = eprosima::fastrtps::Duration_t;
using FastCode = eprosima::fastrtps::types::ReturnCode_t;
constexpr auto kFastOk = FastCode::RETCODE_OK;
#endif

/// Whether a call did what it should: `write` answers with a truth value in 2, with a code in 3.
inline bool succeeded(bool is_done) { return is_done; }
inline bool succeeded(const FastCode& code) { return code == kFastOk; }

/// A type by its name; its samples are bytes with their encapsulation, as rmw_fastrtps writes them.
class BytesType final : public eprosima::fastdds::dds::TopicDataType {
  static constexpr std::uint32_t kFirstSize = 1024;  // a payload grows by the size of its sample

  static bool write(const void* data, fast_rtps::SerializedPayload_t& payload) {
    const Bytes& bytes = *static_cast<const Bytes*>(data);
    payload.encapsulation = CDR_LE;
    payload.length = size_of(data);
    std::memcpy(payload.data, bytes.data(), bytes.size());
    return true;
  }
  static bool read(const fast_rtps::SerializedPayload_t& payload, void* data) {
    static_cast<Bytes*>(data)->assign(payload.data, payload.data + payload.length);
    return true;
  }
  static std::uint32_t size_of(const void* data) {
    return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size());
  }

 public:
#ifdef KINSHIP_IS_FASTDDS_3
  using Representation = eprosima::fastdds::dds::DataRepresentationId_t;

  explicit BytesType(const std::string& name) {
    set_name(name);
    max_serialized_type_size = kFirstSize;
  }
  bool serialize(const void* data, fast_rtps::SerializedPayload_t& payload,
                 Representation /*unused*/) override {
    return write(data, payload);
  }
  bool deserialize(fast_rtps::SerializedPayload_t& payload, void* data) override {
    return read(payload, data);
  }
  std::uint32_t calculate_serialized_size(const void* data, Representation /*unused*/) override {
    return size_of(data);
  }
  void* create_data() override { return new Bytes; }
  void delete_data(void* data) override { delete static_cast<Bytes*>(data); }
  bool compute_key(fast_rtps::SerializedPayload_t& /*payload*/,
                   fast_rtps::InstanceHandle_t& /*key*/, bool /*force*/) override {
    return false;
  }
  bool compute_key(const void* /*data*/, fast_rtps::InstanceHandle_t& /*key*/,
                   bool /*force*/) override {
    return false;
  }
#else
  explicit BytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kFirstSize;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, fast_rtps::SerializedPayload_t* payload) override {
    return write(data, *payload);
  }
  bool deserialize(fast_rtps::SerializedPayload_t* payload, void* data) override {
    return read(*payload, data);
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return size_of(data); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void* /*data*/, fast_rtps::InstanceHandle_t* /*key*/, bool /*force*/) override {
    return false;
  }
#endif
};

}  // namespace kinship::test
