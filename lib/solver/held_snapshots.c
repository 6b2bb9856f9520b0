#include "held_snapshots.h"

#include <stddef.h>
#include <stdint.h>

enum { BUCKET_BITS = 8, BUCKETS = 1 << BUCKET_BITS };

static snapshot *buckets[BUCKETS];

static snapshot **bucket_of(const void *owner) {
  const uint32_t mixed = (uint32_t)((uintptr_t)owner / 8) * 2654435761u; /* Knuth's hash */
  return &buckets[mixed >> (32 - BUCKET_BITS)];
}

/* The pointer in the list that leads to it, or the list's last one. */
static snapshot **find(const void *owner) {
  snapshot **link = bucket_of(owner);
  while (*link && *link != owner) link = &(*link)->next_held;
  return link;
}

/* In an order in which the child of a fork may find any part of it done. */
void pbf_snapshot_hold(snapshot *one) {
  if (!*find(one)) {
    one->next_held = *bucket_of(one);
    *bucket_of(one) = one;
  }
  ++one->readers;
}

pbf_solver *pbf_snapshot_let_go(const void *owner) {
  snapshot **link = find(owner), *held = *link;
  if (!held) return NULL;
  if (--held->readers == 0) *link = held->next_held;
  return held->solver;
}

void pbf_snapshot_forget(const snapshot *one) {
  snapshot **link = find(one);
  if (*link) *link = one->next_held;
}
