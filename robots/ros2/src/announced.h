// Whether another participant knows what we subscribe to. In C: headers from inside Cyclone DDS,
// which are no C++.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>

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

#ifdef __cplusplus
}
#endif
