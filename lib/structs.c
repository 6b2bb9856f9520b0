#include "structs.h"

#include <string.h>

#include "check.h"
#include "error.h"

/* Far above any struct to come: a larger size is uninitialised memory. */
enum { MAX_SIZE = 65536 };

#define THROUGH(type, last) (offsetof(type, last) + sizeof(((type *)0)->last))
#define KIND(type, argument, last) \
  { #type, argument, sizeof(type), THROUGH(type, last) }

/* The second argument is the last member of the first release and stays so for good. */
const pbf_struct_kind pbf_kind_ranks = KIND(pbf_ranks, "ranks", shares);
const pbf_struct_kind pbf_kind_allocator = KIND(pbf_allocator, "allocator", release);
const pbf_struct_kind pbf_kind_desc = KIND(pbf_desc, "desc", log_user);
const pbf_struct_kind pbf_kind_params = KIND(pbf_params, "params", search_cell_width);
const pbf_struct_kind pbf_kind_collider = KIND(pbf_collider, "collider", half_length);
const pbf_struct_kind pbf_kind_grid_desc = KIND(pbf_grid_desc, "grid", values);
const pbf_struct_kind pbf_kind_mesh_desc = KIND(pbf_mesh_desc, "mesh", thickness);
const pbf_struct_kind pbf_kind_heights_desc = KIND(pbf_heights_desc, "heights", cell);
const pbf_struct_kind pbf_kind_hull_desc = KIND(pbf_hull_desc, "hull", cell);
const pbf_struct_kind pbf_kind_shape_info = KIND(pbf_shape_info, "info", hash);
const pbf_struct_kind pbf_kind_collider_load = KIND(pbf_collider_load, "loads", wetted_area);
const pbf_struct_kind pbf_kind_view = KIND(pbf_view, "view", ids);
const pbf_struct_kind pbf_kind_read_desc = KIND(pbf_read_desc, "read", w_value);
const pbf_struct_kind pbf_kind_write_desc = KIND(pbf_write_desc, "write", stream);
const pbf_struct_kind pbf_kind_anisotropy_desc = KIND(pbf_anisotropy_desc, "anisotropy", stretches);
const pbf_struct_kind pbf_kind_snapshot = KIND(pbf_snapshot, "snapshot", owner);
const pbf_struct_kind pbf_kind_stats = KIND(pbf_stats, "stats", density_mean);
const pbf_struct_kind pbf_kind_timings = KIND(pbf_timings, "timings", stages);
const pbf_struct_kind pbf_kind_plan = KIND(pbf_plan, "plan", arrays);
const pbf_struct_kind pbf_kind_info = KIND(pbf_info, "info", fallback_reason);
const pbf_struct_kind pbf_kind_backend_info = KIND(pbf_backend_info, "info", reason);
const pbf_struct_kind pbf_kind_batch_info = KIND(pbf_batch_info, "info", device_type);
const pbf_struct_kind pbf_kind_volume = KIND(pbf_volume, "volume", half_length);
const pbf_struct_kind pbf_kind_volume_flow = KIND(pbf_volume_flow, "flows", velocity);
const pbf_struct_kind pbf_kind_samples = KIND(pbf_samples, "samples", wet);
const pbf_struct_kind pbf_kind_sample_grid = KIND(pbf_sample_grid, "grid", step);
const pbf_struct_kind pbf_kind_emitter = KIND(pbf_emitter, "emitter", lifetime);
const pbf_struct_kind pbf_kind_reservoir = KIND(pbf_reservoir, "reservoir", removed);
const pbf_struct_kind pbf_kind_in_out = KIND(pbf_in_out, "in_out", expired);
const pbf_struct_kind pbf_kind_phase = KIND(pbf_phase, "phase", viscosity);
const pbf_struct_kind pbf_kind_diffuse_desc = KIND(pbf_diffuse_desc, "desc", scatter);
const pbf_struct_kind pbf_kind_diffuse_info = KIND(pbf_diffuse_info, "info", recycled);
const pbf_struct_kind pbf_kind_diffuse_read = KIND(pbf_diffuse_read, "read", ids);

pbf_status pbf_struct_check_size(const pbf_struct_kind *kind, uint32_t size) {
  if (size >= kind->first_size && size <= MAX_SIZE) return PBF_OK;
  return pbf_fail(PBF_ERROR_STRUCT_SIZE, "%s.struct_size is %u; it must be sizeof(%s), here %u",
                  kind->name, size, kind->name, kind->size);
}

uint32_t pbf_struct_size(const void *theirs) {
  uint32_t size;
  memcpy(&size, theirs, sizeof size);
  return size;
}

static pbf_status fail_on_null(const pbf_struct_kind *kind) {
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null; it must point to a %s", kind->argument,
                  kind->name);
}

pbf_status pbf_struct_check_out(const pbf_struct_kind *kind, const void *theirs) {
  if (!theirs) return fail_on_null(kind);
  return pbf_struct_check_size(kind, pbf_struct_size(theirs));
}

/* Bytes beyond those that are known, which have to be 0. */
static pbf_status check_rest(const pbf_struct_kind *kind, const unsigned char *bytes,
                             uint32_t size) {
  for (uint32_t i = kind->size; i < size; ++i) {
    if (!bytes[i]) continue;
    return pbf_fail(PBF_ERROR_STRUCT_SIZE,
                    "byte %u of a %s of %u bytes is %u; this library knows the first %u bytes "
                    "only, so the rest must be 0",
                    i, kind->name, size, bytes[i], kind->size);
  }
  return PBF_OK;
}

pbf_status pbf_struct_in_sized(const pbf_struct_kind *kind, const void *theirs, uint32_t size,
                               void *ours) {
  pbf_status status = pbf_struct_check_size(kind, size);
  if (status == PBF_OK) status = check_rest(kind, theirs, size);
  if (status != PBF_OK) return status;
  const uint32_t common = size < kind->size ? size : kind->size;
  memcpy(ours, theirs, common);
  memset((unsigned char *)ours + common, 0, kind->size - common);
  memcpy(ours, &kind->size, sizeof kind->size);
  return PBF_OK;
}

pbf_status pbf_struct_in(const pbf_struct_kind *kind, const void *theirs, void *ours) {
  if (!theirs) return fail_on_null(kind);
  return pbf_struct_in_sized(kind, theirs, pbf_struct_size(theirs), ours);
}

pbf_status pbf_struct_in_array(const pbf_struct_kind *kind, const char *name, const void *theirs,
                               uint32_t first, uint32_t index, void *ours) {
  const unsigned char *one = (const unsigned char *)theirs + (uint64_t)index * first;
  const uint32_t size = pbf_struct_size(one);
  if (size == first) return pbf_struct_in_sized(kind, one, size, ours);
  return pbf_fail(PBF_ERROR_STRUCT_SIZE, "%s[%u].struct_size is %u; it must be that of %s[0], %u",
                  name, index, size, name, first);
}

pbf_status pbf_struct_in_stored(const pbf_struct_kind *kind, const void *stored, uint32_t size,
                                void *ours) {
  if (size < sizeof(uint32_t) || pbf_struct_size(stored) != size)
    return pbf_fail(PBF_ERROR_DATA,
                    "the saved state contradicts itself in the size of a struct; pbf_load takes "
                    "what pbf_save wrote");
  return pbf_struct_in_sized(kind, stored, size, ours);
}

void pbf_struct_out(const pbf_struct_kind *kind, const void *ours, void *theirs, uint32_t size) {
  uint32_t common = size < kind->size ? size : kind->size;
  memcpy(theirs, ours, common);
  memset((unsigned char *)theirs + common, 0, size - common);
  memcpy(theirs, &size, sizeof size);
}

pbf_status pbf_count_out(uint32_t number, uint32_t *count) {
  const pbf_status status = pbf_check_pointer("count", count, sizeof *count);
  if (status == PBF_OK) *count = number;
  return status;
}
