/* Layout of a saved state, little-endian, every section at a multiple of 8 bytes:
 *   header | parameters | colliders | which of those behind the first 64 have been placed, and
 *   which have been shifted alike | ids, unless they are 0 … count - 1 | positions | velocities |
 *   what the backend keeps of each particle in some scenes (kept.h) | emitters, drains, lifetimes,
 *   if any | phases, if any | spray,
 *   foam and bubbles, if any | accelerations, if any | checksum.h's checksum of all before it
 * Structs are stored as they are in memory, with their sizes, by the same rules as across the API.
 */
#ifndef PBF_LIB_STATE_SNAPSHOT_H
#define PBF_LIB_STATE_SNAPSHOT_H

#include "kept.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "a saved state is little-endian, as is the memory it is copied from");

/* Eight characters, without an end. */
#define PBF_SNAPSHOT_MAGIC \
  { 'P', 'B', 'F', 'S', 'T', 'A', 'T', 'E' }

enum { PBF_SNAPSHOT_VERSION = 12 };

typedef struct pbf_snapshot_header {
  char magic[8];
  uint32_t version;
  uint32_t header_size;
  uint32_t dimension;
  uint32_t precision;
  uint32_t params_size;
  uint32_t collider_size;
  uint32_t collider_count;
  uint32_t count;
  uint32_t has_ids;
  uint32_t kept; /* a bit for each pbf_kept */
  uint32_t planned;
  uint32_t emission; /* bytes of what comes and goes, or 0 */
  uint64_t next_id;
  uint64_t step;
  uint64_t steps_since;
  double time_base;
  double collider_time;
  pbf_overlap_state overlap;
  pbf_placement placement;
  uint64_t phases;             /* bytes of them, or 0 */
  uint64_t diffuse;            /* bytes of spray, foam and bubbles, or 0 */
  uint32_t has_accelerations;  /* of particles, … */
  uint32_t acceleration_count; /* … which so many of the first rows were given */
  uint64_t size;               /* of everything */
} pbf_snapshot_header;

/* Where the sections begin. */
typedef struct pbf_snapshot_layout {
  uint64_t params, colliders, marks, ids, positions, velocities, kept[PBF_KEPT_COUNT], emission,
      phases, diffuse, accelerations, checksum, size;
} pbf_snapshot_layout;

pbf_snapshot_layout pbf_snapshot_layout_of(const pbf_snapshot_header *header);

/* Bytes of positions, and as many of velocities. */
uint64_t pbf_snapshot_field_bytes(const pbf_snapshot_header *header);

uint64_t pbf_snapshot_acceleration_bytes(const pbf_snapshot_header *header);

/* Bytes of what a backend keeps of this kind, or 0. */
uint64_t pbf_snapshot_kept_bytes(const pbf_snapshot_header *header, pbf_kept kept);

#endif
