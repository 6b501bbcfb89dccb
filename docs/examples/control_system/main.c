/* A control system of your own sends a test to sealwatch: with sealwatch's IDL files and Cyclone DDS alone, in C.
   Three blocks of one second at 200 Hz; a real one sends what its sensors say while the valve moves.
   Usage: control_system ASSET_ID. The test enters that asset's history: try it with an asset of your own. */
#include <stdio.h>

#include "data_acquisition.h"
#include "dds/dds.h"

enum { BLOCKS = 3, SAMPLES = 200 };

static dds_entity_t make_writer(dds_entity_t participant) {
  const dds_entity_t topic =
      dds_create_topic(participant, &sealwatch_RawSamples_desc, "sealwatch/raw_samples", NULL, NULL);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(5));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(qos, false);
  const dds_entity_t writer = dds_create_writer(participant, topic, qos, NULL);
  dds_delete_qos(qos);
  return writer;
}

static int send_block(dds_entity_t writer, char* asset_id, int number, dds_time_t start) {
  double time_s[SAMPLES], position_m[SAMPLES];
  for (int k = 0; k < SAMPLES; ++k) {
    time_s[k] = number + k / 200.0; /* counts on over all blocks */
    position_m[k] = 0.060 - 1.33e-3 * time_s[k];
  }
  sealwatch_Series position = {.name = "position", .unit = "m"};
  position.values = (dds_sequence_double){._length = SAMPLES, ._buffer = position_m};

  sealwatch_RawSamples block = {.asset_id = asset_id, .source_id = "mcs", .recording_id = "2031-04-PST"};
  /* Strings must not be null pointers. */
  block.test_kind = block.content_hash = block.abort_reason = "";
  block.header.message_id = block.header.pst_id = block.header.producer = block.header.writer_id = "";
  block.block_number = (uint64_t)number;
  block.boundary = number == 0            ? sealwatch_BLOCK_BOUNDARY_BEGIN
                   : number == BLOCKS - 1 ? sealwatch_BLOCK_BOUNDARY_END
                                          : sealwatch_BLOCK_BOUNDARY_INSIDE;
  block.start_time_known = true;
  block.start_time_ns = start;
  block.samples.time_s = (dds_sequence_double){._length = SAMPLES, ._buffer = time_s};
  block.samples.channels = (dds_sequence_sealwatch_Series){._length = 1, ._buffer = &position};
  return dds_write(writer, &block);
}

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "usage: control_system ASSET_ID\n"), 2;
  const dds_entity_t participant = dds_create_participant(0, NULL, NULL);
  const dds_entity_t writer = make_writer(participant);
  if (writer < 0) return fprintf(stderr, "no writer: %s\n", dds_strretcode(writer)), 1;
  while (dds_get_matched_subscriptions(writer, NULL, 0) == 0) dds_sleepfor(DDS_MSECS(10));

  const dds_time_t start = dds_time();
  for (int number = 0; number < BLOCKS; ++number)
    if (send_block(writer, argv[1], number, start) < 0) return fprintf(stderr, "block %d was not sent\n", number), 1;
  dds_wait_for_acks(writer, DDS_SECS(5));
  dds_delete(participant);
}
