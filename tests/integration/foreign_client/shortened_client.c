/* Sends one message that ends early (shortened.idl) in each conversation and prints how it was
 * answered.
 *
 *   shortened_client DOMAIN */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "conversation.h"
#include "shortened.h"

static void send_register(void) {
  conversation with = open_conversation("register", &kinship_wire_RegisterRequest_desc,
                                        &kinship_wire_RegisterReply_desc);
  kinship_wire_RegisterRequest request;
  const kinship_wire_RegisterReply* reply = call(&with, &request);
  printf("register status=%" PRIu32 "\n", reply->status);
}

static void send_report(void) {
  conversation with =
      open_conversation("report", &kinship_wire_ReportRequest_desc, &kinship_wire_ReportReply_desc);
  kinship_wire_Attempt attempt;
  make_uuid(attempt.report_uuid);
  kinship_wire_ReportRequest request;
  memset(&request, 0, sizeof request);
  request.attempts._length = request.attempts._maximum = 1;
  request.attempts._buffer = &attempt;
  const kinship_wire_ReportReply* reply = call(&with, &request);
  expect(reply->receipts._length == 1, "one receipt for one attempt");
  printf("report status=%" PRIu32 " %s\n", reply->receipts._buffer[0].status,
         reply->receipts._buffer[0].message);
}

static void send_fetch(void) {
  conversation with =
      open_conversation("fetch", &kinship_wire_FetchRequest_desc, &kinship_wire_FetchReply_desc);
  kinship_wire_FetchRequest request;
  const kinship_wire_FetchReply* reply = call(&with, &request);
  printf("fetch status=%" PRIu32 "\n", reply->status);
}

static void send_admin(void) {
  conversation with =
      open_conversation("admin", &kinship_wire_AdminRequest_desc, &kinship_wire_AdminReply_desc);
  kinship_wire_AdminRequest request;
  const kinship_wire_AdminReply* reply = call(&with, &request);
  printf("admin status=%" PRIu32 " %s\n", reply->status, reply->message);
}

int main(int argc, char** argv) {
  if (argc != 2)
    return 2;
  setvbuf(stdout, NULL, _IOLBF, 0);
  const dds_entity_t participant = join((uint32_t)strtoul(argv[1], NULL, 10));
  send_register();
  send_report();
  send_fetch();
  send_admin();
  checked(dds_delete(participant), "participant");
  return 0;
}
