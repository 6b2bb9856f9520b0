/* What ranks must have in common in a call, and what they say where they have not. */
#ifndef PBF_COMMON_RANK_CALL_H
#define PBF_COMMON_RANK_CALL_H

#include <stdio.h>
#include <string.h>

#include <pbf/pbf_backend.h>

#include "common/collider_digest.h"
#include "common/digest.h"

/* Digests, and the call's name. */
struct rank_call {
  char call[32];
  uint64_t room; /* capacity and local capacity */
  uint64_t kind; /* variant, shares, and what else the backend names */
  uint64_t params, colliders, phases, particles, settings, arguments;
};

template <class Solver>
static rank_call rank_call_of(const Solver *s, const char *call, const void *arguments,
                              uint64_t bytes, const uint32_t room[2], uint64_t kind,
                              const pbf_collider *colliders) {
  rank_call mine;
  memset(&mine, 0, sizeof mine);
  snprintf(mine.call, sizeof mine.call, "%s", call);
  mine.room = digest(DIGEST_OF_NOTHING, room, 2 * sizeof *room);
  mine.kind = kind;
  mine.params = digest(DIGEST_OF_NOTHING, &s->params, sizeof s->params);
  mine.colliders = digest_of_colliders(s->collider_count, colliders);
  mine.phases = digest(DIGEST_OF_NOTHING, &s->phases, sizeof s->phases);
  mine.particles = s->ranks.particles;
  mine.settings = s->ranks.settings;
  mine.arguments = digest(DIGEST_OF_NOTHING, arguments, bytes);
  return mine;
}

/* What differs, or null. `kind`: what the backend's kind is of. */
static inline const char *differing_part(const rank_call &a, const rank_call &b, const char *kind) {
  if (a.room != b.room) return "desc.capacity, or local_capacity";
  if (a.kind != b.kind) return kind;
  if (a.params != b.params) return "the parameters";
  if (a.colliders != b.colliders) return "the colliders";
  if (a.phases != b.phases) return "the phases";
  if (a.particles != b.particles) return "the particles that were added, set or removed";
  if (a.settings != b.settings)
    return "emitters, drains, reservoirs, diffuse particles, snapshots or previous positions";
  if (memcmp(a.call, b.call, sizeof a.call) != 0) return "the call";
  return a.arguments != b.arguments ? "the arguments of the call, or the time" : nullptr;
}

#endif
