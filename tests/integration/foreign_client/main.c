/* A client of kinshipd in C11 that was written from proto/CONTRACT.md and the IDL alone; it
 * includes no source of Kinship. It registers a planar arm, reports paths and fetches the
 * distribution; with a second argument it reports more and waits for the announcement of the newer
 * revision.
 *
 *   foreign_client DOMAIN [follow]
 *
 * Prints what it got, one line a step; exit code 0 if all of it was as the page says. */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "conversation.h"
#include "fetch.h"
#include "publication.h"
#include "register.h"
#include "report.h"

enum { DOF = 3, WAYPOINTS = 4, MAX_BATCH = 16 };

static const char* const URDF =
    "<robot name='planar'>"
    "<link name='base'/><link name='a'/><link name='b'/><link name='c'/><link name='tip'/>"
    "<joint name='j1' type='revolute'><parent link='base'/><child link='a'/><axis xyz='0 0 1'/>"
    "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint>"
    "<joint name='j2' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>"
    "<origin xyz='0.4 0 0'/><limit lower='-2.5' upper='2.5' effort='1' velocity='1'/></joint>"
    "<joint name='j3' type='revolute'><parent link='b'/><child link='c'/><axis xyz='0 0 1'/>"
    "<origin xyz='0.3 0 0'/><limit lower='-2.5' upper='2.5' effort='1' velocity='1'/></joint>"
    "<joint name='end' type='fixed'><parent link='c'/><child link='tip'/>"
    "<origin xyz='0.2 0 0'/></joint></robot>";

static dds_entity_t participant;

static void register_robot(uint8_t robot[32]) {
  conversation with = open_conversation("register", &kinship_wire_RegisterRequest_desc,
                                        &kinship_wire_RegisterReply_desc);
  kinship_wire_RegisterRequest request;
  memset(&request, 0, sizeof request);
  request.label = "foreign_arm";
  request.urdf = (char*)URDF;
  request.base_link = "base";
  request.tip_link = "tip";
  request.T_tip_transfer[6] = 1; /* qw */
  request.task_axes[0] = request.task_axes[1] = request.task_axes[5] = true;
  void* sample = call(&with, &request);
  const kinship_wire_RegisterReply* reply = sample;
  printf("registered status=%" PRIu32 " dof=%" PRIu32 " solver=%s %s\n", reply->status, reply->dof,
         reply->solver, reply->message);
  expect(reply->status <= 1 && reply->dof == DOF, "a planar arm of three joints is registered");
  memcpy(robot, reply->robot, 32);
  dds_return_loan(with.reader, &sample, 1);
}

/* Sweeps of the first joint with the elbow bent; `first` makes them differ. */
static void report(const uint8_t robot[32], int first, int count) {
  static conversation with;
  if (with.writer == 0)
    with = open_conversation("report", &kinship_wire_ReportRequest_desc,
                             &kinship_wire_ReportReply_desc);
  static double waypoints[MAX_BATCH][WAYPOINTS][DOF];
  kinship_wire_Attempt attempts[MAX_BATCH];
  kinship_wire_PlanningRecord records[MAX_BATCH];
  memset(attempts, 0, sizeof attempts);
  memset(records, 0, sizeof records);
  for (int i = 0; i < count; ++i) {
    for (int w = 0; w < WAYPOINTS; ++w) {
      waypoints[i][w][0] = -1.2 + 0.8 * w;
      waypoints[i][w][1] = 0.5 + 0.02 * (first + i);
      waypoints[i][w][2] = 0.3 * w - 0.01 * (first + i);
    }
    kinship_wire_Attempt* attempt = &attempts[i];
    make_uuid(attempt->report_uuid);
    memcpy(attempt->robot, robot, 32);
    attempt->machine = "foreign";
    attempt->task = "foreign_sweep";
    kinship_wire_PlanningRecord* record = &records[i];
    attempt->record._length = attempt->record._maximum = 1;
    attempt->record._buffer = record;
    record->planner = "by_hand";
    record->planner_options = "";
    record->planning_time_s = 0.5;
    record->collision_checks = 100;
    record->time_limit_s = 10;
    record->sampling_mode = 2;
    attempt->dof = DOF;
    attempt->waypoints._length = attempt->waypoints._maximum = DOF * WAYPOINTS;
    attempt->waypoints._buffer = &waypoints[i][0][0];
  }
  kinship_wire_ReportRequest request;
  memset(&request, 0, sizeof request);
  request.attempts._length = request.attempts._maximum = (uint32_t)count;
  request.attempts._buffer = attempts;
  void* sample = call(&with, &request);
  const kinship_wire_ReportReply* reply = sample;
  int stored = 0;
  for (uint32_t i = 0; i < reply->receipts._length; ++i)
    if (reply->receipts._buffer[i].status == 0)
      ++stored;
    else
      fprintf(stderr, "receipt: %s\n", reply->receipts._buffer[i].message);
  printf("reported stored=%d\n", stored);
  expect(stored == count, "each path is stored");
  dds_return_loan(with.reader, &sample, 1);
}

/* Fetches until it is ready, and follows. */
static uint64_t fetch(const uint8_t robot[32], uint8_t id[32]) {
  static conversation with;
  if (with.writer == 0)
    with =
        open_conversation("fetch", &kinship_wire_FetchRequest_desc, &kinship_wire_FetchReply_desc);
  kinship_wire_FetchRequest request;
  memset(&request, 0, sizeof request);
  request.task = "foreign_sweep";
  memcpy(request.robot, robot, 32);
  request.profile = "default";
  request.deadline_ms = 20000;
  request.follow_s = 600;
  for (int attempt = 0; attempt < 6; ++attempt) {
    void* sample = call(&with, &request);
    const kinship_wire_FetchReply* reply = sample;
    expect(reply->status == 0 || reply->status == 1 || reply->status == 4, reply->message);
    if (reply->status == 0) {
      expect(
          reply->distribution._length == 1 && reply->distribution._buffer[0].mixture._length == 1,
          "ready has a mixture");
      const kinship_wire_Distribution* got = &reply->distribution._buffer[0];
      const kinship_wire_Mixture* mixture = &got->mixture._buffer[0];
      const uint32_t k = mixture->weights._length;
      expect(mixture->means._length == DOF * k && got->limits._length == 2 * DOF &&
                 mixture->covariances._length == DOF * (DOF + 1) / 2 * k,
             "shapes of a mixture");
      double sum = 0;
      for (uint32_t i = 0; i < k; ++i)
        sum += mixture->weights._buffer[i];
      expect(sum > 0.999 && sum < 1.001, "weights sum to 1");
      expect(got->limits._buffer[0] == -3 && got->limits._buffer[1] == 3, "limits of joint 1");
      const uint64_t revision = got->revision;
      memcpy(id, got->id, 32);
      printf("fetched revision=%" PRIu64 " components=%" PRIu32 " paths=%" PRIu64 "\n", revision, k,
             got->sources._buffer[0].paths);
      dds_return_loan(with.reader, &sample, 1);
      return revision;
    }
    const uint32_t retry_after_ms = reply->retry_after_ms;
    dds_return_loan(with.reader, &sample, 1);
    dds_sleepfor(DDS_MSECS(retry_after_ms));
  }
  expect(0, "no distribution after six fetches");
  return 0;
}

static dds_entity_t subscribe(void) {
  dds_qos_t* qos = make_qos(0);
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  const dds_entity_t topic = checked(dds_create_topic(participant, &kinship_wire_Announcement_desc,
                                                      "kinship/announcement", NULL, NULL),
                                     "announcement");
  const dds_entity_t reader = checked(dds_create_reader(participant, topic, qos, NULL), "reader");
  dds_delete_qos(qos);
  return reader;
}

/* "Announcements": waits for a revision above `known`. */
static void wait_for_newer(dds_entity_t reader, const uint8_t id[32], uint64_t known) {
  const dds_entity_t waitset = make_waitset(reader);
  const dds_time_t deadline = dds_time() + DDS_SECS(120);
  while (dds_time() < deadline) {
    dds_attach_t ready;
    dds_waitset_wait(waitset, &ready, 1, DDS_SECS(1));
    void* sample = NULL;
    dds_sample_info_t info;
    if (dds_take(reader, &sample, &info, 1, 1) < 1)
      continue;
    const kinship_wire_Announcement* news = sample;
    const int is_newer =
        info.valid_data && memcmp(news->distribution_id, id, 32) == 0 && news->revision > known;
    if (is_newer)
      printf("announced revision=%" PRIu64 " task=%s\n", news->revision, news->task);
    dds_return_loan(reader, &sample, 1);
    if (is_newer)
      return;
  }
  expect(0, "no announcement within two minutes");
}

int main(int argc, char** argv) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (argc != 2 && argc != 3)
    return 2;
  static const uint8_t example[16] = {0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77,
                                      0x88, 0x99, 0xAA, 0xBB, 0xCC, 0xDD, 0xEE, 0xFF};
  expect(partition_of(example) == 5, "the worked example of the partition");
  participant = join((uint32_t)strtoul(argv[1], NULL, 10));
  const dds_entity_t announcements = subscribe();
  uint8_t robot[32], id[32];
  register_robot(robot);
  report(robot, 0, 6);
  const uint64_t first = fetch(robot, id);
  if (argc == 3) {
    report(robot, 6, 12);
    wait_for_newer(announcements, id, first);
    expect(fetch(robot, id) > first, "the announced revision can be fetched");
  }
  fflush(stdout);
  checked(dds_delete(participant), "participant");
  return 0;
}
