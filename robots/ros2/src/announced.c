#include "announced.h"

#include <dds/ddsi/ddsi_domaingv.h>
#include <dds/ddsi/ddsi_entity.h>
// It needs the one before.
#include <dds/ddsi/ddsi_endpoint.h>
#include <dds/ddsi/ddsi_entity_index.h>
#include <dds/ddsi/ddsi_entity_match.h>
#include <dds/ddsi/q_rtps.h>
#include <dds/ddsi/q_thread.h>
#include <endian.h>
#include <string.h>

/// The API has the bytes that are sent, the inside the machine's numbers.
static ddsi_guid_t entity_of(const dds_guid_t* participant, uint32_t entity) {
  ddsi_guid_t guid;
  memcpy(guid.prefix.u, participant->v, sizeof guid.prefix.u);
  for (int i = 0; i < 3; ++i) {
    guid.prefix.u[i] = be32toh(guid.prefix.u[i]);
  }
  guid.entityid.u = entity;
  return guid;
}

/// A reader counts as having acknowledged all that was there when it was matched, until it really
/// has.
static bool has_acknowledged_all(struct ddsi_writer* writer, const ddsi_guid_t* reader) {
  ddsrt_mutex_lock(&writer->e.lock);
  const struct ddsi_wr_prd_match* match =
      ddsrt_avl_lookup(&ddsi_wr_readers_treedef, &writer->readers, reader);
  const bool all = match != NULL && match->assumed_in_sync && match->seq >= writer->seq;
  ddsrt_mutex_unlock(&writer->e.lock);
  return all;
}

bool have_announced_subscribers(const struct ddsi_sertype* any, const dds_guid_t* ours,
                                const dds_guid_t* other) {
  const ddsi_guid_t writer_guid = entity_of(ours, NN_ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER);
  const ddsi_guid_t reader_guid = entity_of(other, NN_ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER);
  const struct ddsi_domaingv* domain = ddsrt_atomic_ldvoidp(&any->gv);
  struct thread_state* thread = lookup_thread_state();
  thread_state_awake(thread, domain);  // until it sleeps, nothing that it may see is freed
  struct ddsi_writer* writer = entidx_lookup_writer_guid(domain->entity_index, &writer_guid);
  const bool acknowledged = writer != NULL && has_acknowledged_all(writer, &reader_guid);
  thread_state_asleep(thread);
  return acknowledged;
}
