/* Where every member of every public struct lies, on 64-bit systems. A line that no longer holds
 * breaks compiled programs; a new member gets a new line, and its struct a new size. */
#include <stddef.h>

#include <pbf/all.h>
#include <pbf/pbf_backend.h>

#define SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), #type)
#define AT(type, member, bytes) _Static_assert(offsetof(type, member) == (bytes), #type "." #member)

SIZE(pbf_allocator, 32);
AT(pbf_allocator, struct_size, 0);
AT(pbf_allocator, reserved, 4);
AT(pbf_allocator, user, 8);
AT(pbf_allocator, allocate, 16);
AT(pbf_allocator, release, 24);

SIZE(pbf_desc, 112);
AT(pbf_desc, struct_size, 0);
AT(pbf_desc, api_version, 4);
AT(pbf_desc, dimension, 8);
AT(pbf_desc, precision, 12);
AT(pbf_desc, capacity, 16);
AT(pbf_desc, strict, 20);
AT(pbf_desc, backend, 24);
AT(pbf_desc, device, 32);
AT(pbf_desc, threads, 36);
AT(pbf_desc, stream, 40);
AT(pbf_desc, allocator, 48);
AT(pbf_desc, log, 56);
AT(pbf_desc, log_user, 64);
AT(pbf_desc, isa, 72);
AT(pbf_desc, enqueue_task, 80);
AT(pbf_desc, finish_task, 88);
AT(pbf_desc, task_user, 96);
AT(pbf_desc, determinism, 104);
AT(pbf_desc, reserved, 108);

/* pbf_params by params.def, which states the offsets: the members that params.h writes out are
 * those of the table, in its order, of its types and counts, and there are no others. */
typedef struct table_params {
  uint32_t struct_size;
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  uint32_t name;
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  double name;
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  double name[count];
#include "physics/params.def"
} table_params;

#define IS_OF_TYPE(type, member, member_type) \
  _Static_assert(_Generic(&((type *)0)->member, member_type : 1, default : 0), #type "." #member)
#define AT_IN_TABLE(member, bytes, member_type) \
  AT(pbf_params, member, bytes);                \
  AT(table_params, member, bytes);              \
  IS_OF_TYPE(pbf_params, member, member_type)

SIZE(pbf_params, sizeof(table_params));
AT(pbf_params, struct_size, 0);
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  AT_IN_TABLE(name, offset, uint32_t *);
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  AT_IN_TABLE(name, offset, double *);
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  AT_IN_TABLE(name, offset, double(*)[count]);
#include "physics/params.def"

SIZE(pbf_grid_desc, 64);
AT(pbf_grid_desc, struct_size, 0);
AT(pbf_grid_desc, dimension, 4);
AT(pbf_grid_desc, nodes, 8);
AT(pbf_grid_desc, reserved, 20);
AT(pbf_grid_desc, origin, 24);
AT(pbf_grid_desc, cell, 48);
AT(pbf_grid_desc, values, 56);

SIZE(pbf_mesh_desc, 48);
AT(pbf_mesh_desc, struct_size, 0);
AT(pbf_mesh_desc, dimension, 4);
AT(pbf_mesh_desc, vertex_count, 8);
AT(pbf_mesh_desc, face_count, 12);
AT(pbf_mesh_desc, vertices, 16);
AT(pbf_mesh_desc, faces, 24);
AT(pbf_mesh_desc, cell, 32);
AT(pbf_mesh_desc, thickness, 40);

SIZE(pbf_heights_desc, 48);
AT(pbf_heights_desc, struct_size, 0);
AT(pbf_heights_desc, dimension, 4);
AT(pbf_heights_desc, count, 8);
AT(pbf_heights_desc, heights, 16);
AT(pbf_heights_desc, spacing, 24);
AT(pbf_heights_desc, base, 32);
AT(pbf_heights_desc, cell, 40);

SIZE(pbf_hull_desc, 32);
AT(pbf_hull_desc, struct_size, 0);
AT(pbf_hull_desc, dimension, 4);
AT(pbf_hull_desc, point_count, 8);
AT(pbf_hull_desc, reserved, 12);
AT(pbf_hull_desc, points, 16);
AT(pbf_hull_desc, cell, 24);

SIZE(pbf_shape_info, 136);
AT(pbf_shape_info, struct_size, 0);
AT(pbf_shape_info, dimension, 4);
AT(pbf_shape_info, nodes, 8);
AT(pbf_shape_info, references, 20);
AT(pbf_shape_info, origin, 24);
AT(pbf_shape_info, cell, 48);
AT(pbf_shape_info, lower, 56);
AT(pbf_shape_info, upper, 80);
AT(pbf_shape_info, volume, 104);
AT(pbf_shape_info, area, 112);
AT(pbf_shape_info, bytes, 120);
AT(pbf_shape_info, hash, 128);

SIZE(pbf_collider, 336);
AT(pbf_collider, struct_size, 0);
AT(pbf_collider, shape, 4);
AT(pbf_collider, inverted, 8);
AT(pbf_collider, path, 12);
AT(pbf_collider, position, 16);
AT(pbf_collider, orientation, 40);
AT(pbf_collider, velocity, 72);
AT(pbf_collider, angular_velocity, 96);
AT(pbf_collider, axis, 120);
AT(pbf_collider, half_extents, 144);
AT(pbf_collider, radius, 168);
AT(pbf_collider, half_length, 176);
AT(pbf_collider, half_extents_rate, 184);
AT(pbf_collider, radius_rate, 208);
AT(pbf_collider, half_length_rate, 216);
AT(pbf_collider, duration, 224);
AT(pbf_collider, geometry, 232);
AT(pbf_collider, scale, 240);
AT(pbf_collider, scale_rate, 248);
AT(pbf_collider, friction, 256);
AT(pbf_collider, static_friction, 264);
AT(pbf_collider, no_slip, 272);
AT(pbf_collider, adhesion, 280);
AT(pbf_collider, last_velocity, 288);
AT(pbf_collider, last_angular_velocity, 312);

SIZE(pbf_collider_load, 128);
AT(pbf_collider_load, struct_size, 0);
AT(pbf_collider_load, contacts, 4);
AT(pbf_collider_load, impulse, 8);
AT(pbf_collider_load, angular_impulse, 32);
AT(pbf_collider_load, impulse_sum, 56);
AT(pbf_collider_load, angular_impulse_sum, 80);
AT(pbf_collider_load, time_sum, 104);
AT(pbf_collider_load, penetration, 112);
AT(pbf_collider_load, wetted_area, 120);

SIZE(pbf_view, 72);
AT(pbf_view, struct_size, 0);
AT(pbf_view, field, 4);
AT(pbf_view, device_type, 8);
AT(pbf_view, device_id, 12);
AT(pbf_view, element_type, 16);
AT(pbf_view, components, 20);
AT(pbf_view, count, 24);
AT(pbf_view, reserved, 28);
AT(pbf_view, particle_stride, 32);
AT(pbf_view, component_stride, 40);
AT(pbf_view, generation, 48);
AT(pbf_view, data, 56);
AT(pbf_view, ids, 64);

SIZE(pbf_anisotropy_desc, 64);
AT(pbf_anisotropy_desc, struct_size, 0);
AT(pbf_anisotropy_desc, first, 4);
AT(pbf_anisotropy_desc, count, 8);
AT(pbf_anisotropy_desc, min_neighbors, 12);
AT(pbf_anisotropy_desc, radius, 16);
AT(pbf_anisotropy_desc, smoothing, 24);
AT(pbf_anisotropy_desc, max_ratio, 32);
AT(pbf_anisotropy_desc, lone_scale, 40);
AT(pbf_anisotropy_desc, positions, 48);
AT(pbf_anisotropy_desc, stretches, 56);

SIZE(pbf_read_desc, 80);
AT(pbf_read_desc, struct_size, 0);
AT(pbf_read_desc, field, 4);
AT(pbf_read_desc, first, 8);
AT(pbf_read_desc, count, 12);
AT(pbf_read_desc, element_type, 16);
AT(pbf_read_desc, components, 20);
AT(pbf_read_desc, w, 24);
AT(pbf_read_desc, order, 28);
AT(pbf_read_desc, stride, 32);
AT(pbf_read_desc, data, 40);
AT(pbf_read_desc, behind, 48);
AT(pbf_read_desc, w_value, 56);
AT(pbf_read_desc, device_type, 64);
AT(pbf_read_desc, reserved, 68);
AT(pbf_read_desc, stream, 72);

SIZE(pbf_write_desc, 56);
AT(pbf_write_desc, struct_size, 0);
AT(pbf_write_desc, field, 4);
AT(pbf_write_desc, first, 8);
AT(pbf_write_desc, count, 12);
AT(pbf_write_desc, element_type, 16);
AT(pbf_write_desc, components, 20);
AT(pbf_write_desc, stride, 24);
AT(pbf_write_desc, data, 32);
AT(pbf_write_desc, device_type, 40);
AT(pbf_write_desc, reserved, 44);
AT(pbf_write_desc, stream, 48);

SIZE(pbf_snapshot, 64);
AT(pbf_snapshot, struct_size, 0);
AT(pbf_snapshot, count, 4);
AT(pbf_snapshot, dimension, 8);
AT(pbf_snapshot, element_type, 12);
AT(pbf_snapshot, step, 16);
AT(pbf_snapshot, time, 24);
AT(pbf_snapshot, positions, 32);
AT(pbf_snapshot, velocities, 40);
AT(pbf_snapshot, ids, 48);
AT(pbf_snapshot, owner, 56);

SIZE(pbf_stats, 184);
AT(pbf_stats, struct_size, 0);
AT(pbf_stats, count, 4);
AT(pbf_stats, iterations, 8);
AT(pbf_stats, neighbors_max, 12);
AT(pbf_stats, neighbors_mean, 16);
AT(pbf_stats, center_of_mass, 24);
AT(pbf_stats, position_min, 48);
AT(pbf_stats, position_max, 72);
AT(pbf_stats, momentum, 96);
AT(pbf_stats, kinetic_energy, 120);
AT(pbf_stats, speed_max, 128);
AT(pbf_stats, density_error_mean, 136);
AT(pbf_stats, density_error_max, 144);
AT(pbf_stats, density_mean, 152);
AT(pbf_stats, asleep, 160);
AT(pbf_stats, squeezed, 164);
AT(pbf_stats, step_limit, 168);
AT(pbf_stats, limited_by, 176);
AT(pbf_stats, substeps, 180);

SIZE(pbf_stage_time, 48);
AT(pbf_stage_time, name, 0);
AT(pbf_stage_time, milliseconds, 32);
AT(pbf_stage_time, runs, 40);

SIZE(pbf_timings, 1160);
AT(pbf_timings, struct_size, 0);
AT(pbf_timings, stage_count, 4);
AT(pbf_timings, stages, 8);

SIZE(pbf_plan_stage, 40);
AT(pbf_plan_stage, name, 0);
AT(pbf_plan_stage, runs_per_step, 32);
AT(pbf_plan_stage, launches_per_step, 36);

SIZE(pbf_plan_array, 48);
AT(pbf_plan_array, name, 0);
AT(pbf_plan_array, bytes_per_particle, 32);
AT(pbf_plan_array, bytes, 40);

SIZE(pbf_plan, 2976);
AT(pbf_plan, struct_size, 0);
AT(pbf_plan, stage_count, 4);
AT(pbf_plan, array_count, 8);
AT(pbf_plan, reserved, 12);
AT(pbf_plan, variant, 16);
AT(pbf_plan, bytes_per_particle, 80);
AT(pbf_plan, bytes, 88);
AT(pbf_plan, stages, 96);
AT(pbf_plan, arrays, 1056);

SIZE(pbf_info, 784);
AT(pbf_info, struct_size, 0);
AT(pbf_info, dimension, 4);
AT(pbf_info, precision, 8);
AT(pbf_info, capacity, 12);
AT(pbf_info, threads, 16);
AT(pbf_info, device, 20);
AT(pbf_info, device_type, 24);
AT(pbf_info, fell_back, 28);
AT(pbf_info, step, 32);
AT(pbf_info, time, 40);
AT(pbf_info, backend, 48);
AT(pbf_info, device_name, 80);
AT(pbf_info, build_id, 176);
AT(pbf_info, path, 272);
AT(pbf_info, fallback_reason, 528);

SIZE(pbf_backend_info, 752);
AT(pbf_backend_info, struct_size, 0);
AT(pbf_backend_info, available, 4);
AT(pbf_backend_info, score, 8);
AT(pbf_backend_info, device_type, 12);
AT(pbf_backend_info, name, 16);
AT(pbf_backend_info, device_name, 48);
AT(pbf_backend_info, build_id, 144);
AT(pbf_backend_info, path, 240);
AT(pbf_backend_info, reason, 496);

SIZE(pbf_backend_host, 32);
AT(pbf_backend_host, struct_size, 0);
AT(pbf_backend_host, abi_min, 4);
AT(pbf_backend_host, abi_max, 8);
AT(pbf_backend_host, reserved, 12);
AT(pbf_backend_host, set_error, 16);
AT(pbf_backend_host, load_part, 24);

SIZE(pbf_workload, 40);
AT(pbf_workload, struct_size, 0);
AT(pbf_workload, dimension, 4);
AT(pbf_workload, precision, 8);
AT(pbf_workload, capacity, 12);
AT(pbf_workload, device, 16);
AT(pbf_workload, threads, 20);
AT(pbf_workload, isa, 24);
AT(pbf_workload, has_tasks, 32);
AT(pbf_workload, reserved, 36);

SIZE(pbf_probe_result, 368);
AT(pbf_probe_result, struct_size, 0);
AT(pbf_probe_result, score, 4);
AT(pbf_probe_result, device_type, 8);
AT(pbf_probe_result, reserved, 12);
AT(pbf_probe_result, device_name, 16);
AT(pbf_probe_result, reason, 112);

SIZE(pbf_batch_info, 16);
AT(pbf_batch_info, struct_size, 0);
AT(pbf_batch_info, worlds, 4);
AT(pbf_batch_info, threads, 8);
AT(pbf_batch_info, device_type, 12);

SIZE(pbf_backend_desc, 136);
AT(pbf_backend_desc, struct_size, 0);
AT(pbf_backend_desc, dimension, 4);
AT(pbf_backend_desc, precision, 8);
AT(pbf_backend_desc, capacity, 12);
AT(pbf_backend_desc, device, 16);
AT(pbf_backend_desc, threads, 20);
AT(pbf_backend_desc, stream, 24);
AT(pbf_backend_desc, allocator, 32);
AT(pbf_backend_desc, log, 64);
AT(pbf_backend_desc, log_user, 72);
AT(pbf_backend_desc, host, 80);
AT(pbf_backend_desc, isa, 88);
AT(pbf_backend_desc, enqueue_task, 96);
AT(pbf_backend_desc, finish_task, 104);
AT(pbf_backend_desc, task_user, 112);
AT(pbf_backend_desc, worlds, 120);
AT(pbf_backend_desc, determinism, 124);
AT(pbf_backend_desc, ranks, 128);

SIZE(pbf_particles, 40);
AT(pbf_particles, struct_size, 0);
AT(pbf_particles, count, 4);
AT(pbf_particles, ids, 8);
AT(pbf_particles, positions, 16);
AT(pbf_particles, velocities, 24);
AT(pbf_particles, phase, 32);
AT(pbf_particles, wakes_all, 36);

SIZE(pbf_phase_table, 224);
AT(pbf_phase_table, struct_size, 0);
AT(pbf_phase_table, count, 4);
AT(pbf_phase_table, mobility, 8);
AT(pbf_phase_table, viscosity, 72);
AT(pbf_phase_table, thickness, 136);
AT(pbf_phase_table, thickest, 200);
AT(pbf_phase_table, heaviest, 208);
AT(pbf_phase_table, used, 216);
AT(pbf_phase_table, reserved, 220);

SIZE(pbf_rows, 24);
AT(pbf_rows, struct_size, 0);
AT(pbf_rows, first, 4);
AT(pbf_rows, count, 8);
AT(pbf_rows, total, 12);
AT(pbf_rows, ids, 16);

SIZE(pbf_backend_box, 48);
AT(pbf_backend_box, lower, 0);
AT(pbf_backend_box, upper, 24);

SIZE(pbf_backend_found, 40);
AT(pbf_backend_found, struct_size, 0);
AT(pbf_backend_found, room, 4);
AT(pbf_backend_found, count, 8);
AT(pbf_backend_found, reserved, 12);
AT(pbf_backend_found, ids, 16);
AT(pbf_backend_found, positions, 24);
AT(pbf_backend_found, velocities, 32);

SIZE(pbf_backend_state, 112);
AT(pbf_backend_state, struct_size, 0);
AT(pbf_backend_state, threads, 4);
AT(pbf_backend_state, device_type, 8);
AT(pbf_backend_state, reserved, 12);
AT(pbf_backend_state, device_name, 16);

SIZE(pbf_overlap, 80);
AT(pbf_overlap, struct_size, 0);
AT(pbf_overlap, walls, 4);
AT(pbf_overlap, first_id, 8);
AT(pbf_overlap, last_id, 12);
AT(pbf_overlap, colliders, 16);
AT(pbf_overlap, part, 24);
AT(pbf_overlap, more_colliders, 32);
AT(pbf_overlap, reference, 40);
AT(pbf_overlap, before, 48);
AT(pbf_overlap, now, 56);
AT(pbf_overlap, least, 64);
AT(pbf_overlap, entering, 72);

SIZE(pbf_entering, 80);
AT(pbf_entering, struct_size, 0);
AT(pbf_entering, alone, 4);
AT(pbf_entering, first_id, 8);
AT(pbf_entering, last_id, 12);
AT(pbf_entering, kept, 16);
AT(pbf_entering, lower, 24);
AT(pbf_entering, upper, 48);
AT(pbf_entering, stream_first_id, 72);
AT(pbf_entering, reserved, 76);

SIZE(pbf_backend_array, 32);
AT(pbf_backend_array, struct_size, 0);
AT(pbf_backend_array, device_type, 4);
AT(pbf_backend_array, device_id, 8);
AT(pbf_backend_array, reserved, 12);
AT(pbf_backend_array, data, 16);
AT(pbf_backend_array, owner, 24);

SIZE(pbf_backend_api, 280);
AT(pbf_backend_api, struct_size, 0);
AT(pbf_backend_api, reserved, 4);
AT(pbf_backend_api, probe, 8);
AT(pbf_backend_api, create, 16);
AT(pbf_backend_api, destroy, 24);
AT(pbf_backend_api, set_params, 32);
AT(pbf_backend_api, set_colliders, 40);
AT(pbf_backend_api, step, 48);
AT(pbf_backend_api, synchronize, 56);
AT(pbf_backend_api, add_particles, 64);
AT(pbf_backend_api, remove_particles, 72);
AT(pbf_backend_api, remove_all, 80);
AT(pbf_backend_api, read, 88);
AT(pbf_backend_api, write, 96);
AT(pbf_backend_api, map, 104);
AT(pbf_backend_api, get_stats, 112);
AT(pbf_backend_api, get_plan, 120);
AT(pbf_backend_api, describe, 128);
AT(pbf_backend_api, set_timing, 136);
AT(pbf_backend_api, get_timings, 144);
AT(pbf_backend_api, get_extension, 152);
AT(pbf_backend_api, read_pressures, 160);
AT(pbf_backend_api, map_pressures, 168);
AT(pbf_backend_api, project, 176);
AT(pbf_backend_api, set_overlap, 184);
AT(pbf_backend_api, plan_for, 192);
AT(pbf_backend_api, max_speed, 200);
AT(pbf_backend_api, take_array, 208);
AT(pbf_backend_api, release_array, 216);
AT(pbf_backend_api, read_array, 224);
AT(pbf_backend_api, get_loads, 232);
AT(pbf_backend_api, set_phases, 240);
AT(pbf_backend_api, plan_steps, 248);
AT(pbf_backend_api, steps_leave, 256);
AT(pbf_backend_api, set_accelerations, 264);
AT(pbf_backend_api, find_in_boxes, 272);

SIZE(pbf_backend_answer, 144);
AT(pbf_backend_answer, struct_size, 0);
AT(pbf_backend_answer, abi_version, 4);
AT(pbf_backend_answer, name, 8);
AT(pbf_backend_answer, build_id, 40);
AT(pbf_backend_answer, api, 136);

SIZE(pbf_volume, 128);
AT(pbf_volume, struct_size, 0);
AT(pbf_volume, shape, 4);
AT(pbf_volume, position, 8);
AT(pbf_volume, orientation, 32);
AT(pbf_volume, half_extents, 64);
AT(pbf_volume, axis, 88);
AT(pbf_volume, radius, 112);
AT(pbf_volume, half_length, 120);

SIZE(pbf_volume_flow, 72);
AT(pbf_volume_flow, struct_size, 0);
AT(pbf_volume_flow, reserved, 4);
AT(pbf_volume_flow, volume, 8);
AT(pbf_volume_flow, fraction, 16);
AT(pbf_volume_flow, centre, 24);
AT(pbf_volume_flow, velocity, 48);

SIZE(pbf_samples, 48);
AT(pbf_samples, struct_size, 0);
AT(pbf_samples, count, 4);
AT(pbf_samples, points, 8);
AT(pbf_samples, densities, 16);
AT(pbf_samples, velocities, 24);
AT(pbf_samples, pressures, 32);
AT(pbf_samples, wet, 40);

SIZE(pbf_sample_grid, 64);
AT(pbf_sample_grid, struct_size, 0);
AT(pbf_sample_grid, counts, 4);
AT(pbf_sample_grid, origin, 16);
AT(pbf_sample_grid, step, 40);

SIZE(pbf_emitter, 144);
AT(pbf_emitter, struct_size, 0);
AT(pbf_emitter, shape, 4);
AT(pbf_emitter, recycle, 8);
AT(pbf_emitter, seed, 12);
AT(pbf_emitter, position, 16);
AT(pbf_emitter, velocity, 40);
AT(pbf_emitter, across, 64);
AT(pbf_emitter, half_width, 88);
AT(pbf_emitter, half_height, 96);
AT(pbf_emitter, radius, 104);
AT(pbf_emitter, rate, 112);
AT(pbf_emitter, jitter, 120);
AT(pbf_emitter, lifetime, 128);
AT(pbf_emitter, phase, 136);
AT(pbf_emitter, reserved, 140);

SIZE(pbf_reservoir, 120);
AT(pbf_reservoir, struct_size, 0);
AT(pbf_reservoir, phase, 4);
AT(pbf_reservoir, position, 8);
AT(pbf_reservoir, orientation, 32);
AT(pbf_reservoir, half_extents, 64);
AT(pbf_reservoir, depth, 88);
AT(pbf_reservoir, pressure, 96);
AT(pbf_reservoir, added, 104);
AT(pbf_reservoir, removed, 112);

SIZE(pbf_phase, 24);
AT(pbf_phase, struct_size, 0);
AT(pbf_phase, user, 4);
AT(pbf_phase, rest_density, 8);
AT(pbf_phase, viscosity, 16);

SIZE(pbf_in_out, 56);
AT(pbf_in_out, struct_size, 0);
AT(pbf_in_out, emitters, 4);
AT(pbf_in_out, drains, 8);
AT(pbf_in_out, reserved, 12);
AT(pbf_in_out, emitted, 16);
AT(pbf_in_out, refused, 24);
AT(pbf_in_out, recycled, 32);
AT(pbf_in_out, drained, 40);
AT(pbf_in_out, expired, 48);

int main(void) { return 0; }
