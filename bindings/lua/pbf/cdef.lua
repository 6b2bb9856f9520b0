-- Written by tools/bindings.py from bindings/abi.json; do not edit.
local ffi = require("ffi")
ffi.cdef [[
typedef int32_t pbf_status;
enum {
  PBF_OK = 0,
  PBF_ERROR_INVALID_ARGUMENT = -1,
  PBF_ERROR_STRUCT_SIZE = -2,
  PBF_ERROR_OUT_OF_MEMORY = -3,
  PBF_ERROR_CAPACITY = -4,
  PBF_ERROR_NOT_FOUND = -5,
  PBF_ERROR_UNAVAILABLE = -6,
  PBF_ERROR_UNSUPPORTED = -7,
  PBF_ERROR_BUSY = -8,
  PBF_ERROR_STATE = -9,
  PBF_ERROR_DEVICE = -10,
  PBF_ERROR_PLUGIN = -11,
  PBF_ERROR_DATA = -12,
  PBF_ERROR_CANCELLED = -13,
};
enum {
  PBF_DEVICE_CPU = 1,
  PBF_DEVICE_CUDA = 2,
};
enum {
  PBF_TYPE_FLOAT32 = 4,
  PBF_TYPE_FLOAT64 = 8,
  PBF_TYPE_UINT32 = 12,
};
enum {
  PBF_FIELD_POSITION = 1,
  PBF_FIELD_VELOCITY = 2,
  PBF_FIELD_ID = 3,
  PBF_FIELD_DENSITY = 4,
  PBF_FIELD_PRESSURE = 5,
};
enum {
  PBF_FLOAT32 = 4,
  PBF_FLOAT64 = 8,
};
enum {
  PBF_DETERMINISM_ACROSS_MACHINES = 0,
  PBF_DETERMINISM_PER_MACHINE = 1,
};
enum {
  PBF_LOG_INFO = 1,
  PBF_LOG_WARNING = 2,
};
enum {
  PBF_KERNEL_WENDLAND_C2 = 0,
  PBF_KERNEL_POLY6_SPIKY = 1,
};
enum {
  PBF_SOLVER_JACOBI = 0,
  PBF_SOLVER_CHEBYSHEV = 1,
};
enum {
  PBF_COLLIDE_AFTER_PREDICTION = 1,
  PBF_COLLIDE_IN_ITERATION = 2,
  PBF_COLLIDE_AFTER_SOLVE = 4,
};
enum {
  PBF_PERIODIC_X = 1,
  PBF_PERIODIC_Y = 2,
  PBF_PERIODIC_Z = 4,
};
enum {
  PBF_WALL_X_MIN = 0,
  PBF_WALL_X_MAX = 1,
  PBF_WALL_Y_MIN = 2,
  PBF_WALL_Y_MAX = 3,
  PBF_WALL_Z_MIN = 4,
  PBF_WALL_Z_MAX = 5,
};
enum {
  PBF_COLLIDER_PLANE = 0,
  PBF_COLLIDER_SPHERE = 1,
  PBF_COLLIDER_CAPSULE = 2,
  PBF_COLLIDER_BOX = 3,
  PBF_COLLIDER_SHAPE = 4,
};
enum {
  PBF_PATH_AUTO = 0,
  PBF_PATH_STRAIGHT = 1,
  PBF_PATH_SCREW = 2,
};
enum {
  PBF_W_CONSTANT = 0,
  PBF_W_SPEED = 1,
  PBF_W_DENSITY = 2,
  PBF_W_PRESSURE = 3,
};
enum {
  PBF_ORDER_ADDED = 0,
  PBF_ORDER_STORED = 1,
};
enum {
  PBF_LIMIT_NONE = 0,
  PBF_LIMIT_GRAVITY = 1,
  PBF_LIMIT_ATTRACTION = 2,
  PBF_LIMIT_PARTICLES = 3,
  PBF_LIMIT_WALLS = 4,
  PBF_LIMIT_COLLIDERS = 5,
  PBF_LIMIT_TENSION = 6,
};
enum {
  PBF_DIFFUSE_SPRAY = 0,
  PBF_DIFFUSE_FOAM = 1,
  PBF_DIFFUSE_BUBBLE = 2,
};
enum {
  PBF_VOLUME_BOX = 0,
  PBF_VOLUME_SPHERE = 1,
  PBF_VOLUME_CAPSULE = 2,
};
enum {
  PBF_EMITTER_RECTANGLE = 0,
  PBF_EMITTER_DISC = 1,
};
enum {
  PBF_VERSION_MAJOR = 0,
  PBF_VERSION_MINOR = 2,
  PBF_VERSION_PATCH = 0,
  PBF_API_VERSION = 2,
  PBF_NAME_SIZE = 32,
  PBF_MAX_CAPACITY = 1073741823,
  PBF_MAX_COLLIDERS = 4096,
  PBF_MAX_SNAPSHOTS = 16,
  PBF_MAX_STAGES = 24,
  PBF_MAX_ARRAYS = 40,
  PBF_MAX_WORLDS = 65536,
  PBF_MAX_DIFFUSE = 4194303,
  PBF_MAX_EMITTERS = 64,
  PBF_MAX_DRAINS = 64,
  PBF_MAX_RESERVOIRS = 64,
  PBF_MAX_PHASES = 8,
};
struct DLManagedTensor;
typedef struct pbf_batch pbf_batch;
typedef struct pbf_shape pbf_shape;
typedef struct pbf_solver pbf_solver;
typedef void (*pbf_log_fn)(void *, int32_t, const char *);
typedef void (*pbf_task_fn)(void *, uint32_t, uint32_t);
typedef void *(*pbf_enqueue_task_fn)(void *, pbf_task_fn, void *, uint32_t, uint32_t);
typedef void (*pbf_finish_task_fn)(void *, void *);
typedef void *(*pbf_allocator_allocate_fn)(void *, uint64_t, uint64_t);
typedef void (*pbf_allocator_release_fn)(void *, void *, uint64_t, uint64_t);
typedef struct pbf_allocator {
  uint32_t struct_size;
  uint32_t reserved;
  void *user;
  pbf_allocator_allocate_fn allocate;
  pbf_allocator_release_fn release;
} pbf_allocator;
typedef struct pbf_desc {
  uint32_t struct_size;
  uint32_t api_version;
  uint32_t dimension;
  uint32_t precision;
  uint32_t capacity;
  uint32_t strict;
  const char *backend;
  int32_t device;
  uint32_t threads;
  void *stream;
  const pbf_allocator *allocator;
  pbf_log_fn log;
  void *log_user;
  const char *isa;
  pbf_enqueue_task_fn enqueue_task;
  pbf_finish_task_fn finish_task;
  void *task_user;
  uint32_t determinism;
  uint32_t reserved;
} pbf_desc;
typedef struct pbf_params {
  uint32_t struct_size;
  uint32_t kernel;
  double smoothing_radius;
  double spacing;
  double particle_volume;
  double time_step;
  uint32_t iterations;
  uint32_t collide;
  double gravity[3];
  double attraction;
  double attraction_center[3];
  double over_relaxation;
  double cfm;
  double cohesion;
  double min_diagonal;
  double wall_density;
  double scorr_k;
  double scorr_dq;
  uint32_t scorr_n;
  uint32_t solver;
  double vorticity;
  double viscosity;
  double domain_min[3];
  double domain_max[3];
  double wall_velocity[6];
  double wall_amplitude[6];
  double wall_frequency[6];
  double wall_phase[6];
  double search_cell_width;
  double sleep_speed;
  double sleep_time;
  double tolerance;
  double pressure_grid;
  double prestabilization;
  double damping_compensation;
  double angular_momentum_correction;
  double drag;
  double drag_velocity[3];
  double max_depenetration_speed;
  uint32_t max_substeps;
  uint32_t loads;
  double shear_stress_correction;
  double wall_friction;
  double wall_static_friction;
  double wall_no_slip;
  double surface_tension;
  uint32_t periodic;
  uint32_t reserved;
  double wall_adhesion;
} pbf_params;
typedef struct pbf_collider {
  uint32_t struct_size;
  uint32_t shape;
  uint32_t inverted;
  uint32_t path;
  double position[3];
  double orientation[4];
  double velocity[3];
  double angular_velocity[3];
  double axis[3];
  double half_extents[3];
  double radius;
  double half_length;
  double half_extents_rate[3];
  double radius_rate;
  double half_length_rate;
  double duration;
  pbf_shape *geometry;
  double scale;
  double scale_rate;
  double friction;
  double static_friction;
  double no_slip;
  double adhesion;
  double last_velocity[3];
  double last_angular_velocity[3];
} pbf_collider;
typedef struct pbf_collider_load {
  uint32_t struct_size;
  uint32_t contacts;
  double impulse[3];
  double angular_impulse[3];
  double impulse_sum[3];
  double angular_impulse_sum[3];
  double time_sum;
  double penetration;
  double wetted_area;
} pbf_collider_load;
typedef struct pbf_read_desc {
  uint32_t struct_size;
  uint32_t field;
  uint32_t first;
  uint32_t count;
  uint32_t element_type;
  uint32_t components;
  uint32_t w;
  uint32_t order;
  uint64_t stride;
  void *data;
  double behind;
  double w_value;
  uint32_t device_type;
  uint32_t reserved;
  void *stream;
} pbf_read_desc;
typedef struct pbf_write_desc {
  uint32_t struct_size;
  uint32_t field;
  uint32_t first;
  uint32_t count;
  uint32_t element_type;
  uint32_t components;
  uint64_t stride;
  const void *data;
  uint32_t device_type;
  uint32_t reserved;
  void *stream;
} pbf_write_desc;
typedef struct pbf_view {
  uint32_t struct_size;
  uint32_t field;
  uint32_t device_type;
  int32_t device_id;
  uint32_t element_type;
  uint32_t components;
  uint32_t count;
  uint32_t reserved;
  int64_t particle_stride;
  int64_t component_stride;
  uint64_t generation;
  const void *data;
  const uint32_t *ids;
} pbf_view;
typedef struct pbf_snapshot {
  uint32_t struct_size;
  uint32_t count;
  uint32_t dimension;
  uint32_t element_type;
  uint64_t step;
  double time;
  const void *positions;
  const void *velocities;
  const uint32_t *ids;
  void *owner;
} pbf_snapshot;
typedef struct pbf_anisotropy_desc {
  uint32_t struct_size;
  uint32_t first;
  uint32_t count;
  uint32_t min_neighbors;
  double radius;
  double smoothing;
  double max_ratio;
  double lone_scale;
  void *positions;
  void *stretches;
} pbf_anisotropy_desc;
typedef struct pbf_stats {
  uint32_t struct_size;
  uint32_t count;
  uint32_t iterations;
  uint32_t neighbors_max;
  double neighbors_mean;
  double center_of_mass[3];
  double position_min[3];
  double position_max[3];
  double momentum[3];
  double kinetic_energy;
  double speed_max;
  double density_error_mean;
  double density_error_max;
  double density_mean;
  uint32_t asleep;
  uint32_t squeezed;
  double step_limit;
  uint32_t limited_by;
  uint32_t substeps;
} pbf_stats;
typedef struct pbf_stage_time {
  char name[32];
  double milliseconds;
  uint64_t runs;
} pbf_stage_time;
typedef struct pbf_timings {
  uint32_t struct_size;
  uint32_t stage_count;
  pbf_stage_time stages[24];
} pbf_timings;
typedef struct pbf_plan_stage {
  char name[32];
  uint32_t runs_per_step;
  uint32_t launches_per_step;
} pbf_plan_stage;
typedef struct pbf_plan_array {
  char name[32];
  double bytes_per_particle;
  uint64_t bytes;
} pbf_plan_array;
typedef struct pbf_plan {
  uint32_t struct_size;
  uint32_t stage_count;
  uint32_t array_count;
  uint32_t reserved;
  char variant[64];
  double bytes_per_particle;
  uint64_t bytes;
  pbf_plan_stage stages[24];
  pbf_plan_array arrays[40];
} pbf_plan;
typedef struct pbf_backend_info {
  uint32_t struct_size;
  uint32_t available;
  int32_t score;
  uint32_t device_type;
  char name[32];
  char device_name[96];
  char build_id[96];
  char path[256];
  char reason[256];
} pbf_backend_info;
typedef struct pbf_info {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t precision;
  uint32_t capacity;
  uint32_t threads;
  int32_t device;
  uint32_t device_type;
  uint32_t fell_back;
  uint64_t step;
  double time;
  char backend[32];
  char device_name[96];
  char build_id[96];
  char path[256];
  char fallback_reason[256];
} pbf_info;
typedef struct pbf_batch_info {
  uint32_t struct_size;
  uint32_t worlds;
  uint32_t threads;
  uint32_t device_type;
} pbf_batch_info;
typedef struct pbf_diffuse_desc {
  uint32_t struct_size;
  uint32_t capacity;
  uint32_t seed;
  uint32_t interval;
  uint32_t foam_neighbors;
  uint32_t bubble_neighbors;
  double trapped_air_min;
  double trapped_air_max;
  double wave_crest_min;
  double wave_crest_max;
  double energy_min;
  double energy_max;
  double trapped_air_rate;
  double wave_crest_rate;
  double lifetime_min;
  double lifetime_max;
  double buoyancy;
  double bubble_drag;
  double spray_drag;
  double scatter;
} pbf_diffuse_desc;
typedef struct pbf_diffuse_info {
  uint32_t struct_size;
  uint32_t capacity;
  uint32_t count;
  uint32_t spray;
  uint32_t foam;
  uint32_t bubbles;
  double time;
  uint64_t generated;
  uint64_t expired;
  uint64_t recycled;
} pbf_diffuse_info;
typedef struct pbf_diffuse_read {
  uint32_t struct_size;
  uint32_t first;
  uint32_t count;
  uint32_t element_type;
  uint32_t components;
  uint32_t reserved;
  uint64_t stride;
  void *positions;
  void *velocities;
  void *ages;
  void *lives;
  uint32_t *kinds;
  uint64_t *ids;
} pbf_diffuse_read;
typedef struct pbf_volume {
  uint32_t struct_size;
  uint32_t shape;
  double position[3];
  double orientation[4];
  double half_extents[3];
  double axis[3];
  double radius;
  double half_length;
} pbf_volume;
typedef struct pbf_volume_flow {
  uint32_t struct_size;
  uint32_t reserved;
  double volume;
  double fraction;
  double centre[3];
  double velocity[3];
} pbf_volume_flow;
typedef struct pbf_samples {
  uint32_t struct_size;
  uint32_t count;
  const double *points;
  double *densities;
  double *velocities;
  double *pressures;
  uint8_t *wet;
} pbf_samples;
typedef struct pbf_sample_grid {
  uint32_t struct_size;
  uint32_t counts[3];
  double origin[3];
  double step[3];
} pbf_sample_grid;
typedef struct pbf_emitter {
  uint32_t struct_size;
  uint32_t shape;
  uint32_t recycle;
  uint32_t seed;
  double position[3];
  double velocity[3];
  double across[3];
  double half_width;
  double half_height;
  double radius;
  double rate;
  double jitter;
  double lifetime;
  uint32_t phase;
  uint32_t reserved;
} pbf_emitter;
typedef struct pbf_reservoir {
  uint32_t struct_size;
  uint32_t phase;
  double position[3];
  double orientation[4];
  double half_extents[3];
  double depth;
  double pressure;
  uint64_t added;
  uint64_t removed;
} pbf_reservoir;
typedef struct pbf_in_out {
  uint32_t struct_size;
  uint32_t emitters;
  uint32_t drains;
  uint32_t reserved;
  uint64_t emitted;
  uint64_t refused;
  uint64_t recycled;
  uint64_t drained;
  uint64_t expired;
} pbf_in_out;
typedef struct pbf_phase {
  uint32_t struct_size;
  uint32_t user;
  double rest_density;
  double viscosity;
} pbf_phase;
typedef struct pbf_grid_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t nodes[3];
  uint32_t reserved;
  double origin[3];
  double cell;
  const float *values;
} pbf_grid_desc;
typedef struct pbf_mesh_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t vertex_count;
  uint32_t face_count;
  const double *vertices;
  const uint32_t *faces;
  double cell;
  double thickness;
} pbf_mesh_desc;
typedef struct pbf_heights_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t count[2];
  const double *heights;
  double spacing;
  double base;
  double cell;
} pbf_heights_desc;
typedef struct pbf_hull_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t point_count;
  uint32_t reserved;
  const double *points;
  double cell;
} pbf_hull_desc;
typedef struct pbf_shape_info {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t nodes[3];
  uint32_t references;
  double origin[3];
  double cell;
  double lower[3];
  double upper[3];
  double volume;
  double area;
  uint64_t bytes;
  uint64_t hash;
} pbf_shape_info;
const char *pbf_status_string(pbf_status status);
const char *pbf_last_error(void);
pbf_status pbf_desc_init(pbf_desc *desc, uint32_t struct_size);
pbf_status pbf_params_init(pbf_params *params, uint32_t struct_size);
pbf_status pbf_set_params(pbf_solver *solver, const pbf_params *params);
pbf_status pbf_get_params(pbf_solver *solver, pbf_params *params);
pbf_status pbf_collider_init(pbf_collider *collider, uint32_t struct_size, uint32_t shape);
pbf_status pbf_set_colliders(pbf_solver *solver, uint32_t count, const pbf_collider *colliders);
pbf_status pbf_move_colliders(pbf_solver *solver, uint32_t count, const pbf_collider *targets, double duration);
pbf_status pbf_get_collider_count(pbf_solver *solver, uint32_t *count);
pbf_status pbf_get_collider(pbf_solver *solver, uint32_t index, pbf_collider *collider);
pbf_status pbf_get_collider_loads(pbf_solver *solver, uint32_t count, pbf_collider_load *loads);
pbf_status pbf_get_wall_loads(pbf_solver *solver, uint32_t count, pbf_collider_load *loads);
pbf_status pbf_read(pbf_solver *solver, const pbf_read_desc *read);
pbf_status pbf_write(pbf_solver *solver, const pbf_write_desc *write);
pbf_status pbf_keep_previous(pbf_solver *solver, uint32_t enabled);
pbf_status pbf_map(pbf_solver *solver, uint32_t field, pbf_view *view);
pbf_status pbf_unmap(pbf_solver *solver, uint32_t field);
pbf_status pbf_export_dlpack(pbf_solver *solver, uint32_t field, struct DLManagedTensor * *tensor);
pbf_status pbf_set_snapshots(pbf_solver *solver, uint32_t snapshots);
pbf_status pbf_acquire_snapshot(pbf_solver *solver, pbf_snapshot *snapshot);
pbf_status pbf_release_snapshot(pbf_snapshot *snapshot);
pbf_status pbf_get_anisotropies(pbf_solver *solver, const pbf_anisotropy_desc *anisotropy);
pbf_status pbf_get_stats(pbf_solver *solver, pbf_stats *stats);
pbf_status pbf_get_step_limit(pbf_solver *solver, double *limit);
pbf_status pbf_set_timing(pbf_solver *solver, uint32_t enabled);
pbf_status pbf_get_timings(pbf_solver *solver, pbf_timings *timings);
pbf_status pbf_get_plan(pbf_solver *solver, pbf_plan *plan);
pbf_status pbf_get_backend_count(uint32_t *count);
pbf_status pbf_get_backend_info(const pbf_desc *desc, uint32_t index, pbf_backend_info *info);
pbf_status pbf_load_backend(const char *path);
uint32_t pbf_version(void);
pbf_status pbf_create(const pbf_desc *desc, const pbf_params *params, pbf_solver * *solver);
void pbf_destroy(pbf_solver *solver);
pbf_status pbf_step(pbf_solver *solver, uint32_t steps);
pbf_status pbf_begin_step(pbf_solver *solver, uint32_t steps);
pbf_status pbf_end_step(pbf_solver *solver);
pbf_status pbf_cancel(pbf_solver *solver);
pbf_status pbf_synchronize(pbf_solver *solver);
pbf_status pbf_get_info(pbf_solver *solver, pbf_info *info);
pbf_status pbf_get_count(pbf_solver *solver, uint32_t *count);
pbf_status pbf_add_particles(pbf_solver *solver, uint32_t count, const void *positions, const void *velocities, uint32_t *first_id);
pbf_status pbf_remove_particles(pbf_solver *solver, uint32_t count, const uint32_t *ids);
pbf_status pbf_remove_in_box(pbf_solver *solver, const double *lower, const double *upper, uint32_t *count);
pbf_status pbf_find_in_box(pbf_solver *solver, const double *lower, const double *upper, uint32_t room, uint32_t *ids, uint32_t *count);
pbf_status pbf_get_positions(pbf_solver *solver, uint32_t first, uint32_t count, void *positions);
pbf_status pbf_set_positions(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions);
pbf_status pbf_get_velocities(pbf_solver *solver, uint32_t first, uint32_t count, void *velocities);
pbf_status pbf_set_velocities(pbf_solver *solver, uint32_t first, uint32_t count, const void *velocities);
pbf_status pbf_get_ids(pbf_solver *solver, uint32_t first, uint32_t count, uint32_t *ids);
pbf_status pbf_get_densities(pbf_solver *solver, uint32_t first, uint32_t count, void *densities);
pbf_status pbf_set_accelerations(pbf_solver *solver, uint32_t first, uint32_t count, const void *accelerations);
pbf_status pbf_get_pressures(pbf_solver *solver, uint32_t first, uint32_t count, void *pressures);
pbf_status pbf_save(pbf_solver *solver, void *buffer, uint64_t *size);
pbf_status pbf_load(pbf_solver *solver, const void *buffer, uint64_t size);
pbf_status pbf_hash(pbf_solver *solver, uint64_t *hash);
pbf_status pbf_batch_create(const pbf_desc *desc, const pbf_params *params, uint32_t worlds, pbf_batch * *batch);
void pbf_batch_destroy(pbf_batch *batch);
pbf_status pbf_batch_get_info(pbf_batch *batch, pbf_batch_info *info);
pbf_status pbf_batch_get_world(pbf_batch *batch, uint32_t world, pbf_solver * *solver);
pbf_status pbf_batch_get_statuses(pbf_batch *batch, pbf_status *statuses);
pbf_status pbf_batch_get_sentence(pbf_batch *batch, uint32_t world, const char * *sentence);
pbf_status pbf_batch_step(pbf_batch *batch, const uint8_t *mask, uint32_t steps);
pbf_status pbf_batch_set_start(pbf_batch *batch, const uint8_t *mask, const void *state, uint64_t size);
pbf_status pbf_batch_reset(pbf_batch *batch, const uint8_t *mask);
pbf_status pbf_batch_set_gravity(pbf_batch *batch, const uint8_t *mask, const double *gravity);
pbf_status pbf_batch_set_colliders(pbf_batch *batch, const uint8_t *mask, uint32_t count, const pbf_collider *colliders);
pbf_status pbf_batch_move_colliders(pbf_batch *batch, const uint8_t *mask, uint32_t count, const double *positions, const double *orientations, double duration);
pbf_status pbf_batch_add_particles(pbf_batch *batch, const uint32_t *counts, const void *positions, const void *velocities);
pbf_status pbf_batch_get_counts(pbf_batch *batch, uint32_t *counts);
pbf_status pbf_batch_read(pbf_batch *batch, const uint8_t *mask, const pbf_read_desc *read, uint64_t world_stride);
pbf_status pbf_batch_export_dlpack(pbf_batch *batch, uint32_t field, uint32_t rows, struct DLManagedTensor * *tensor);
pbf_status pbf_diffuse_init(pbf_solver *solver, pbf_diffuse_desc *desc, uint32_t struct_size);
pbf_status pbf_set_diffuse(pbf_solver *solver, const pbf_diffuse_desc *desc);
pbf_status pbf_get_diffuse(pbf_solver *solver, pbf_diffuse_desc *desc);
pbf_status pbf_get_diffuse_info(pbf_solver *solver, pbf_diffuse_info *info);
pbf_status pbf_read_diffuse(pbf_solver *solver, const pbf_diffuse_read *read);
pbf_status pbf_add_diffuse(pbf_solver *solver, uint32_t count, const void *positions, const void *velocities, const void *lives);
pbf_status pbf_shift_diffuse(pbf_solver *solver, const double *way);
pbf_status pbf_volume_init(pbf_volume *volume, uint32_t struct_size, uint32_t shape);
pbf_status pbf_find_in_volume(pbf_solver *solver, const pbf_volume *volume, uint32_t capacity, uint32_t *ids, uint32_t *count);
pbf_status pbf_measure_volumes(pbf_solver *solver, uint32_t count, const pbf_volume *volumes, pbf_volume_flow *flows);
pbf_status pbf_sample(pbf_solver *solver, const pbf_samples *samples);
pbf_status pbf_sample_on_grid(pbf_solver *solver, const pbf_sample_grid *grid, const pbf_samples *samples);
pbf_status pbf_cast_rays(pbf_solver *solver, uint32_t count, const double *origins, const double *directions, double length, double *distances, double *normals);
pbf_status pbf_get_levels(pbf_solver *solver, uint32_t count, const double *points, double *levels);
pbf_status pbf_end_queries(pbf_solver *solver);
pbf_status pbf_emitter_init(pbf_emitter *emitter, uint32_t struct_size, uint32_t shape);
pbf_status pbf_set_emitters(pbf_solver *solver, uint32_t count, const pbf_emitter *emitters);
pbf_status pbf_get_emitter(pbf_solver *solver, uint32_t index, pbf_emitter *emitter);
pbf_status pbf_set_drains(pbf_solver *solver, uint32_t count, const pbf_volume *drains);
pbf_status pbf_get_drain(pbf_solver *solver, uint32_t index, pbf_volume *drain);
pbf_status pbf_reservoir_init(pbf_reservoir *reservoir, uint32_t struct_size);
pbf_status pbf_set_reservoirs(pbf_solver *solver, uint32_t count, const pbf_reservoir *reservoirs);
pbf_status pbf_get_reservoir_count(pbf_solver *solver, uint32_t *count);
pbf_status pbf_get_reservoir(pbf_solver *solver, uint32_t index, pbf_reservoir *reservoir);
pbf_status pbf_get_in_out(pbf_solver *solver, pbf_in_out *in_out);
pbf_status pbf_phase_init(pbf_phase *phase, uint32_t struct_size);
pbf_status pbf_set_phases(pbf_solver *solver, uint32_t count, const pbf_phase *phases);
pbf_status pbf_get_phase_count(pbf_solver *solver, uint32_t *count);
pbf_status pbf_get_phase(pbf_solver *solver, uint32_t index, pbf_phase *phase);
pbf_status pbf_set_particle_phases(pbf_solver *solver, uint32_t first, uint32_t count, const uint32_t *phases);
pbf_status pbf_get_particle_phases(pbf_solver *solver, uint32_t first, uint32_t count, uint32_t *phases);
pbf_status pbf_shape_from_grid(const pbf_grid_desc *grid, pbf_shape * *shape);
pbf_status pbf_shape_from_mesh(const pbf_mesh_desc *mesh, pbf_shape * *shape);
pbf_status pbf_shape_from_heights(const pbf_heights_desc *heights, pbf_shape * *shape);
pbf_status pbf_shape_from_points(const pbf_hull_desc *hull, pbf_shape * *shape);
pbf_status pbf_hold_shape(pbf_shape *shape);
void pbf_release_shape(pbf_shape *shape);
pbf_status pbf_get_shape_info(pbf_shape *shape, pbf_shape_info *info);
pbf_status pbf_get_shape_distance(pbf_shape *shape, const double *point, double *distance, double *normal);
pbf_status pbf_get_shape_values(pbf_shape *shape, uint64_t count, float *values);
pbf_status pbf_save_shape(pbf_shape *shape, void *buffer, uint64_t *size);
pbf_status pbf_load_shape(const void *buffer, uint64_t size, pbf_shape * *shape);
]]
-- Where the C compiler has each field; spec for the test of this module.
return {
  pbf_allocator = {size = 32, struct_size = 0, reserved = 4, user = 8, allocate = 16, release = 24},
  pbf_desc = {size = 112, struct_size = 0, api_version = 4, dimension = 8, precision = 12, capacity = 16, strict = 20, backend = 24, device = 32, threads = 36, stream = 40, allocator = 48, log = 56, log_user = 64, isa = 72, enqueue_task = 80, finish_task = 88, task_user = 96, determinism = 104, reserved = 108},
  pbf_params = {size = 592, struct_size = 0, kernel = 4, smoothing_radius = 8, spacing = 16, particle_volume = 24, time_step = 32, iterations = 40, collide = 44, gravity = 48, attraction = 72, attraction_center = 80, over_relaxation = 104, cfm = 112, cohesion = 120, min_diagonal = 128, wall_density = 136, scorr_k = 144, scorr_dq = 152, scorr_n = 160, solver = 164, vorticity = 168, viscosity = 176, domain_min = 184, domain_max = 208, wall_velocity = 232, wall_amplitude = 280, wall_frequency = 328, wall_phase = 376, search_cell_width = 424, sleep_speed = 432, sleep_time = 440, tolerance = 448, pressure_grid = 456, prestabilization = 464, damping_compensation = 472, angular_momentum_correction = 480, drag = 488, drag_velocity = 496, max_depenetration_speed = 520, max_substeps = 528, loads = 532, shear_stress_correction = 536, wall_friction = 544, wall_static_friction = 552, wall_no_slip = 560, surface_tension = 568, periodic = 576, reserved = 580, wall_adhesion = 584},
  pbf_collider = {size = 336, struct_size = 0, shape = 4, inverted = 8, path = 12, position = 16, orientation = 40, velocity = 72, angular_velocity = 96, axis = 120, half_extents = 144, radius = 168, half_length = 176, half_extents_rate = 184, radius_rate = 208, half_length_rate = 216, duration = 224, geometry = 232, scale = 240, scale_rate = 248, friction = 256, static_friction = 264, no_slip = 272, adhesion = 280, last_velocity = 288, last_angular_velocity = 312},
  pbf_collider_load = {size = 128, struct_size = 0, contacts = 4, impulse = 8, angular_impulse = 32, impulse_sum = 56, angular_impulse_sum = 80, time_sum = 104, penetration = 112, wetted_area = 120},
  pbf_read_desc = {size = 80, struct_size = 0, field = 4, first = 8, count = 12, element_type = 16, components = 20, w = 24, order = 28, stride = 32, data = 40, behind = 48, w_value = 56, device_type = 64, reserved = 68, stream = 72},
  pbf_write_desc = {size = 56, struct_size = 0, field = 4, first = 8, count = 12, element_type = 16, components = 20, stride = 24, data = 32, device_type = 40, reserved = 44, stream = 48},
  pbf_view = {size = 72, struct_size = 0, field = 4, device_type = 8, device_id = 12, element_type = 16, components = 20, count = 24, reserved = 28, particle_stride = 32, component_stride = 40, generation = 48, data = 56, ids = 64},
  pbf_snapshot = {size = 64, struct_size = 0, count = 4, dimension = 8, element_type = 12, step = 16, time = 24, positions = 32, velocities = 40, ids = 48, owner = 56},
  pbf_anisotropy_desc = {size = 64, struct_size = 0, first = 4, count = 8, min_neighbors = 12, radius = 16, smoothing = 24, max_ratio = 32, lone_scale = 40, positions = 48, stretches = 56},
  pbf_stats = {size = 184, struct_size = 0, count = 4, iterations = 8, neighbors_max = 12, neighbors_mean = 16, center_of_mass = 24, position_min = 48, position_max = 72, momentum = 96, kinetic_energy = 120, speed_max = 128, density_error_mean = 136, density_error_max = 144, density_mean = 152, asleep = 160, squeezed = 164, step_limit = 168, limited_by = 176, substeps = 180},
  pbf_stage_time = {size = 48, name = 0, milliseconds = 32, runs = 40},
  pbf_timings = {size = 1160, struct_size = 0, stage_count = 4, stages = 8},
  pbf_plan_stage = {size = 40, name = 0, runs_per_step = 32, launches_per_step = 36},
  pbf_plan_array = {size = 48, name = 0, bytes_per_particle = 32, bytes = 40},
  pbf_plan = {size = 2976, struct_size = 0, stage_count = 4, array_count = 8, reserved = 12, variant = 16, bytes_per_particle = 80, bytes = 88, stages = 96, arrays = 1056},
  pbf_backend_info = {size = 752, struct_size = 0, available = 4, score = 8, device_type = 12, name = 16, device_name = 48, build_id = 144, path = 240, reason = 496},
  pbf_info = {size = 784, struct_size = 0, dimension = 4, precision = 8, capacity = 12, threads = 16, device = 20, device_type = 24, fell_back = 28, step = 32, time = 40, backend = 48, device_name = 80, build_id = 176, path = 272, fallback_reason = 528},
  pbf_batch_info = {size = 16, struct_size = 0, worlds = 4, threads = 8, device_type = 12},
  pbf_diffuse_desc = {size = 136, struct_size = 0, capacity = 4, seed = 8, interval = 12, foam_neighbors = 16, bubble_neighbors = 20, trapped_air_min = 24, trapped_air_max = 32, wave_crest_min = 40, wave_crest_max = 48, energy_min = 56, energy_max = 64, trapped_air_rate = 72, wave_crest_rate = 80, lifetime_min = 88, lifetime_max = 96, buoyancy = 104, bubble_drag = 112, spray_drag = 120, scatter = 128},
  pbf_diffuse_info = {size = 56, struct_size = 0, capacity = 4, count = 8, spray = 12, foam = 16, bubbles = 20, time = 24, generated = 32, expired = 40, recycled = 48},
  pbf_diffuse_read = {size = 80, struct_size = 0, first = 4, count = 8, element_type = 12, components = 16, reserved = 20, stride = 24, positions = 32, velocities = 40, ages = 48, lives = 56, kinds = 64, ids = 72},
  pbf_volume = {size = 128, struct_size = 0, shape = 4, position = 8, orientation = 32, half_extents = 64, axis = 88, radius = 112, half_length = 120},
  pbf_volume_flow = {size = 72, struct_size = 0, reserved = 4, volume = 8, fraction = 16, centre = 24, velocity = 48},
  pbf_samples = {size = 48, struct_size = 0, count = 4, points = 8, densities = 16, velocities = 24, pressures = 32, wet = 40},
  pbf_sample_grid = {size = 64, struct_size = 0, counts = 4, origin = 16, step = 40},
  pbf_emitter = {size = 144, struct_size = 0, shape = 4, recycle = 8, seed = 12, position = 16, velocity = 40, across = 64, half_width = 88, half_height = 96, radius = 104, rate = 112, jitter = 120, lifetime = 128, phase = 136, reserved = 140},
  pbf_reservoir = {size = 120, struct_size = 0, phase = 4, position = 8, orientation = 32, half_extents = 64, depth = 88, pressure = 96, added = 104, removed = 112},
  pbf_in_out = {size = 56, struct_size = 0, emitters = 4, drains = 8, reserved = 12, emitted = 16, refused = 24, recycled = 32, drained = 40, expired = 48},
  pbf_phase = {size = 24, struct_size = 0, user = 4, rest_density = 8, viscosity = 16},
  pbf_grid_desc = {size = 64, struct_size = 0, dimension = 4, nodes = 8, reserved = 20, origin = 24, cell = 48, values = 56},
  pbf_mesh_desc = {size = 48, struct_size = 0, dimension = 4, vertex_count = 8, face_count = 12, vertices = 16, faces = 24, cell = 32, thickness = 40},
  pbf_heights_desc = {size = 48, struct_size = 0, dimension = 4, count = 8, heights = 16, spacing = 24, base = 32, cell = 40},
  pbf_hull_desc = {size = 32, struct_size = 0, dimension = 4, point_count = 8, reserved = 12, points = 16, cell = 24},
  pbf_shape_info = {size = 136, struct_size = 0, dimension = 4, nodes = 8, references = 20, origin = 24, cell = 48, lower = 56, upper = 80, volume = 104, area = 112, bytes = 120, hash = 128},
}
