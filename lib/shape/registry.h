/* The shapes that live, and the references that keep them. */
#ifndef PBF_LIB_SHAPE_REGISTRY_H
#define PBF_LIB_SHAPE_REGISTRY_H

#include <pbf/pbf_backend.h>
#include <pbf/shapes.h>

typedef struct pbf_live_shape {
  pbf_shape shape; /* the handle: what backends see */
  struct pbf_live_shape *next;
  uint32_t references;
  uint64_t bytes;
  float values[];
} pbf_live_shape;

/* Memory for a shape of so many nodes, zeros but for what is passed; no handle yet. Null: there is
 * none. Given back by free, until it is published. */
pbf_live_shape *pbf_shape_allocate(uint32_t dimension, const uint32_t size[3]);

uint64_t pbf_shape_nodes(const uint32_t size[3]);

/* Makes the handle valid, with one reference: the caller's. */
pbf_shape *pbf_shape_publish(pbf_live_shape *shape);

/* One more reference. Fails for what is no live shape; `label` is what the message calls it. */
pbf_status pbf_shape_hold(pbf_shape *shape, const char *label);

/* … to one with this hash, as far as a pointer has bits for it; null where none lives. */
pbf_shape *pbf_shape_hold_by_hash(uint64_t hash);

/* Of a shape that the caller holds. */
uint64_t pbf_shape_hash(const pbf_shape *shape);

void pbf_shape_let_go(pbf_shape *shape);

#endif
