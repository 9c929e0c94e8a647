#include "conversation.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint8_t client_id[16];
static dds_entity_t participant;

dds_entity_t checked(dds_entity_t result, const char* what) {
  if (result < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-result));
    exit(1);
  }
  return result;
}

void expect(int holds, const char* what) {
  if (!holds) {
    fprintf(stderr, "not as the page says: %s\n", what);
    exit(1);
  }
}

/* "UUID": 16 random bytes with version 4 and variant 1. */
void make_uuid(uint8_t uuid[16]) {
  FILE* random = fopen("/dev/urandom", "rb");
  expect(random && fread(uuid, 1, 16, random) == 16, "/dev/urandom");
  fclose(random);
  uuid[6] = (uint8_t)((uuid[6] & 0x0F) | 0x40);
  uuid[8] = (uint8_t)((uuid[8] & 0x3F) | 0x80);
}

/* "Partition" */
unsigned partition_of(const uint8_t uuid[16]) {
  uint32_t hash = 2166136261u;
  for (int i = 0; i < 16; ++i)
    hash = (hash ^ uuid[i]) * 16777619u;
  return hash % 16;
}

/* "Domain and ports" */
dds_entity_t join(uint32_t domain) {
  make_uuid(client_id);
  char configuration[1024];
  snprintf(configuration, sizeof configuration,
           "<CycloneDDS xmlns=\"https://cdds.io/config\"><Domain Id=\"any\">"
           "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces>"
           "<AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>"
           "<FragmentSize>8000B</FragmentSize></General>"
           "<Discovery><ParticipantIndex>none</ParticipantIndex>"
           "<Peers><Peer address=\"127.0.0.1:%" PRIu32
           "\"/></Peers>"
           "<SPDPInterval>1s</SPDPInterval><LeaseDuration>5s</LeaseDuration></Discovery>"
           "<Internal><SocketReceiveBufferSize max=\"4MB\"/>"
           "<Watermarks><WhcHigh>8MB</WhcHigh></Watermarks>"
           "<HeartbeatInterval>10ms</HeartbeatInterval><NackDelay>10ms</NackDelay>"
           "<MaxSampleSize>2MB</MaxSampleSize></Internal></Domain></CycloneDDS>",
           7400 + 250 * domain + 10);
  checked(dds_create_domain(domain, configuration), "domain");
  participant = checked(dds_create_participant(domain, NULL, NULL), "participant");
  return participant;
}

/* "Topics": the QoS of requests (keep all) or replies (keep last 64). */
dds_qos_t* make_qos(int is_request) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_writer_data_lifecycle(qos, false);
  if (is_request)
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  else
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 64);
  return qos;
}

dds_entity_t make_waitset(dds_entity_t reader) {
  const dds_entity_t waitset = checked(dds_create_waitset(participant), "waitset");
  checked(dds_waitset_attach(waitset, dds_create_readcondition(reader, DDS_ANY_STATE), 0),
          "waitset");
  return waitset;
}

conversation open_conversation(const char* name, const dds_topic_descriptor_t* request,
                               const dds_topic_descriptor_t* reply) {
  conversation made = {0, 0, 0, 0};
  char topic_name[64];
  dds_qos_t* qos = make_qos(1);
  snprintf(topic_name, sizeof topic_name, "kinship/%s/request", name);
  const dds_entity_t request_topic =
      checked(dds_create_topic(participant, request, topic_name, NULL, NULL), topic_name);
  made.writer = checked(dds_create_writer(participant, request_topic, qos, NULL), "writer");
  dds_delete_qos(qos);

  char partition[16];
  snprintf(partition, sizeof partition, "reply_%02u", partition_of(client_id));
  const char* partitions[] = {partition};
  qos = dds_create_qos();
  dds_qset_partition(qos, 1, partitions);
  const dds_entity_t subscriber =
      checked(dds_create_subscriber(participant, qos, NULL), "subscriber");
  dds_delete_qos(qos);

  qos = make_qos(0);
  snprintf(topic_name, sizeof topic_name, "kinship/%s/reply", name);
  const dds_entity_t reply_topic =
      checked(dds_create_topic(participant, reply, topic_name, NULL, NULL), topic_name);
  made.reader = checked(dds_create_reader(subscriber, reply_topic, qos, NULL), "reader");
  dds_delete_qos(qos);
  made.waitset = make_waitset(made.reader);
  return made;
}

/* Every message of a conversation begins with these. */
typedef struct {
  uint8_t client_id[16];
  uint64_t sequence_number;
} head;

/* "Retries": sends when a server is matched, again after 100 ms, 300 ms, then every second.
 * The reply is lent by the reader: give it back with dds_return_loan. */
void* call(conversation* with, void* request) {
  head* sent = request;
  memcpy(sent->client_id, client_id, sizeof client_id);
  sent->sequence_number = ++with->last_sequence_number;
  const dds_time_t deadline = dds_time() + DDS_SECS(120);
  dds_duration_t pause = DDS_MSECS(100);
  while (dds_time() < deadline) {
    if (dds_get_matched_subscriptions(with->writer, NULL, 0) > 0) {
      dds_write(with->writer, request);
      pause = pause == DDS_MSECS(100) ? DDS_MSECS(300) : DDS_SECS(1);
    }
    const dds_time_t next_send = dds_time() + pause;
    while (dds_time() < next_send) {
      dds_attach_t ready;
      dds_waitset_wait_until(with->waitset, &ready, 1, next_send);
      void* sample = NULL;
      dds_sample_info_t info;
      if (dds_take(with->reader, &sample, &info, 1, 1) < 1)
        continue;
      const head* got = sample;
      if (info.valid_data && memcmp(got->client_id, client_id, sizeof client_id) == 0 &&
          got->sequence_number == sent->sequence_number)
        return sample;
      dds_return_loan(with->reader, &sample, 1);
    }
  }
  expect(0, "no reply within two minutes");
  return NULL;
}
