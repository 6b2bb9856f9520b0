/* Shapes as bytes, for files: what has been baked once is not baked again. */
#include <inttypes.h>
#include <string.h>

#include "common/fp_environment.h"
#include "check.h"
#include "error.h"
#include "grid.h"
#include "lock.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "saved shapes are little-endian");

static const char shape_mark[8] = {'P', 'B', 'F', 'S', 'H', 'A', 'P', 'E'};
enum { FORMAT = 1 };

/* The distances follow it, x fastest. */
typedef struct saved_header {
  char mark[8];
  uint32_t format;
  uint32_t dimension;
  uint32_t nodes[3]; /* 2D: the third is 1 */
  uint32_t reserved;
  double origin[3];
  double cell;
  uint64_t hash; /* of pbf_shape_info */
} saved_header;

_Static_assert(sizeof(saved_header) == 72, "docs/shapes.md says where its members lie");

static saved_header header_of(const pbf_shape *s) {
  saved_header header = {
      .format = FORMAT, .dimension = s->dimension, .cell = s->cell, .hash = pbf_shape_hash(s)};
  memcpy(header.mark, shape_mark, sizeof shape_mark);
  memcpy(header.nodes, s->nodes, sizeof header.nodes);
  memcpy(header.origin, s->origin, sizeof header.origin);
  return header;
}

static uint64_t bytes_of(const uint32_t nodes[3]) { return pbf_shape_nodes(nodes) * sizeof(float); }

static pbf_status save(const pbf_shape *s, void *buffer, uint64_t *size) {
  const saved_header header = header_of(s);
  const uint64_t needed = sizeof header + bytes_of(s->nodes);
  if (buffer && *size < needed) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "*size is %" PRIu64 "; the shape needs %" PRIu64,
                    *size, needed);
  }
  *size = needed;
  if (!buffer) return PBF_OK;
  memcpy(buffer, &header, sizeof header);
  memcpy((unsigned char *)buffer + sizeof header, s->values, bytes_of(s->nodes));
  return PBF_OK;
}

pbf_status pbf_save_shape(pbf_shape *shape, void *buffer, uint64_t *size) {
  pbf_status status = pbf_lock_check();
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("size", size, sizeof *size);
  if (status == PBF_OK) status = pbf_shape_hold(shape, "shape");
  if (status != PBF_OK) return status;
  status = save(shape, buffer, size);
  pbf_shape_let_go(shape);
  return status;
}

pbf_status pbf_get_shape_values(pbf_shape *shape, uint64_t count, float *values) {
  pbf_status status = pbf_lock_check();
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("values", values, sizeof *values);
  if (status == PBF_OK) status = pbf_shape_hold(shape, "shape");
  if (status != PBF_OK) return status;
  const uint64_t nodes = pbf_shape_nodes(shape->nodes);
  if (count == nodes)
    memcpy(values, shape->values, nodes * sizeof *values);
  else
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "count is %" PRIu64 "; the shape has %" PRIu64 " nodes", count, nodes);
  pbf_shape_let_go(shape);
  return status;
}

/* ---- Loading -------------------------------------------------------------------------------- */

static pbf_status check_header(const saved_header *header, uint64_t size) {
  if (memcmp(header->mark, shape_mark, sizeof shape_mark) != 0)
    return pbf_fail(PBF_ERROR_DATA,
                    "the saved shape does not begin as one; pbf_load_shape takes what "
                    "pbf_save_shape or pbf-bake wrote");
  if (header->format != FORMAT) {
    return pbf_fail(PBF_ERROR_DATA, "the saved shape has format %u; this library reads format %d",
                    header->format, FORMAT);
  }
  const int flat = header->dimension == 2;
  pbf_status status = pbf_shape_check_size("the saved shape", header->dimension, header->nodes);
  if (status == PBF_OK)
    status =
        pbf_shape_check_place("the saved shape", header->dimension, header->origin, header->cell);
  if (status != PBF_OK) return PBF_ERROR_DATA;
  if (header->reserved != 0 || (flat && header->nodes[2] != 1))
    return pbf_fail(PBF_ERROR_DATA,
                    "the saved shape is damaged: its header has what it can't have");
  const uint64_t wanted = sizeof *header + bytes_of(header->nodes);
  if (size == wanted) return PBF_OK;
  return pbf_fail(PBF_ERROR_DATA,
                  "the saved shape has %" PRIu64 " bytes; by its header it has %" PRIu64, size,
                  wanted);
}

static pbf_status load(const saved_header *header, const void *values, pbf_shape **shape) {
  pbf_shape *loaded = NULL;
  pbf_live_shape *made = pbf_shape_allocate(header->dimension, header->nodes);
  if (!made) {
    return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for a shape of %" PRIu64 " nodes",
                    pbf_shape_nodes(header->nodes));
  }
  memcpy(made->shape.origin, header->origin,
         sizeof header->origin); /* the hash is over all three */
  made->shape.cell = header->cell;
  memcpy(made->values, values, bytes_of(header->nodes));
  if (pbf_shape_finish(made, "the saved shape's distances", &loaded) != PBF_OK)
    return PBF_ERROR_DATA;
  if (pbf_shape_hash(loaded) == header->hash) {
    *shape = loaded;
    return PBF_OK;
  }
  pbf_shape_let_go(loaded);
  return pbf_fail(PBF_ERROR_DATA, "the saved shape is damaged: its content has another hash");
}

pbf_status pbf_load_shape(const void *buffer, uint64_t size, pbf_shape **shape) {
  saved_header header;
  pbf_status status = pbf_lock_check();
  if (status != PBF_OK) return status;
  if (!buffer || !shape)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", buffer ? "shape" : "buffer");
  if (size < sizeof header) {
    return pbf_fail(PBF_ERROR_DATA, "the saved shape is cut short: it has %" PRIu64 " bytes", size);
  }
  memcpy(&header, buffer, sizeof header);
  const pbf_fp_environment before = pbf_fp_begin();
  status = check_header(&header, size);
  if (status == PBF_OK)
    status = load(&header, (const unsigned char *)buffer + sizeof header, shape);
  pbf_fp_end(before);
  return status;
}
