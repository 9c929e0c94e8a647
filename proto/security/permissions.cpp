#include "proto/security/permissions.hpp"

#include "proto/types/time_text.hpp"

namespace kinship::security {
namespace {

using Topics = std::vector<std::string>;

std::string element(const std::string& indent, const std::string& name, std::string_view value) {
  return indent + "<" + name + ">" + std::string(value) + "</" + name + ">\n";
}

/// One <publish> or <subscribe>.
std::string criteria(const std::string& verb, const Topics& topics, const std::string& partition) {
  std::string text = "        <" + verb + ">\n          <topics>\n";
  for (const std::string& topic : topics)
    text += element("            ", "topic", topic);
  text += "          </topics>\n          <partitions>\n";
  text += element("            ", "partition", partition);
  return text + "          </partitions>\n        </" + verb + ">\n";
}

std::string document(std::string_view name, const Validity& validity, const std::string& rules) {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<dds>
  <permissions>
    <grant name=")" +
         std::string(name) + "\">\n" + element("      ", "subject_name", subject_text(name)) +
         "      <validity>\n" + element("        ", "not_before", time_text(validity.begin)) +
         element("        ", "not_after", time_text(validity.end)) + R"(      </validity>
      <allow_rule>
        <domains>
          <id_range>
            <min>0</min>
            <max>230</max>
          </id_range>
        </domains>
)" + rules +
         R"(      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)";
}

}  // namespace

std::string subject_text(std::string_view name) { return "CN=" + std::string(name) + ",O=Kinship"; }

std::vector<std::string> conversations_of(AccessRole role) {
  switch (role) {
    case AccessRole::Robot:
      return {"register", "report", "fetch"};
    case AccessRole::Reader:
    case AccessRole::Operator:
      return {"fetch", "admin"};
    case AccessRole::Admin:
      return {"register", "report", "fetch", "admin"};
  }
  return {};
}

std::string client_partition(std::string_view name) { return "client_" + std::string(name); }

std::string client_permissions(std::string_view name, AccessRole role, const Validity& validity) {
  Topics requests;
  Topics heard = {"kinship/announcement"};
  for (const std::string& conversation : conversations_of(role)) {
    requests.push_back("kinship/" + conversation + "/request");
    heard.push_back("kinship/" + conversation + "/reply");
  }
  if (role != AccessRole::Robot)
    heard.emplace_back("kinship/event");
  const std::string partition = client_partition(name);
  return document(
      name, validity,
      criteria("publish", requests, partition) + criteria("subscribe", heard, partition));
}

std::string server_permissions(std::string_view name, const Validity& validity) {
  Topics requests;
  Topics told = {"kinship/announcement", "kinship/event"};
  for (const std::string& conversation : conversations_of(AccessRole::Admin)) {
    requests.push_back("kinship/" + conversation + "/request");
    told.push_back("kinship/" + conversation + "/reply");
  }
  const std::string partitions = client_partition("*");
  return document(
      name, validity,
      criteria("publish", told, partitions) + criteria("subscribe", requests, partitions));
}

}  // namespace kinship::security
