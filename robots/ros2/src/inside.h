// What Cyclone DDS knows, and its API neither tells nor takes. In C: headers from inside Cyclone
// DDS, which are no C++.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ddsi_sertype;

/// Whether `other` has acknowledged all that `ours` has told of its subscribers so far. Discovery
/// itself is reliable; Cyclone DDS knows this, but its API has no question for it.
/// @param any the type of a topic of ours, whichever
/// @param ours, other participants
bool have_announced_subscribers(const struct ddsi_sertype* any, const dds_guid_t* ours,
                                const dds_guid_t* other);

/// Lets a reliable reader have the first message that a writer of Fast DDS sends it, as readers of
/// Fast DDS do: it asks what there is. Cyclone DDS does not ask. It takes the first heartbeat that
/// it sees for the beginning, and drops what was sent before; but that with which Fast DDS begins
/// often comes before Cyclone DDS knows the writer, and the next one announces a first message, or
/// comes three seconds late.
/// @param any the type of a topic of ours, whichever
/// @return false while Cyclone DDS is connecting the two: to be called again
bool take_first_message(const struct ddsi_sertype* any, const dds_guid_t* writer,
                        const dds_guid_t* reader);

/// Lets a reliable writer of ours ask its readers at once what they have received. Cyclone DDS asks
/// every 100 ms.
void request_acknowledgements(const struct ddsi_sertype* any, const dds_guid_t* writer);

/// The number of the newest message that another participant's writer has announced, or begun to
/// send; 0: none, or the writer has gone. Best effort readers alone get no announcements.
int64_t newest_announced(const struct ddsi_sertype* any, const dds_guid_t* writer);

#ifdef __cplusplus
}
#endif
