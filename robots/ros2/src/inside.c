#include "inside.h"

#include <dds/ddsi/ddsi_domaingv.h>
#include <dds/ddsi/ddsi_entity.h>
// It needs the one before.
#include <dds/ddsi/ddsi_endpoint.h>
#include <dds/ddsi/ddsi_entity_index.h>
#include <dds/ddsi/ddsi_entity_match.h>
#include <dds/ddsi/ddsi_proxy_endpoint.h>
#include <dds/ddsi/q_addrset.h>
#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_rtps.h>
#include <dds/ddsi/q_thread.h>
#include <dds/ddsi/q_xevent.h>
#include <endian.h>
#include <string.h>

/// The API has the bytes that are sent, the inside the machine's numbers.
static ddsi_guid_t inside_guid(const dds_guid_t* sent) {
  uint32_t words[4];
  memcpy(words, sent->v, sizeof words);
  ddsi_guid_t guid;
  for (int i = 0; i < 3; ++i) {
    guid.prefix.u[i] = be32toh(words[i]);
  }
  guid.entityid.u = be32toh(words[3]);
  return guid;
}

static ddsi_guid_t entity_of(const dds_guid_t* participant, uint32_t entity) {
  ddsi_guid_t guid = inside_guid(participant);
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

/// Until this thread sleeps, nothing that it may see is freed.
static struct ddsi_domaingv* wake(const struct ddsi_sertype* any) {
  struct ddsi_domaingv* domain = ddsrt_atomic_ldvoidp(&any->gv);
  thread_state_awake(lookup_thread_state(), domain);
  return domain;
}

static void sleep_again(void) {
  thread_state_asleep(lookup_thread_state());
}

bool have_announced_subscribers(const struct ddsi_sertype* any, const dds_guid_t* ours,
                                const dds_guid_t* other) {
  const ddsi_guid_t writer_guid = entity_of(ours, NN_ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER);
  const ddsi_guid_t reader_guid = entity_of(other, NN_ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER);
  struct ddsi_writer* writer =
      entidx_lookup_writer_guid(wake(any)->entity_index, &writer_guid);
  const bool acknowledged = writer != NULL && has_acknowledged_all(writer, &reader_guid);
  sleep_again();
  return acknowledged;
}

/// "Acknowledges nothing, and wants an answer" (RTPS 2.1, 8.3.7.1): Fast DDS answers number 0 by a
/// heartbeat. All of it in bytes as they are sent.
struct question {
  uint8_t header[8], from[12];
  uint8_t to_head[4], to[12];
  uint8_t acknack_head[4], reader[4], writer[4];
  uint32_t nothing[3];
  uint32_t count;
};

static struct question question_of(const dds_guid_t* writer, const dds_guid_t* reader,
                                   nn_count_t count) {
  struct question question = {.header = {'R', 'T', 'P', 'S', 2, 1, 1, NN_VENDORID_MINOR_ECLIPSE},
                              .to_head = {SMID_INFO_DST, SMFLAG_ENDIANNESS, 12},
                              .acknack_head = {SMID_ACKNACK, SMFLAG_ENDIANNESS, 24},
                              .count = htole32(count)};
  memcpy(question.from, reader->v, sizeof question.from);
  memcpy(question.to, writer->v, sizeof question.to);
  memcpy(question.reader, reader->v + 12, sizeof question.reader);
  memcpy(question.writer, writer->v + 12, sizeof question.writer);
  return question;
}

static void send_to(const ddsi_xlocator_t* address, void* question) {
  const ddsrt_iovec_t bytes = {.iov_base = question, .iov_len = sizeof(struct question)};
  ddsi_conn_write(address->conn, &address->c, 1, &bytes, 0);
}

bool take_first_message(const struct ddsi_sertype* any, const dds_guid_t* writer,
                        const dds_guid_t* reader) {
  const ddsi_guid_t writer_guid = inside_guid(writer);
  const ddsi_guid_t reader_guid = inside_guid(reader);
  bool done = true;
  struct ddsi_proxy_writer* proxy =
      entidx_lookup_proxy_writer_guid(wake(any)->entity_index, &writer_guid);
  if (proxy != NULL && vendor_is_eprosima(proxy->c.vendor)) {
    ddsrt_mutex_lock(&proxy->e.lock);
    struct ddsi_pwr_rd_match* match =
        ddsrt_avl_lookup(&ddsi_pwr_readers_treedef, &proxy->readers, &reader_guid);
    done = !proxy->local_matching_inprogress;
    if (done && match != NULL && match->acknack_xevent != NULL) {
      proxy->have_seen_heartbeat = 1;
      struct question question = question_of(writer, reader, ++match->count);
      addrset_forall(proxy->c.as, send_to, &question);
    }
    ddsrt_mutex_unlock(&proxy->e.lock);
  }
  sleep_again();
  return done;
}

void request_acknowledgements(const struct ddsi_sertype* any, const dds_guid_t* writer) {
  const ddsi_guid_t guid = inside_guid(writer);
  struct ddsi_writer* found = entidx_lookup_writer_guid(wake(any)->entity_index, &guid);
  if (found != NULL && found->heartbeat_xevent != NULL) {
    ddsrt_mutex_lock(&found->e.lock);
    // As if all that were long ago: the next heartbeat is due, and asks for an answer.
    found->hbcontrol.t_of_last_write.v = 0;
    found->hbcontrol.t_of_last_hb.v = 0;
    found->hbcontrol.t_of_last_ackhb.v = 0;
    ddsrt_mutex_unlock(&found->e.lock);
    resched_xevent_if_earlier(found->heartbeat_xevent, ddsrt_time_monotonic());
  }
  sleep_again();
}

int64_t newest_announced(const struct ddsi_sertype* any, const dds_guid_t* writer) {
  const ddsi_guid_t guid = inside_guid(writer);
  struct ddsi_proxy_writer* proxy = entidx_lookup_proxy_writer_guid(wake(any)->entity_index, &guid);
  int64_t newest = 0;
  if (proxy != NULL) {
    ddsrt_mutex_lock(&proxy->e.lock);
    newest = (int64_t)proxy->last_seq;
    ddsrt_mutex_unlock(&proxy->e.lock);
  }
  sleep_again();
  return newest;
}
