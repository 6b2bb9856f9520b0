/* The public API, a row for each function, and the faults that are not a call of it. */
#ifndef PBF_TESTS_SOAK_TABLE_H
#define PBF_TESTS_SOAK_TABLE_H

#include "actor.h"

typedef struct entry {
  const char *name; /* of a function of the API; a fault's has a space */
  uint32_t weight;  /* how often it is drawn */
  void (*make)(actor *a);
} entry;

extern const entry table[];
extern const uint32_t table_size;

/* Makes call number a->call. */
void make_call(actor *a);

/* ---- Rows, by what they are about ---- */

void call_version(actor *a);
void call_status_string(actor *a);
void call_last_error(actor *a);
void call_desc_init(actor *a);
void call_params_init(actor *a);
void call_collider_init(actor *a);
void call_create(actor *a);
void call_create_on_ranks(actor *a);
void call_destroy(actor *a);
void call_get_backend_count(actor *a);
void call_get_backend_info(actor *a);
void call_load_backend(actor *a);

void call_set_params(actor *a);
void call_get_params(actor *a);
void call_set_colliders(actor *a);
void call_move_colliders(actor *a);
void call_get_collider_count(actor *a);
void call_get_collider(actor *a);
void call_get_collider_loads(actor *a);
void call_get_wall_loads(actor *a);
void call_set_timing(actor *a);
void call_get_timings(actor *a);
void call_get_plan(actor *a);
void call_get_info(actor *a);
void call_get_stats(actor *a);
void call_get_step_limit(actor *a);

void call_step(actor *a);
void call_begin_step(actor *a);
void call_end_step(actor *a);
void call_cancel(actor *a);
void call_synchronize(actor *a);

void call_get_count(actor *a);
void call_add_particles(actor *a);
void call_remove_particles(actor *a);
void call_remove_in_box(actor *a);
void call_find_in_box(actor *a);
void call_get_positions(actor *a);
void call_set_positions(actor *a);
void call_get_velocities(actor *a);
void call_get_share(actor *a);
void call_set_velocities(actor *a);
void call_write(actor *a);
void call_set_accelerations(actor *a);
void call_phase_init(actor *a);
void call_set_phases(actor *a);
void call_get_phase_count(actor *a);
void call_get_phase(actor *a);
void call_set_particle_phases(actor *a);
void call_get_particle_phases(actor *a);
void call_get_ids(actor *a);
void call_get_densities(actor *a);
void call_get_pressures(actor *a);
void call_read(actor *a);
void call_get_anisotropies(actor *a);
void call_keep_previous(actor *a);

void call_volume_init(actor *a);
void call_find_in_volume(actor *a);
void call_measure_volumes(actor *a);
void call_sample(actor *a);
void call_sample_on_grid(actor *a);
void call_cast_rays(actor *a);
void call_get_levels(actor *a);
void call_end_queries(actor *a);

void call_emitter_init(actor *a);
void call_set_emitters(actor *a);
void call_get_emitter(actor *a);
void call_set_drains(actor *a);
void call_get_drain(actor *a);
void call_reservoir_init(actor *a);
void call_set_reservoirs(actor *a);
void call_get_reservoir(actor *a);
void call_get_reservoir_count(actor *a);
void call_get_in_out(actor *a);

void call_diffuse_init(actor *a);
void call_set_diffuse(actor *a);
void call_get_diffuse(actor *a);
void call_get_diffuse_info(actor *a);
void call_read_diffuse(actor *a);
void call_add_diffuse(actor *a);
void call_shift_diffuse(actor *a);

void call_map(actor *a);
void call_unmap(actor *a);
void call_export_dlpack(actor *a);
void call_set_snapshots(actor *a);
void call_acquire_snapshot(actor *a);
void call_release_snapshot(actor *a);
void call_save(actor *a);
void call_load(actor *a);
void call_hash(actor *a);

void call_shape_from_grid(actor *a);
void call_shape_from_mesh(actor *a);
void call_shape_from_heights(actor *a);
void call_shape_from_points(actor *a);
void call_hold_shape(actor *a);
void call_release_shape(actor *a);
void call_get_shape_info(actor *a);
void call_get_shape_distance(actor *a);
void call_get_shape_values(actor *a);
void call_load_shape(actor *a);
void call_save_shape(actor *a);

void call_batch_create(actor *a);
void call_batch_destroy(actor *a);
void call_batch_get_info(actor *a);
void call_batch_get_world(actor *a);
void call_batch_get_statuses(actor *a);
void call_batch_get_sentence(actor *a);
void call_batch_step(actor *a);
void call_batch_set_start(actor *a);
void call_batch_reset(actor *a);
void call_batch_set_gravity(actor *a);
void call_batch_set_colliders(actor *a);
void call_batch_move_colliders(actor *a);
void call_batch_add_particles(actor *a);
void call_batch_get_counts(actor *a);
void call_batch_read(actor *a);
void call_batch_export_dlpack(actor *a);

void fault_fork(actor *a);
void fault_kill(actor *a);
void fault_callback(actor *a);
void fault_arguments(actor *a);

#endif
