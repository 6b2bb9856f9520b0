/* Size-first structs across the boundary: what an older or a newer caller may pass. */
#ifndef PBF_LIB_STRUCTS_H
#define PBF_LIB_STRUCTS_H

#include <stddef.h>

#include <pbf/batch.h>
#include <pbf/diffuse.h>
#include <pbf/emit.h>
#include <pbf/phases.h>
#include <pbf/ranks.h>
#include <pbf/shapes.h>

/* One kind of public struct. `first_size` is what the first release had: no caller has less. */
typedef struct pbf_struct_kind {
  const char *name;
  const char *argument; /* what functions call one */
  uint32_t size;
  uint32_t first_size;
} pbf_struct_kind;

extern const pbf_struct_kind pbf_kind_ranks;
extern const pbf_struct_kind pbf_kind_allocator;
extern const pbf_struct_kind pbf_kind_desc;
extern const pbf_struct_kind pbf_kind_params;
extern const pbf_struct_kind pbf_kind_collider;
extern const pbf_struct_kind pbf_kind_grid_desc;
extern const pbf_struct_kind pbf_kind_mesh_desc;
extern const pbf_struct_kind pbf_kind_heights_desc;
extern const pbf_struct_kind pbf_kind_hull_desc;
extern const pbf_struct_kind pbf_kind_shape_info;
extern const pbf_struct_kind pbf_kind_collider_load;
extern const pbf_struct_kind pbf_kind_view;
extern const pbf_struct_kind pbf_kind_read_desc;
extern const pbf_struct_kind pbf_kind_write_desc;
extern const pbf_struct_kind pbf_kind_anisotropy_desc;
extern const pbf_struct_kind pbf_kind_snapshot;
extern const pbf_struct_kind pbf_kind_stats;
extern const pbf_struct_kind pbf_kind_timings;
extern const pbf_struct_kind pbf_kind_plan;
extern const pbf_struct_kind pbf_kind_info;
extern const pbf_struct_kind pbf_kind_backend_info;
extern const pbf_struct_kind pbf_kind_batch_info;
extern const pbf_struct_kind pbf_kind_volume;
extern const pbf_struct_kind pbf_kind_volume_flow;
extern const pbf_struct_kind pbf_kind_samples;
extern const pbf_struct_kind pbf_kind_sample_grid;
extern const pbf_struct_kind pbf_kind_emitter;
extern const pbf_struct_kind pbf_kind_in_out;
extern const pbf_struct_kind pbf_kind_reservoir;
extern const pbf_struct_kind pbf_kind_phase;
extern const pbf_struct_kind pbf_kind_diffuse_desc;
extern const pbf_struct_kind pbf_kind_diffuse_info;
extern const pbf_struct_kind pbf_kind_diffuse_read;

/* Fails unless `size` is one that a caller of this kind can have. */
pbf_status pbf_struct_check_size(const pbf_struct_kind *kind, uint32_t size);

/* Copies a caller's struct of its own size into one of ours; what it lacks becomes zero. */
pbf_status pbf_struct_in(const pbf_struct_kind *kind, const void *theirs, void *ours);

/* The same where its size has been read: it is not read again, so that no more than `size` bytes
 * are looked at even if another process or thread writes to that memory meanwhile. */
pbf_status pbf_struct_in_sized(const pbf_struct_kind *kind, const void *theirs, uint32_t size,
                               void *ours);

/* The same of a saved state, which says once more, in another place, what size it has. */
pbf_status pbf_struct_in_stored(const pbf_struct_kind *kind, const void *stored, uint32_t size,
                                void *ours);

/* Struct `index` of a caller's array, which messages call `name`: all have the size of the first,
 * `first`, which the caller of this has read once, since another thread may write there. */
pbf_status pbf_struct_in_array(const pbf_struct_kind *kind, const char *name, const void *theirs,
                               uint32_t first, uint32_t index, void *ours);

/* Gives a caller a number; fails where `count` is null. */
pbf_status pbf_count_out(uint32_t number, uint32_t *count);

/* The caller's struct as an output: not null, with a usable struct_size. */
pbf_status pbf_struct_check_out(const pbf_struct_kind *kind, const void *theirs);

/* Copies ours out as far as `size` reaches, zeros beyond it; struct_size becomes `size`. */
void pbf_struct_out(const pbf_struct_kind *kind, const void *ours, void *theirs, uint32_t size);

/* The size that a caller's checked struct states. */
uint32_t pbf_struct_size(const void *theirs);

#endif
