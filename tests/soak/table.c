#include "table.h"

const entry table[] = {
    {"pbf_version", 1, call_version},
    {"pbf_status_string", 1, call_status_string},
    {"pbf_last_error", 1, call_last_error},
    {"pbf_desc_init", 1, call_desc_init},
    {"pbf_params_init", 1, call_params_init},
    {"pbf_collider_init", 1, call_collider_init},
    {"pbf_create", 2, call_create},
    {"pbf_create_on_ranks", 1, call_create_on_ranks},
    {"pbf_destroy", 1, call_destroy},
    {"pbf_get_backend_count", 1, call_get_backend_count},
    {"pbf_get_backend_info", 1, call_get_backend_info},
    {"pbf_load_backend", 1, call_load_backend},
    {"pbf_set_params", 12, call_set_params},
    {"pbf_get_params", 1, call_get_params},
    {"pbf_set_colliders", 5, call_set_colliders},
    {"pbf_move_colliders", 3, call_move_colliders},
    {"pbf_get_collider_count", 1, call_get_collider_count},
    {"pbf_get_collider", 2, call_get_collider},
    {"pbf_shape_from_grid", 1, call_shape_from_grid},
    {"pbf_shape_from_mesh", 1, call_shape_from_mesh},
    {"pbf_shape_from_heights", 1, call_shape_from_heights},
    {"pbf_shape_from_points", 1, call_shape_from_points},
    {"pbf_hold_shape", 1, call_hold_shape},
    {"pbf_release_shape", 1, call_release_shape},
    {"pbf_get_shape_info", 1, call_get_shape_info},
    {"pbf_get_shape_distance", 1, call_get_shape_distance},
    {"pbf_get_shape_values", 1, call_get_shape_values},
    {"pbf_load_shape", 1, call_load_shape},
    {"pbf_save_shape", 1, call_save_shape},
    {"pbf_get_collider_loads", 1, call_get_collider_loads},
    {"pbf_get_wall_loads", 1, call_get_wall_loads},
    {"pbf_set_timing", 1, call_set_timing},
    {"pbf_get_timings", 1, call_get_timings},
    {"pbf_get_plan", 1, call_get_plan},
    {"pbf_get_info", 1, call_get_info},
    {"pbf_get_stats", 2, call_get_stats},
    {"pbf_get_step_limit", 1, call_get_step_limit},
    {"pbf_step", 30, call_step},
    {"pbf_begin_step", 6, call_begin_step},
    {"pbf_end_step", 1, call_end_step},
    {"pbf_cancel", 2, call_cancel},
    {"pbf_synchronize", 1, call_synchronize},
    {"pbf_get_count", 1, call_get_count},
    {"pbf_add_particles", 16, call_add_particles},
    {"pbf_remove_particles", 3, call_remove_particles},
    {"pbf_remove_in_box", 2, call_remove_in_box},
    {"pbf_find_in_box", 2, call_find_in_box},
    {"pbf_get_positions", 1, call_get_positions},
    {"pbf_set_positions", 4, call_set_positions},
    {"pbf_get_velocities", 1, call_get_velocities},
    {"pbf_get_share", 1, call_get_share},
    {"pbf_set_velocities", 4, call_set_velocities},
    {"pbf_set_accelerations", 1, call_set_accelerations},
    {"pbf_phase_init", 1, call_phase_init},
    {"pbf_set_phases", 2, call_set_phases},
    {"pbf_get_phase_count", 1, call_get_phase_count},
    {"pbf_get_phase", 1, call_get_phase},
    {"pbf_set_particle_phases", 2, call_set_particle_phases},
    {"pbf_get_particle_phases", 1, call_get_particle_phases},
    {"pbf_get_ids", 1, call_get_ids},
    {"pbf_get_densities", 2, call_get_densities},
    {"pbf_get_pressures", 2, call_get_pressures},
    {"pbf_read", 4, call_read},
    {"pbf_write", 2, call_write},
    {"pbf_get_anisotropies", 2, call_get_anisotropies},
    {"pbf_keep_previous", 2, call_keep_previous},
    {"pbf_volume_init", 1, call_volume_init},
    {"pbf_find_in_volume", 1, call_find_in_volume},
    {"pbf_measure_volumes", 1, call_measure_volumes},
    {"pbf_sample", 1, call_sample},
    {"pbf_sample_on_grid", 1, call_sample_on_grid},
    {"pbf_cast_rays", 1, call_cast_rays},
    {"pbf_get_levels", 1, call_get_levels},
    {"pbf_end_queries", 1, call_end_queries},
    {"pbf_emitter_init", 1, call_emitter_init},
    {"pbf_set_emitters", 1, call_set_emitters},
    {"pbf_get_emitter", 1, call_get_emitter},
    {"pbf_set_drains", 1, call_set_drains},
    {"pbf_get_drain", 1, call_get_drain},
    {"pbf_reservoir_init", 1, call_reservoir_init},
    {"pbf_set_reservoirs", 1, call_set_reservoirs},
    {"pbf_get_reservoir", 1, call_get_reservoir},
    {"pbf_get_reservoir_count", 1, call_get_reservoir_count},
    {"pbf_get_in_out", 1, call_get_in_out},
    {"pbf_diffuse_init", 1, call_diffuse_init},
    {"pbf_set_diffuse", 3, call_set_diffuse},
    {"pbf_get_diffuse", 1, call_get_diffuse},
    {"pbf_get_diffuse_info", 1, call_get_diffuse_info},
    {"pbf_read_diffuse", 2, call_read_diffuse},
    {"pbf_add_diffuse", 2, call_add_diffuse},
    {"pbf_shift_diffuse", 1, call_shift_diffuse},
    {"pbf_map", 2, call_map},
    {"pbf_unmap", 2, call_unmap},
    {"pbf_export_dlpack", 2, call_export_dlpack},
    {"pbf_set_snapshots", 2, call_set_snapshots},
    {"pbf_acquire_snapshot", 2, call_acquire_snapshot},
    {"pbf_release_snapshot", 1, call_release_snapshot},
    {"pbf_save", 4, call_save},
    {"pbf_load", 5, call_load},
    {"pbf_hash", 1, call_hash},
    {"pbf_batch_create", 1, call_batch_create},
    {"pbf_batch_destroy", 1, call_batch_destroy},
    {"pbf_batch_get_info", 1, call_batch_get_info},
    {"pbf_batch_get_world", 1, call_batch_get_world},
    {"pbf_batch_get_statuses", 1, call_batch_get_statuses},
    {"pbf_batch_get_sentence", 1, call_batch_get_sentence},
    {"pbf_batch_step", 1, call_batch_step},
    {"pbf_batch_set_start", 1, call_batch_set_start},
    {"pbf_batch_reset", 1, call_batch_reset},
    {"pbf_batch_set_gravity", 1, call_batch_set_gravity},
    {"pbf_batch_set_colliders", 1, call_batch_set_colliders},
    {"pbf_batch_move_colliders", 1, call_batch_move_colliders},
    {"pbf_batch_add_particles", 1, call_batch_add_particles},
    {"pbf_batch_get_counts", 1, call_batch_get_counts},
    {"pbf_batch_read", 1, call_batch_read},
    {"pbf_batch_export_dlpack", 1, call_batch_export_dlpack},
    {"fault: a fork", 2, fault_fork},
    {"fault: a killed child", 1, fault_kill},
    {"fault: a callback left", 1, fault_callback},
    {"fault: wrong arguments", 8, fault_arguments},
};

const uint32_t table_size = sizeof table / sizeof table[0];
_Static_assert(sizeof table / sizeof table[0] <= MOST_FUNCTIONS, "room in the record");

static uint32_t draw_entry(dice *d) {
  uint32_t total = 0, at = 0;
  for (uint32_t k = 0; k < table_size; ++k) total += table[k].weight;
  uint32_t rest = dice_below(d, total);
  while (rest >= table[at].weight) rest -= table[at++].weight;
  return at;
}

void make_call(actor *a) {
  a->dice = dice_of(a->seed, a->number, a->call);
  a->subject = &a->subjects[dice_below(&a->dice, SUBJECTS)];
  const uint32_t k = draw_entry(&a->dice);
  trace *t = &soak_record->traces[a->number];
  if (soak_record->left_out[a->number][a->call]) return;
  t->entry[a->call] = (unsigned char)(k + 1);
  atomic_store(&t->come, a->call + 1);
  a->function = table[k].name;
  if (!a->subject->twin[0] && !subject_make(a, a->subject)) return;
  atomic_fetch_add(&soak_record->calls[k], 1);
  table[k].make(a);
}
