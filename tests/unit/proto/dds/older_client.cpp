// A client of an older contract, for tests: older_client DOMAIN CONFIGURATION sends reports of one
// short attempt (older_report.idl) for a minute or until it is killed. It has types of the same
// names as the library, so it uses nothing of it.

#include <dds/dds.h>

#include <cstdlib>

#include "older_report.h"

int main(int /*argc*/, char** argv) {
  const auto domain = static_cast<dds_domainid_t>(std::atoi(argv[1]));
  dds_create_domain(domain, argv[2]);
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  const dds_entity_t topic = dds_create_topic(participant, &kinship_wire_ReportRequest_desc,
                                              "kinship/report/request", nullptr, nullptr);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t writer = dds_create_writer(participant, topic, qos, nullptr);
  if (writer < 0)
    return 1;
  char machine[] = "cell 3";
  char task[] = "bin_to_shelf";
  kinship_wire_Attempt attempt{};
  attempt.report_uuid[0] = 7;
  attempt.machine = machine;
  attempt.task = task;
  kinship_wire_ReportRequest request{};
  request.attempts = {1, 1, &attempt, false};
  while (++request.sequence_number <= 600) {
    dds_write(writer, &request);
    dds_sleepfor(DDS_MSECS(100));
  }
}
