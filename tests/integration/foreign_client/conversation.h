/* What every conversation with kinshipd needs: domain, partition, retries. From proto/CONTRACT.md,
 * whose headings are in quotation marks here. */
#ifndef FOREIGN_CLIENT_CONVERSATION_H
#define FOREIGN_CLIENT_CONVERSATION_H

#include <stdint.h>

#include "dds/dds.h"

typedef struct {
  dds_entity_t writer, reader, waitset;
  uint64_t last_sequence_number;
} conversation;

/* Both end the program with a message if not. */
dds_entity_t checked(dds_entity_t result, const char* what);
void expect(int holds, const char* what);

void make_uuid(uint8_t uuid[16]);              /* "UUIDs and digests" */
unsigned partition_of(const uint8_t uuid[16]); /* "Partition" */
dds_entity_t join(uint32_t domain);            /* "Domain and ports"; a participant */
dds_qos_t* make_qos(int is_request);           /* "Topics": of requests, or of replies */
dds_entity_t make_waitset(dds_entity_t reader);

/* Topics kinship/NAME/request and kinship/NAME/reply. */
conversation open_conversation(const char* name, const dds_topic_descriptor_t* request,
                               const dds_topic_descriptor_t* reply);

/* "Retries": fills in the head, sends, and waits for the reply, which the reader lends: give it
 * back with dds_return_loan. */
void* call(conversation* with, void* request);

#endif
