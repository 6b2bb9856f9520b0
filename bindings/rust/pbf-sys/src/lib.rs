//! The C API of pbf (`include/pbf/all.h`), which says what each of these is. Written by tools/bindings.py from bindings/abi.json; do not edit.
#![allow(non_camel_case_types)]

use std::os::raw::{c_char, c_void};

/// A code: [`PBF_OK`] or one of `PBF_ERROR_…`.
pub type pbf_status = i32;

pub const PBF_VERSION_MAJOR: u32 = 0;
pub const PBF_VERSION_MINOR: u32 = 2;
pub const PBF_VERSION_PATCH: u32 = 0;
pub const PBF_API_VERSION: u32 = 2;
pub const PBF_NAME_SIZE: u32 = 32;
pub const PBF_MAX_CAPACITY: u32 = 1073741823;
pub const PBF_MAX_COLLIDERS: u32 = 4096;
pub const PBF_MAX_SNAPSHOTS: u32 = 16;
pub const PBF_MAX_STAGES: u32 = 24;
pub const PBF_MAX_ARRAYS: u32 = 40;
pub const PBF_MAX_WORLDS: u32 = 65536;
pub const PBF_MAX_DIFFUSE: u32 = 4194303;
pub const PBF_MAX_EMITTERS: u32 = 64;
pub const PBF_MAX_DRAINS: u32 = 64;
pub const PBF_MAX_RESERVOIRS: u32 = 64;
pub const PBF_MAX_PHASES: u32 = 8;
pub const PBF_OK: pbf_status = 0;
pub const PBF_ERROR_INVALID_ARGUMENT: pbf_status = -1;
pub const PBF_ERROR_STRUCT_SIZE: pbf_status = -2;
pub const PBF_ERROR_OUT_OF_MEMORY: pbf_status = -3;
pub const PBF_ERROR_CAPACITY: pbf_status = -4;
pub const PBF_ERROR_NOT_FOUND: pbf_status = -5;
pub const PBF_ERROR_UNAVAILABLE: pbf_status = -6;
pub const PBF_ERROR_UNSUPPORTED: pbf_status = -7;
pub const PBF_ERROR_BUSY: pbf_status = -8;
pub const PBF_ERROR_STATE: pbf_status = -9;
pub const PBF_ERROR_DEVICE: pbf_status = -10;
pub const PBF_ERROR_PLUGIN: pbf_status = -11;
pub const PBF_ERROR_DATA: pbf_status = -12;
pub const PBF_ERROR_CANCELLED: pbf_status = -13;
pub const PBF_DEVICE_CPU: u32 = 1;
pub const PBF_DEVICE_CUDA: u32 = 2;
pub const PBF_TYPE_FLOAT32: u32 = 4;
pub const PBF_TYPE_FLOAT64: u32 = 8;
pub const PBF_TYPE_UINT32: u32 = 12;
pub const PBF_FIELD_POSITION: u32 = 1;
pub const PBF_FIELD_VELOCITY: u32 = 2;
pub const PBF_FIELD_ID: u32 = 3;
pub const PBF_FIELD_DENSITY: u32 = 4;
pub const PBF_FIELD_PRESSURE: u32 = 5;
pub const PBF_FLOAT32: u32 = 4;
pub const PBF_FLOAT64: u32 = 8;
pub const PBF_DETERMINISM_ACROSS_MACHINES: u32 = 0;
pub const PBF_DETERMINISM_PER_MACHINE: u32 = 1;
pub const PBF_LOG_INFO: u32 = 1;
pub const PBF_LOG_WARNING: u32 = 2;
pub const PBF_KERNEL_WENDLAND_C2: u32 = 0;
pub const PBF_KERNEL_POLY6_SPIKY: u32 = 1;
pub const PBF_SOLVER_JACOBI: u32 = 0;
pub const PBF_SOLVER_CHEBYSHEV: u32 = 1;
pub const PBF_COLLIDE_AFTER_PREDICTION: u32 = 1;
pub const PBF_COLLIDE_IN_ITERATION: u32 = 2;
pub const PBF_COLLIDE_AFTER_SOLVE: u32 = 4;
pub const PBF_PERIODIC_X: u32 = 1;
pub const PBF_PERIODIC_Y: u32 = 2;
pub const PBF_PERIODIC_Z: u32 = 4;
pub const PBF_WALL_X_MIN: u32 = 0;
pub const PBF_WALL_X_MAX: u32 = 1;
pub const PBF_WALL_Y_MIN: u32 = 2;
pub const PBF_WALL_Y_MAX: u32 = 3;
pub const PBF_WALL_Z_MIN: u32 = 4;
pub const PBF_WALL_Z_MAX: u32 = 5;
pub const PBF_COLLIDER_PLANE: u32 = 0;
pub const PBF_COLLIDER_SPHERE: u32 = 1;
pub const PBF_COLLIDER_CAPSULE: u32 = 2;
pub const PBF_COLLIDER_BOX: u32 = 3;
pub const PBF_COLLIDER_SHAPE: u32 = 4;
pub const PBF_PATH_AUTO: u32 = 0;
pub const PBF_PATH_STRAIGHT: u32 = 1;
pub const PBF_PATH_SCREW: u32 = 2;
pub const PBF_W_CONSTANT: u32 = 0;
pub const PBF_W_SPEED: u32 = 1;
pub const PBF_W_DENSITY: u32 = 2;
pub const PBF_W_PRESSURE: u32 = 3;
pub const PBF_ORDER_ADDED: u32 = 0;
pub const PBF_ORDER_STORED: u32 = 1;
pub const PBF_LIMIT_NONE: u32 = 0;
pub const PBF_LIMIT_GRAVITY: u32 = 1;
pub const PBF_LIMIT_ATTRACTION: u32 = 2;
pub const PBF_LIMIT_PARTICLES: u32 = 3;
pub const PBF_LIMIT_WALLS: u32 = 4;
pub const PBF_LIMIT_COLLIDERS: u32 = 5;
pub const PBF_LIMIT_TENSION: u32 = 6;
pub const PBF_DIFFUSE_SPRAY: u32 = 0;
pub const PBF_DIFFUSE_FOAM: u32 = 1;
pub const PBF_DIFFUSE_BUBBLE: u32 = 2;
pub const PBF_VOLUME_BOX: u32 = 0;
pub const PBF_VOLUME_SPHERE: u32 = 1;
pub const PBF_VOLUME_CAPSULE: u32 = 2;
pub const PBF_EMITTER_RECTANGLE: u32 = 0;
pub const PBF_EMITTER_DISC: u32 = 1;

#[repr(C)]
pub struct DLManagedTensor {
    _opaque: [u8; 0],
    _not_send: std::marker::PhantomData<*mut u8>,
}

#[repr(C)]
pub struct pbf_batch {
    _opaque: [u8; 0],
    _not_send: std::marker::PhantomData<*mut u8>,
}

#[repr(C)]
pub struct pbf_shape {
    _opaque: [u8; 0],
    _not_send: std::marker::PhantomData<*mut u8>,
}

#[repr(C)]
pub struct pbf_solver {
    _opaque: [u8; 0],
    _not_send: std::marker::PhantomData<*mut u8>,
}

pub type pbf_log_fn =
    Option<unsafe extern "C" fn(*mut c_void, i32, *const c_char)>;

pub type pbf_task_fn =
    Option<unsafe extern "C" fn(*mut c_void, u32, u32)>;

pub type pbf_enqueue_task_fn =
    Option<unsafe extern "C" fn(*mut c_void, pbf_task_fn, *mut c_void, u32, u32) -> *mut c_void>;

pub type pbf_finish_task_fn =
    Option<unsafe extern "C" fn(*mut c_void, *mut c_void)>;

pub type pbf_allocator_allocate_fn =
    Option<unsafe extern "C" fn(*mut c_void, u64, u64) -> *mut c_void>;

pub type pbf_allocator_release_fn =
    Option<unsafe extern "C" fn(*mut c_void, *mut c_void, u64, u64)>;

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_allocator {
    pub struct_size: u32,
    pub reserved: u32,
    pub user: *mut c_void,
    pub allocate: pbf_allocator_allocate_fn,
    pub release: pbf_allocator_release_fn,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_desc {
    pub struct_size: u32,
    pub api_version: u32,
    pub dimension: u32,
    pub precision: u32,
    pub capacity: u32,
    pub strict: u32,
    pub backend: *const c_char,
    pub device: i32,
    pub threads: u32,
    pub stream: *mut c_void,
    pub allocator: *const pbf_allocator,
    pub log: pbf_log_fn,
    pub log_user: *mut c_void,
    pub isa: *const c_char,
    pub enqueue_task: pbf_enqueue_task_fn,
    pub finish_task: pbf_finish_task_fn,
    pub task_user: *mut c_void,
    pub determinism: u32,
    pub reserved: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_params {
    pub struct_size: u32,
    pub kernel: u32,
    pub smoothing_radius: f64,
    pub spacing: f64,
    pub particle_volume: f64,
    pub time_step: f64,
    pub iterations: u32,
    pub collide: u32,
    pub gravity: [f64; 3],
    pub attraction: f64,
    pub attraction_center: [f64; 3],
    pub over_relaxation: f64,
    pub cfm: f64,
    pub cohesion: f64,
    pub min_diagonal: f64,
    pub wall_density: f64,
    pub scorr_k: f64,
    pub scorr_dq: f64,
    pub scorr_n: u32,
    pub solver: u32,
    pub vorticity: f64,
    pub viscosity: f64,
    pub domain_min: [f64; 3],
    pub domain_max: [f64; 3],
    pub wall_velocity: [f64; 6],
    pub wall_amplitude: [f64; 6],
    pub wall_frequency: [f64; 6],
    pub wall_phase: [f64; 6],
    pub search_cell_width: f64,
    pub sleep_speed: f64,
    pub sleep_time: f64,
    pub tolerance: f64,
    pub pressure_grid: f64,
    pub prestabilization: f64,
    pub damping_compensation: f64,
    pub angular_momentum_correction: f64,
    pub drag: f64,
    pub drag_velocity: [f64; 3],
    pub max_depenetration_speed: f64,
    pub max_substeps: u32,
    pub loads: u32,
    pub shear_stress_correction: f64,
    pub wall_friction: f64,
    pub wall_static_friction: f64,
    pub wall_no_slip: f64,
    pub surface_tension: f64,
    pub periodic: u32,
    pub reserved: u32,
    pub wall_adhesion: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_collider {
    pub struct_size: u32,
    pub shape: u32,
    pub inverted: u32,
    pub path: u32,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    pub velocity: [f64; 3],
    pub angular_velocity: [f64; 3],
    pub axis: [f64; 3],
    pub half_extents: [f64; 3],
    pub radius: f64,
    pub half_length: f64,
    pub half_extents_rate: [f64; 3],
    pub radius_rate: f64,
    pub half_length_rate: f64,
    pub duration: f64,
    pub geometry: *mut pbf_shape,
    pub scale: f64,
    pub scale_rate: f64,
    pub friction: f64,
    pub static_friction: f64,
    pub no_slip: f64,
    pub adhesion: f64,
    pub last_velocity: [f64; 3],
    pub last_angular_velocity: [f64; 3],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_collider_load {
    pub struct_size: u32,
    pub contacts: u32,
    pub impulse: [f64; 3],
    pub angular_impulse: [f64; 3],
    pub impulse_sum: [f64; 3],
    pub angular_impulse_sum: [f64; 3],
    pub time_sum: f64,
    pub penetration: f64,
    pub wetted_area: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_read_desc {
    pub struct_size: u32,
    pub field: u32,
    pub first: u32,
    pub count: u32,
    pub element_type: u32,
    pub components: u32,
    pub w: u32,
    pub order: u32,
    pub stride: u64,
    pub data: *mut c_void,
    pub behind: f64,
    pub w_value: f64,
    pub device_type: u32,
    pub reserved: u32,
    pub stream: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_write_desc {
    pub struct_size: u32,
    pub field: u32,
    pub first: u32,
    pub count: u32,
    pub element_type: u32,
    pub components: u32,
    pub stride: u64,
    pub data: *const c_void,
    pub device_type: u32,
    pub reserved: u32,
    pub stream: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_view {
    pub struct_size: u32,
    pub field: u32,
    pub device_type: u32,
    pub device_id: i32,
    pub element_type: u32,
    pub components: u32,
    pub count: u32,
    pub reserved: u32,
    pub particle_stride: i64,
    pub component_stride: i64,
    pub generation: u64,
    pub data: *const c_void,
    pub ids: *const u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_snapshot {
    pub struct_size: u32,
    pub count: u32,
    pub dimension: u32,
    pub element_type: u32,
    pub step: u64,
    pub time: f64,
    pub positions: *const c_void,
    pub velocities: *const c_void,
    pub ids: *const u32,
    pub owner: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_anisotropy_desc {
    pub struct_size: u32,
    pub first: u32,
    pub count: u32,
    pub min_neighbors: u32,
    pub radius: f64,
    pub smoothing: f64,
    pub max_ratio: f64,
    pub lone_scale: f64,
    pub positions: *mut c_void,
    pub stretches: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_stats {
    pub struct_size: u32,
    pub count: u32,
    pub iterations: u32,
    pub neighbors_max: u32,
    pub neighbors_mean: f64,
    pub center_of_mass: [f64; 3],
    pub position_min: [f64; 3],
    pub position_max: [f64; 3],
    pub momentum: [f64; 3],
    pub kinetic_energy: f64,
    pub speed_max: f64,
    pub density_error_mean: f64,
    pub density_error_max: f64,
    pub density_mean: f64,
    pub asleep: u32,
    pub squeezed: u32,
    pub step_limit: f64,
    pub limited_by: u32,
    pub substeps: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_stage_time {
    pub name: [c_char; 32],
    pub milliseconds: f64,
    pub runs: u64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_timings {
    pub struct_size: u32,
    pub stage_count: u32,
    pub stages: [pbf_stage_time; 24],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_plan_stage {
    pub name: [c_char; 32],
    pub runs_per_step: u32,
    pub launches_per_step: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_plan_array {
    pub name: [c_char; 32],
    pub bytes_per_particle: f64,
    pub bytes: u64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_plan {
    pub struct_size: u32,
    pub stage_count: u32,
    pub array_count: u32,
    pub reserved: u32,
    pub variant: [c_char; 64],
    pub bytes_per_particle: f64,
    pub bytes: u64,
    pub stages: [pbf_plan_stage; 24],
    pub arrays: [pbf_plan_array; 40],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_backend_info {
    pub struct_size: u32,
    pub available: u32,
    pub score: i32,
    pub device_type: u32,
    pub name: [c_char; 32],
    pub device_name: [c_char; 96],
    pub build_id: [c_char; 96],
    pub path: [c_char; 256],
    pub reason: [c_char; 256],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_info {
    pub struct_size: u32,
    pub dimension: u32,
    pub precision: u32,
    pub capacity: u32,
    pub threads: u32,
    pub device: i32,
    pub device_type: u32,
    pub fell_back: u32,
    pub step: u64,
    pub time: f64,
    pub backend: [c_char; 32],
    pub device_name: [c_char; 96],
    pub build_id: [c_char; 96],
    pub path: [c_char; 256],
    pub fallback_reason: [c_char; 256],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_batch_info {
    pub struct_size: u32,
    pub worlds: u32,
    pub threads: u32,
    pub device_type: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_diffuse_desc {
    pub struct_size: u32,
    pub capacity: u32,
    pub seed: u32,
    pub interval: u32,
    pub foam_neighbors: u32,
    pub bubble_neighbors: u32,
    pub trapped_air_min: f64,
    pub trapped_air_max: f64,
    pub wave_crest_min: f64,
    pub wave_crest_max: f64,
    pub energy_min: f64,
    pub energy_max: f64,
    pub trapped_air_rate: f64,
    pub wave_crest_rate: f64,
    pub lifetime_min: f64,
    pub lifetime_max: f64,
    pub buoyancy: f64,
    pub bubble_drag: f64,
    pub spray_drag: f64,
    pub scatter: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_diffuse_info {
    pub struct_size: u32,
    pub capacity: u32,
    pub count: u32,
    pub spray: u32,
    pub foam: u32,
    pub bubbles: u32,
    pub time: f64,
    pub generated: u64,
    pub expired: u64,
    pub recycled: u64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_diffuse_read {
    pub struct_size: u32,
    pub first: u32,
    pub count: u32,
    pub element_type: u32,
    pub components: u32,
    pub reserved: u32,
    pub stride: u64,
    pub positions: *mut c_void,
    pub velocities: *mut c_void,
    pub ages: *mut c_void,
    pub lives: *mut c_void,
    pub kinds: *mut u32,
    pub ids: *mut u64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_volume {
    pub struct_size: u32,
    pub shape: u32,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    pub half_extents: [f64; 3],
    pub axis: [f64; 3],
    pub radius: f64,
    pub half_length: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_volume_flow {
    pub struct_size: u32,
    pub reserved: u32,
    pub volume: f64,
    pub fraction: f64,
    pub centre: [f64; 3],
    pub velocity: [f64; 3],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_samples {
    pub struct_size: u32,
    pub count: u32,
    pub points: *const f64,
    pub densities: *mut f64,
    pub velocities: *mut f64,
    pub pressures: *mut f64,
    pub wet: *mut u8,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_sample_grid {
    pub struct_size: u32,
    pub counts: [u32; 3],
    pub origin: [f64; 3],
    pub step: [f64; 3],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_emitter {
    pub struct_size: u32,
    pub shape: u32,
    pub recycle: u32,
    pub seed: u32,
    pub position: [f64; 3],
    pub velocity: [f64; 3],
    pub across: [f64; 3],
    pub half_width: f64,
    pub half_height: f64,
    pub radius: f64,
    pub rate: f64,
    pub jitter: f64,
    pub lifetime: f64,
    pub phase: u32,
    pub reserved: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_reservoir {
    pub struct_size: u32,
    pub phase: u32,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    pub half_extents: [f64; 3],
    pub depth: f64,
    pub pressure: f64,
    pub added: u64,
    pub removed: u64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_in_out {
    pub struct_size: u32,
    pub emitters: u32,
    pub drains: u32,
    pub reserved: u32,
    pub emitted: u64,
    pub refused: u64,
    pub recycled: u64,
    pub drained: u64,
    pub expired: u64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_phase {
    pub struct_size: u32,
    pub user: u32,
    pub rest_density: f64,
    pub viscosity: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_grid_desc {
    pub struct_size: u32,
    pub dimension: u32,
    pub nodes: [u32; 3],
    pub reserved: u32,
    pub origin: [f64; 3],
    pub cell: f64,
    pub values: *const f32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_mesh_desc {
    pub struct_size: u32,
    pub dimension: u32,
    pub vertex_count: u32,
    pub face_count: u32,
    pub vertices: *const f64,
    pub faces: *const u32,
    pub cell: f64,
    pub thickness: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_heights_desc {
    pub struct_size: u32,
    pub dimension: u32,
    pub count: [u32; 2],
    pub heights: *const f64,
    pub spacing: f64,
    pub base: f64,
    pub cell: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_hull_desc {
    pub struct_size: u32,
    pub dimension: u32,
    pub point_count: u32,
    pub reserved: u32,
    pub points: *const f64,
    pub cell: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pbf_shape_info {
    pub struct_size: u32,
    pub dimension: u32,
    pub nodes: [u32; 3],
    pub references: u32,
    pub origin: [f64; 3],
    pub cell: f64,
    pub lower: [f64; 3],
    pub upper: [f64; 3],
    pub volume: f64,
    pub area: f64,
    pub bytes: u64,
    pub hash: u64,
}

extern "C" {
    pub fn pbf_status_string(
        status: pbf_status,
    ) -> *const c_char;
    pub fn pbf_last_error() -> *const c_char;
    pub fn pbf_desc_init(
        desc: *mut pbf_desc,
        struct_size: u32,
    ) -> pbf_status;
    pub fn pbf_params_init(
        params: *mut pbf_params,
        struct_size: u32,
    ) -> pbf_status;
    pub fn pbf_set_params(
        solver: *mut pbf_solver,
        params: *const pbf_params,
    ) -> pbf_status;
    pub fn pbf_get_params(
        solver: *mut pbf_solver,
        params: *mut pbf_params,
    ) -> pbf_status;
    pub fn pbf_collider_init(
        collider: *mut pbf_collider,
        struct_size: u32,
        shape: u32,
    ) -> pbf_status;
    pub fn pbf_set_colliders(
        solver: *mut pbf_solver,
        count: u32,
        colliders: *const pbf_collider,
    ) -> pbf_status;
    pub fn pbf_move_colliders(
        solver: *mut pbf_solver,
        count: u32,
        targets: *const pbf_collider,
        duration: f64,
    ) -> pbf_status;
    pub fn pbf_get_collider_count(
        solver: *mut pbf_solver,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_get_collider(
        solver: *mut pbf_solver,
        index: u32,
        collider: *mut pbf_collider,
    ) -> pbf_status;
    pub fn pbf_get_collider_loads(
        solver: *mut pbf_solver,
        count: u32,
        loads: *mut pbf_collider_load,
    ) -> pbf_status;
    pub fn pbf_get_wall_loads(
        solver: *mut pbf_solver,
        count: u32,
        loads: *mut pbf_collider_load,
    ) -> pbf_status;
    pub fn pbf_read(
        solver: *mut pbf_solver,
        read: *const pbf_read_desc,
    ) -> pbf_status;
    pub fn pbf_write(
        solver: *mut pbf_solver,
        write: *const pbf_write_desc,
    ) -> pbf_status;
    pub fn pbf_keep_previous(
        solver: *mut pbf_solver,
        enabled: u32,
    ) -> pbf_status;
    pub fn pbf_map(
        solver: *mut pbf_solver,
        field: u32,
        view: *mut pbf_view,
    ) -> pbf_status;
    pub fn pbf_unmap(
        solver: *mut pbf_solver,
        field: u32,
    ) -> pbf_status;
    pub fn pbf_export_dlpack(
        solver: *mut pbf_solver,
        field: u32,
        tensor: *mut *mut DLManagedTensor,
    ) -> pbf_status;
    pub fn pbf_set_snapshots(
        solver: *mut pbf_solver,
        snapshots: u32,
    ) -> pbf_status;
    pub fn pbf_acquire_snapshot(
        solver: *mut pbf_solver,
        snapshot: *mut pbf_snapshot,
    ) -> pbf_status;
    pub fn pbf_release_snapshot(
        snapshot: *mut pbf_snapshot,
    ) -> pbf_status;
    pub fn pbf_get_anisotropies(
        solver: *mut pbf_solver,
        anisotropy: *const pbf_anisotropy_desc,
    ) -> pbf_status;
    pub fn pbf_get_stats(
        solver: *mut pbf_solver,
        stats: *mut pbf_stats,
    ) -> pbf_status;
    pub fn pbf_get_step_limit(
        solver: *mut pbf_solver,
        limit: *mut f64,
    ) -> pbf_status;
    pub fn pbf_set_timing(
        solver: *mut pbf_solver,
        enabled: u32,
    ) -> pbf_status;
    pub fn pbf_get_timings(
        solver: *mut pbf_solver,
        timings: *mut pbf_timings,
    ) -> pbf_status;
    pub fn pbf_get_plan(
        solver: *mut pbf_solver,
        plan: *mut pbf_plan,
    ) -> pbf_status;
    pub fn pbf_get_backend_count(
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_get_backend_info(
        desc: *const pbf_desc,
        index: u32,
        info: *mut pbf_backend_info,
    ) -> pbf_status;
    pub fn pbf_load_backend(
        path: *const c_char,
    ) -> pbf_status;
    pub fn pbf_version() -> u32;
    pub fn pbf_create(
        desc: *const pbf_desc,
        params: *const pbf_params,
        solver: *mut *mut pbf_solver,
    ) -> pbf_status;
    pub fn pbf_destroy(
        solver: *mut pbf_solver,
    );
    pub fn pbf_step(
        solver: *mut pbf_solver,
        steps: u32,
    ) -> pbf_status;
    pub fn pbf_begin_step(
        solver: *mut pbf_solver,
        steps: u32,
    ) -> pbf_status;
    pub fn pbf_end_step(
        solver: *mut pbf_solver,
    ) -> pbf_status;
    pub fn pbf_cancel(
        solver: *mut pbf_solver,
    ) -> pbf_status;
    pub fn pbf_synchronize(
        solver: *mut pbf_solver,
    ) -> pbf_status;
    pub fn pbf_get_info(
        solver: *mut pbf_solver,
        info: *mut pbf_info,
    ) -> pbf_status;
    pub fn pbf_get_count(
        solver: *mut pbf_solver,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_add_particles(
        solver: *mut pbf_solver,
        count: u32,
        positions: *const c_void,
        velocities: *const c_void,
        first_id: *mut u32,
    ) -> pbf_status;
    pub fn pbf_remove_particles(
        solver: *mut pbf_solver,
        count: u32,
        ids: *const u32,
    ) -> pbf_status;
    pub fn pbf_remove_in_box(
        solver: *mut pbf_solver,
        lower: *const f64,
        upper: *const f64,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_find_in_box(
        solver: *mut pbf_solver,
        lower: *const f64,
        upper: *const f64,
        room: u32,
        ids: *mut u32,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_get_positions(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        positions: *mut c_void,
    ) -> pbf_status;
    pub fn pbf_set_positions(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        positions: *const c_void,
    ) -> pbf_status;
    pub fn pbf_get_velocities(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        velocities: *mut c_void,
    ) -> pbf_status;
    pub fn pbf_set_velocities(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        velocities: *const c_void,
    ) -> pbf_status;
    pub fn pbf_get_ids(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        ids: *mut u32,
    ) -> pbf_status;
    pub fn pbf_get_densities(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        densities: *mut c_void,
    ) -> pbf_status;
    pub fn pbf_set_accelerations(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        accelerations: *const c_void,
    ) -> pbf_status;
    pub fn pbf_get_pressures(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        pressures: *mut c_void,
    ) -> pbf_status;
    pub fn pbf_save(
        solver: *mut pbf_solver,
        buffer: *mut c_void,
        size: *mut u64,
    ) -> pbf_status;
    pub fn pbf_load(
        solver: *mut pbf_solver,
        buffer: *const c_void,
        size: u64,
    ) -> pbf_status;
    pub fn pbf_hash(
        solver: *mut pbf_solver,
        hash: *mut u64,
    ) -> pbf_status;
    pub fn pbf_batch_create(
        desc: *const pbf_desc,
        params: *const pbf_params,
        worlds: u32,
        batch: *mut *mut pbf_batch,
    ) -> pbf_status;
    pub fn pbf_batch_destroy(
        batch: *mut pbf_batch,
    );
    pub fn pbf_batch_get_info(
        batch: *mut pbf_batch,
        info: *mut pbf_batch_info,
    ) -> pbf_status;
    pub fn pbf_batch_get_world(
        batch: *mut pbf_batch,
        world: u32,
        solver: *mut *mut pbf_solver,
    ) -> pbf_status;
    pub fn pbf_batch_get_statuses(
        batch: *mut pbf_batch,
        statuses: *mut pbf_status,
    ) -> pbf_status;
    pub fn pbf_batch_get_sentence(
        batch: *mut pbf_batch,
        world: u32,
        sentence: *mut *const c_char,
    ) -> pbf_status;
    pub fn pbf_batch_step(
        batch: *mut pbf_batch,
        mask: *const u8,
        steps: u32,
    ) -> pbf_status;
    pub fn pbf_batch_set_start(
        batch: *mut pbf_batch,
        mask: *const u8,
        state: *const c_void,
        size: u64,
    ) -> pbf_status;
    pub fn pbf_batch_reset(
        batch: *mut pbf_batch,
        mask: *const u8,
    ) -> pbf_status;
    pub fn pbf_batch_set_gravity(
        batch: *mut pbf_batch,
        mask: *const u8,
        gravity: *const f64,
    ) -> pbf_status;
    pub fn pbf_batch_set_colliders(
        batch: *mut pbf_batch,
        mask: *const u8,
        count: u32,
        colliders: *const pbf_collider,
    ) -> pbf_status;
    pub fn pbf_batch_move_colliders(
        batch: *mut pbf_batch,
        mask: *const u8,
        count: u32,
        positions: *const f64,
        orientations: *const f64,
        duration: f64,
    ) -> pbf_status;
    pub fn pbf_batch_add_particles(
        batch: *mut pbf_batch,
        counts: *const u32,
        positions: *const c_void,
        velocities: *const c_void,
    ) -> pbf_status;
    pub fn pbf_batch_get_counts(
        batch: *mut pbf_batch,
        counts: *mut u32,
    ) -> pbf_status;
    pub fn pbf_batch_read(
        batch: *mut pbf_batch,
        mask: *const u8,
        read: *const pbf_read_desc,
        world_stride: u64,
    ) -> pbf_status;
    pub fn pbf_batch_export_dlpack(
        batch: *mut pbf_batch,
        field: u32,
        rows: u32,
        tensor: *mut *mut DLManagedTensor,
    ) -> pbf_status;
    pub fn pbf_diffuse_init(
        solver: *mut pbf_solver,
        desc: *mut pbf_diffuse_desc,
        struct_size: u32,
    ) -> pbf_status;
    pub fn pbf_set_diffuse(
        solver: *mut pbf_solver,
        desc: *const pbf_diffuse_desc,
    ) -> pbf_status;
    pub fn pbf_get_diffuse(
        solver: *mut pbf_solver,
        desc: *mut pbf_diffuse_desc,
    ) -> pbf_status;
    pub fn pbf_get_diffuse_info(
        solver: *mut pbf_solver,
        info: *mut pbf_diffuse_info,
    ) -> pbf_status;
    pub fn pbf_read_diffuse(
        solver: *mut pbf_solver,
        read: *const pbf_diffuse_read,
    ) -> pbf_status;
    pub fn pbf_add_diffuse(
        solver: *mut pbf_solver,
        count: u32,
        positions: *const c_void,
        velocities: *const c_void,
        lives: *const c_void,
    ) -> pbf_status;
    pub fn pbf_shift_diffuse(
        solver: *mut pbf_solver,
        way: *const f64,
    ) -> pbf_status;
    pub fn pbf_volume_init(
        volume: *mut pbf_volume,
        struct_size: u32,
        shape: u32,
    ) -> pbf_status;
    pub fn pbf_find_in_volume(
        solver: *mut pbf_solver,
        volume: *const pbf_volume,
        capacity: u32,
        ids: *mut u32,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_measure_volumes(
        solver: *mut pbf_solver,
        count: u32,
        volumes: *const pbf_volume,
        flows: *mut pbf_volume_flow,
    ) -> pbf_status;
    pub fn pbf_sample(
        solver: *mut pbf_solver,
        samples: *const pbf_samples,
    ) -> pbf_status;
    pub fn pbf_sample_on_grid(
        solver: *mut pbf_solver,
        grid: *const pbf_sample_grid,
        samples: *const pbf_samples,
    ) -> pbf_status;
    pub fn pbf_cast_rays(
        solver: *mut pbf_solver,
        count: u32,
        origins: *const f64,
        directions: *const f64,
        length: f64,
        distances: *mut f64,
        normals: *mut f64,
    ) -> pbf_status;
    pub fn pbf_get_levels(
        solver: *mut pbf_solver,
        count: u32,
        points: *const f64,
        levels: *mut f64,
    ) -> pbf_status;
    pub fn pbf_end_queries(
        solver: *mut pbf_solver,
    ) -> pbf_status;
    pub fn pbf_emitter_init(
        emitter: *mut pbf_emitter,
        struct_size: u32,
        shape: u32,
    ) -> pbf_status;
    pub fn pbf_set_emitters(
        solver: *mut pbf_solver,
        count: u32,
        emitters: *const pbf_emitter,
    ) -> pbf_status;
    pub fn pbf_get_emitter(
        solver: *mut pbf_solver,
        index: u32,
        emitter: *mut pbf_emitter,
    ) -> pbf_status;
    pub fn pbf_set_drains(
        solver: *mut pbf_solver,
        count: u32,
        drains: *const pbf_volume,
    ) -> pbf_status;
    pub fn pbf_get_drain(
        solver: *mut pbf_solver,
        index: u32,
        drain: *mut pbf_volume,
    ) -> pbf_status;
    pub fn pbf_reservoir_init(
        reservoir: *mut pbf_reservoir,
        struct_size: u32,
    ) -> pbf_status;
    pub fn pbf_set_reservoirs(
        solver: *mut pbf_solver,
        count: u32,
        reservoirs: *const pbf_reservoir,
    ) -> pbf_status;
    pub fn pbf_get_reservoir_count(
        solver: *mut pbf_solver,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_get_reservoir(
        solver: *mut pbf_solver,
        index: u32,
        reservoir: *mut pbf_reservoir,
    ) -> pbf_status;
    pub fn pbf_get_in_out(
        solver: *mut pbf_solver,
        in_out: *mut pbf_in_out,
    ) -> pbf_status;
    pub fn pbf_phase_init(
        phase: *mut pbf_phase,
        struct_size: u32,
    ) -> pbf_status;
    pub fn pbf_set_phases(
        solver: *mut pbf_solver,
        count: u32,
        phases: *const pbf_phase,
    ) -> pbf_status;
    pub fn pbf_get_phase_count(
        solver: *mut pbf_solver,
        count: *mut u32,
    ) -> pbf_status;
    pub fn pbf_get_phase(
        solver: *mut pbf_solver,
        index: u32,
        phase: *mut pbf_phase,
    ) -> pbf_status;
    pub fn pbf_set_particle_phases(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        phases: *const u32,
    ) -> pbf_status;
    pub fn pbf_get_particle_phases(
        solver: *mut pbf_solver,
        first: u32,
        count: u32,
        phases: *mut u32,
    ) -> pbf_status;
    pub fn pbf_shape_from_grid(
        grid: *const pbf_grid_desc,
        shape: *mut *mut pbf_shape,
    ) -> pbf_status;
    pub fn pbf_shape_from_mesh(
        mesh: *const pbf_mesh_desc,
        shape: *mut *mut pbf_shape,
    ) -> pbf_status;
    pub fn pbf_shape_from_heights(
        heights: *const pbf_heights_desc,
        shape: *mut *mut pbf_shape,
    ) -> pbf_status;
    pub fn pbf_shape_from_points(
        hull: *const pbf_hull_desc,
        shape: *mut *mut pbf_shape,
    ) -> pbf_status;
    pub fn pbf_hold_shape(
        shape: *mut pbf_shape,
    ) -> pbf_status;
    pub fn pbf_release_shape(
        shape: *mut pbf_shape,
    );
    pub fn pbf_get_shape_info(
        shape: *mut pbf_shape,
        info: *mut pbf_shape_info,
    ) -> pbf_status;
    pub fn pbf_get_shape_distance(
        shape: *mut pbf_shape,
        point: *const f64,
        distance: *mut f64,
        normal: *mut f64,
    ) -> pbf_status;
    pub fn pbf_get_shape_values(
        shape: *mut pbf_shape,
        count: u64,
        values: *mut f32,
    ) -> pbf_status;
    pub fn pbf_save_shape(
        shape: *mut pbf_shape,
        buffer: *mut c_void,
        size: *mut u64,
    ) -> pbf_status;
    pub fn pbf_load_shape(
        buffer: *const c_void,
        size: u64,
        shape: *mut *mut pbf_shape,
    ) -> pbf_status;
}

#[cfg(all(test, target_pointer_width = "64"))]
mod layout {
    use super::*;
    use std::mem::{size_of, MaybeUninit};

    macro_rules! offset {
        ($struct:ty, $field:ident) => {{
            let place = MaybeUninit::<$struct>::uninit();
            let start = place.as_ptr();
            unsafe { std::ptr::addr_of!((*start).$field) as usize - start as usize }
        }};
    }

    #[test]
    fn pbf_allocator_lies_as_in_c() {
        assert_eq!(size_of::<pbf_allocator>(), 32);
        assert_eq!(offset!(pbf_allocator, struct_size), 0);
        assert_eq!(offset!(pbf_allocator, reserved), 4);
        assert_eq!(offset!(pbf_allocator, user), 8);
        assert_eq!(offset!(pbf_allocator, allocate), 16);
        assert_eq!(offset!(pbf_allocator, release), 24);
    }

    #[test]
    fn pbf_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_desc>(), 112);
        assert_eq!(offset!(pbf_desc, struct_size), 0);
        assert_eq!(offset!(pbf_desc, api_version), 4);
        assert_eq!(offset!(pbf_desc, dimension), 8);
        assert_eq!(offset!(pbf_desc, precision), 12);
        assert_eq!(offset!(pbf_desc, capacity), 16);
        assert_eq!(offset!(pbf_desc, strict), 20);
        assert_eq!(offset!(pbf_desc, backend), 24);
        assert_eq!(offset!(pbf_desc, device), 32);
        assert_eq!(offset!(pbf_desc, threads), 36);
        assert_eq!(offset!(pbf_desc, stream), 40);
        assert_eq!(offset!(pbf_desc, allocator), 48);
        assert_eq!(offset!(pbf_desc, log), 56);
        assert_eq!(offset!(pbf_desc, log_user), 64);
        assert_eq!(offset!(pbf_desc, isa), 72);
        assert_eq!(offset!(pbf_desc, enqueue_task), 80);
        assert_eq!(offset!(pbf_desc, finish_task), 88);
        assert_eq!(offset!(pbf_desc, task_user), 96);
        assert_eq!(offset!(pbf_desc, determinism), 104);
        assert_eq!(offset!(pbf_desc, reserved), 108);
    }

    #[test]
    fn pbf_params_lies_as_in_c() {
        assert_eq!(size_of::<pbf_params>(), 592);
        assert_eq!(offset!(pbf_params, struct_size), 0);
        assert_eq!(offset!(pbf_params, kernel), 4);
        assert_eq!(offset!(pbf_params, smoothing_radius), 8);
        assert_eq!(offset!(pbf_params, spacing), 16);
        assert_eq!(offset!(pbf_params, particle_volume), 24);
        assert_eq!(offset!(pbf_params, time_step), 32);
        assert_eq!(offset!(pbf_params, iterations), 40);
        assert_eq!(offset!(pbf_params, collide), 44);
        assert_eq!(offset!(pbf_params, gravity), 48);
        assert_eq!(offset!(pbf_params, attraction), 72);
        assert_eq!(offset!(pbf_params, attraction_center), 80);
        assert_eq!(offset!(pbf_params, over_relaxation), 104);
        assert_eq!(offset!(pbf_params, cfm), 112);
        assert_eq!(offset!(pbf_params, cohesion), 120);
        assert_eq!(offset!(pbf_params, min_diagonal), 128);
        assert_eq!(offset!(pbf_params, wall_density), 136);
        assert_eq!(offset!(pbf_params, scorr_k), 144);
        assert_eq!(offset!(pbf_params, scorr_dq), 152);
        assert_eq!(offset!(pbf_params, scorr_n), 160);
        assert_eq!(offset!(pbf_params, solver), 164);
        assert_eq!(offset!(pbf_params, vorticity), 168);
        assert_eq!(offset!(pbf_params, viscosity), 176);
        assert_eq!(offset!(pbf_params, domain_min), 184);
        assert_eq!(offset!(pbf_params, domain_max), 208);
        assert_eq!(offset!(pbf_params, wall_velocity), 232);
        assert_eq!(offset!(pbf_params, wall_amplitude), 280);
        assert_eq!(offset!(pbf_params, wall_frequency), 328);
        assert_eq!(offset!(pbf_params, wall_phase), 376);
        assert_eq!(offset!(pbf_params, search_cell_width), 424);
        assert_eq!(offset!(pbf_params, sleep_speed), 432);
        assert_eq!(offset!(pbf_params, sleep_time), 440);
        assert_eq!(offset!(pbf_params, tolerance), 448);
        assert_eq!(offset!(pbf_params, pressure_grid), 456);
        assert_eq!(offset!(pbf_params, prestabilization), 464);
        assert_eq!(offset!(pbf_params, damping_compensation), 472);
        assert_eq!(offset!(pbf_params, angular_momentum_correction), 480);
        assert_eq!(offset!(pbf_params, drag), 488);
        assert_eq!(offset!(pbf_params, drag_velocity), 496);
        assert_eq!(offset!(pbf_params, max_depenetration_speed), 520);
        assert_eq!(offset!(pbf_params, max_substeps), 528);
        assert_eq!(offset!(pbf_params, loads), 532);
        assert_eq!(offset!(pbf_params, shear_stress_correction), 536);
        assert_eq!(offset!(pbf_params, wall_friction), 544);
        assert_eq!(offset!(pbf_params, wall_static_friction), 552);
        assert_eq!(offset!(pbf_params, wall_no_slip), 560);
        assert_eq!(offset!(pbf_params, surface_tension), 568);
        assert_eq!(offset!(pbf_params, periodic), 576);
        assert_eq!(offset!(pbf_params, reserved), 580);
        assert_eq!(offset!(pbf_params, wall_adhesion), 584);
    }

    #[test]
    fn pbf_collider_lies_as_in_c() {
        assert_eq!(size_of::<pbf_collider>(), 336);
        assert_eq!(offset!(pbf_collider, struct_size), 0);
        assert_eq!(offset!(pbf_collider, shape), 4);
        assert_eq!(offset!(pbf_collider, inverted), 8);
        assert_eq!(offset!(pbf_collider, path), 12);
        assert_eq!(offset!(pbf_collider, position), 16);
        assert_eq!(offset!(pbf_collider, orientation), 40);
        assert_eq!(offset!(pbf_collider, velocity), 72);
        assert_eq!(offset!(pbf_collider, angular_velocity), 96);
        assert_eq!(offset!(pbf_collider, axis), 120);
        assert_eq!(offset!(pbf_collider, half_extents), 144);
        assert_eq!(offset!(pbf_collider, radius), 168);
        assert_eq!(offset!(pbf_collider, half_length), 176);
        assert_eq!(offset!(pbf_collider, half_extents_rate), 184);
        assert_eq!(offset!(pbf_collider, radius_rate), 208);
        assert_eq!(offset!(pbf_collider, half_length_rate), 216);
        assert_eq!(offset!(pbf_collider, duration), 224);
        assert_eq!(offset!(pbf_collider, geometry), 232);
        assert_eq!(offset!(pbf_collider, scale), 240);
        assert_eq!(offset!(pbf_collider, scale_rate), 248);
        assert_eq!(offset!(pbf_collider, friction), 256);
        assert_eq!(offset!(pbf_collider, static_friction), 264);
        assert_eq!(offset!(pbf_collider, no_slip), 272);
        assert_eq!(offset!(pbf_collider, adhesion), 280);
        assert_eq!(offset!(pbf_collider, last_velocity), 288);
        assert_eq!(offset!(pbf_collider, last_angular_velocity), 312);
    }

    #[test]
    fn pbf_collider_load_lies_as_in_c() {
        assert_eq!(size_of::<pbf_collider_load>(), 128);
        assert_eq!(offset!(pbf_collider_load, struct_size), 0);
        assert_eq!(offset!(pbf_collider_load, contacts), 4);
        assert_eq!(offset!(pbf_collider_load, impulse), 8);
        assert_eq!(offset!(pbf_collider_load, angular_impulse), 32);
        assert_eq!(offset!(pbf_collider_load, impulse_sum), 56);
        assert_eq!(offset!(pbf_collider_load, angular_impulse_sum), 80);
        assert_eq!(offset!(pbf_collider_load, time_sum), 104);
        assert_eq!(offset!(pbf_collider_load, penetration), 112);
        assert_eq!(offset!(pbf_collider_load, wetted_area), 120);
    }

    #[test]
    fn pbf_read_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_read_desc>(), 80);
        assert_eq!(offset!(pbf_read_desc, struct_size), 0);
        assert_eq!(offset!(pbf_read_desc, field), 4);
        assert_eq!(offset!(pbf_read_desc, first), 8);
        assert_eq!(offset!(pbf_read_desc, count), 12);
        assert_eq!(offset!(pbf_read_desc, element_type), 16);
        assert_eq!(offset!(pbf_read_desc, components), 20);
        assert_eq!(offset!(pbf_read_desc, w), 24);
        assert_eq!(offset!(pbf_read_desc, order), 28);
        assert_eq!(offset!(pbf_read_desc, stride), 32);
        assert_eq!(offset!(pbf_read_desc, data), 40);
        assert_eq!(offset!(pbf_read_desc, behind), 48);
        assert_eq!(offset!(pbf_read_desc, w_value), 56);
        assert_eq!(offset!(pbf_read_desc, device_type), 64);
        assert_eq!(offset!(pbf_read_desc, reserved), 68);
        assert_eq!(offset!(pbf_read_desc, stream), 72);
    }

    #[test]
    fn pbf_write_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_write_desc>(), 56);
        assert_eq!(offset!(pbf_write_desc, struct_size), 0);
        assert_eq!(offset!(pbf_write_desc, field), 4);
        assert_eq!(offset!(pbf_write_desc, first), 8);
        assert_eq!(offset!(pbf_write_desc, count), 12);
        assert_eq!(offset!(pbf_write_desc, element_type), 16);
        assert_eq!(offset!(pbf_write_desc, components), 20);
        assert_eq!(offset!(pbf_write_desc, stride), 24);
        assert_eq!(offset!(pbf_write_desc, data), 32);
        assert_eq!(offset!(pbf_write_desc, device_type), 40);
        assert_eq!(offset!(pbf_write_desc, reserved), 44);
        assert_eq!(offset!(pbf_write_desc, stream), 48);
    }

    #[test]
    fn pbf_view_lies_as_in_c() {
        assert_eq!(size_of::<pbf_view>(), 72);
        assert_eq!(offset!(pbf_view, struct_size), 0);
        assert_eq!(offset!(pbf_view, field), 4);
        assert_eq!(offset!(pbf_view, device_type), 8);
        assert_eq!(offset!(pbf_view, device_id), 12);
        assert_eq!(offset!(pbf_view, element_type), 16);
        assert_eq!(offset!(pbf_view, components), 20);
        assert_eq!(offset!(pbf_view, count), 24);
        assert_eq!(offset!(pbf_view, reserved), 28);
        assert_eq!(offset!(pbf_view, particle_stride), 32);
        assert_eq!(offset!(pbf_view, component_stride), 40);
        assert_eq!(offset!(pbf_view, generation), 48);
        assert_eq!(offset!(pbf_view, data), 56);
        assert_eq!(offset!(pbf_view, ids), 64);
    }

    #[test]
    fn pbf_snapshot_lies_as_in_c() {
        assert_eq!(size_of::<pbf_snapshot>(), 64);
        assert_eq!(offset!(pbf_snapshot, struct_size), 0);
        assert_eq!(offset!(pbf_snapshot, count), 4);
        assert_eq!(offset!(pbf_snapshot, dimension), 8);
        assert_eq!(offset!(pbf_snapshot, element_type), 12);
        assert_eq!(offset!(pbf_snapshot, step), 16);
        assert_eq!(offset!(pbf_snapshot, time), 24);
        assert_eq!(offset!(pbf_snapshot, positions), 32);
        assert_eq!(offset!(pbf_snapshot, velocities), 40);
        assert_eq!(offset!(pbf_snapshot, ids), 48);
        assert_eq!(offset!(pbf_snapshot, owner), 56);
    }

    #[test]
    fn pbf_anisotropy_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_anisotropy_desc>(), 64);
        assert_eq!(offset!(pbf_anisotropy_desc, struct_size), 0);
        assert_eq!(offset!(pbf_anisotropy_desc, first), 4);
        assert_eq!(offset!(pbf_anisotropy_desc, count), 8);
        assert_eq!(offset!(pbf_anisotropy_desc, min_neighbors), 12);
        assert_eq!(offset!(pbf_anisotropy_desc, radius), 16);
        assert_eq!(offset!(pbf_anisotropy_desc, smoothing), 24);
        assert_eq!(offset!(pbf_anisotropy_desc, max_ratio), 32);
        assert_eq!(offset!(pbf_anisotropy_desc, lone_scale), 40);
        assert_eq!(offset!(pbf_anisotropy_desc, positions), 48);
        assert_eq!(offset!(pbf_anisotropy_desc, stretches), 56);
    }

    #[test]
    fn pbf_stats_lies_as_in_c() {
        assert_eq!(size_of::<pbf_stats>(), 184);
        assert_eq!(offset!(pbf_stats, struct_size), 0);
        assert_eq!(offset!(pbf_stats, count), 4);
        assert_eq!(offset!(pbf_stats, iterations), 8);
        assert_eq!(offset!(pbf_stats, neighbors_max), 12);
        assert_eq!(offset!(pbf_stats, neighbors_mean), 16);
        assert_eq!(offset!(pbf_stats, center_of_mass), 24);
        assert_eq!(offset!(pbf_stats, position_min), 48);
        assert_eq!(offset!(pbf_stats, position_max), 72);
        assert_eq!(offset!(pbf_stats, momentum), 96);
        assert_eq!(offset!(pbf_stats, kinetic_energy), 120);
        assert_eq!(offset!(pbf_stats, speed_max), 128);
        assert_eq!(offset!(pbf_stats, density_error_mean), 136);
        assert_eq!(offset!(pbf_stats, density_error_max), 144);
        assert_eq!(offset!(pbf_stats, density_mean), 152);
        assert_eq!(offset!(pbf_stats, asleep), 160);
        assert_eq!(offset!(pbf_stats, squeezed), 164);
        assert_eq!(offset!(pbf_stats, step_limit), 168);
        assert_eq!(offset!(pbf_stats, limited_by), 176);
        assert_eq!(offset!(pbf_stats, substeps), 180);
    }

    #[test]
    fn pbf_stage_time_lies_as_in_c() {
        assert_eq!(size_of::<pbf_stage_time>(), 48);
        assert_eq!(offset!(pbf_stage_time, name), 0);
        assert_eq!(offset!(pbf_stage_time, milliseconds), 32);
        assert_eq!(offset!(pbf_stage_time, runs), 40);
    }

    #[test]
    fn pbf_timings_lies_as_in_c() {
        assert_eq!(size_of::<pbf_timings>(), 1160);
        assert_eq!(offset!(pbf_timings, struct_size), 0);
        assert_eq!(offset!(pbf_timings, stage_count), 4);
        assert_eq!(offset!(pbf_timings, stages), 8);
    }

    #[test]
    fn pbf_plan_stage_lies_as_in_c() {
        assert_eq!(size_of::<pbf_plan_stage>(), 40);
        assert_eq!(offset!(pbf_plan_stage, name), 0);
        assert_eq!(offset!(pbf_plan_stage, runs_per_step), 32);
        assert_eq!(offset!(pbf_plan_stage, launches_per_step), 36);
    }

    #[test]
    fn pbf_plan_array_lies_as_in_c() {
        assert_eq!(size_of::<pbf_plan_array>(), 48);
        assert_eq!(offset!(pbf_plan_array, name), 0);
        assert_eq!(offset!(pbf_plan_array, bytes_per_particle), 32);
        assert_eq!(offset!(pbf_plan_array, bytes), 40);
    }

    #[test]
    fn pbf_plan_lies_as_in_c() {
        assert_eq!(size_of::<pbf_plan>(), 2976);
        assert_eq!(offset!(pbf_plan, struct_size), 0);
        assert_eq!(offset!(pbf_plan, stage_count), 4);
        assert_eq!(offset!(pbf_plan, array_count), 8);
        assert_eq!(offset!(pbf_plan, reserved), 12);
        assert_eq!(offset!(pbf_plan, variant), 16);
        assert_eq!(offset!(pbf_plan, bytes_per_particle), 80);
        assert_eq!(offset!(pbf_plan, bytes), 88);
        assert_eq!(offset!(pbf_plan, stages), 96);
        assert_eq!(offset!(pbf_plan, arrays), 1056);
    }

    #[test]
    fn pbf_backend_info_lies_as_in_c() {
        assert_eq!(size_of::<pbf_backend_info>(), 752);
        assert_eq!(offset!(pbf_backend_info, struct_size), 0);
        assert_eq!(offset!(pbf_backend_info, available), 4);
        assert_eq!(offset!(pbf_backend_info, score), 8);
        assert_eq!(offset!(pbf_backend_info, device_type), 12);
        assert_eq!(offset!(pbf_backend_info, name), 16);
        assert_eq!(offset!(pbf_backend_info, device_name), 48);
        assert_eq!(offset!(pbf_backend_info, build_id), 144);
        assert_eq!(offset!(pbf_backend_info, path), 240);
        assert_eq!(offset!(pbf_backend_info, reason), 496);
    }

    #[test]
    fn pbf_info_lies_as_in_c() {
        assert_eq!(size_of::<pbf_info>(), 784);
        assert_eq!(offset!(pbf_info, struct_size), 0);
        assert_eq!(offset!(pbf_info, dimension), 4);
        assert_eq!(offset!(pbf_info, precision), 8);
        assert_eq!(offset!(pbf_info, capacity), 12);
        assert_eq!(offset!(pbf_info, threads), 16);
        assert_eq!(offset!(pbf_info, device), 20);
        assert_eq!(offset!(pbf_info, device_type), 24);
        assert_eq!(offset!(pbf_info, fell_back), 28);
        assert_eq!(offset!(pbf_info, step), 32);
        assert_eq!(offset!(pbf_info, time), 40);
        assert_eq!(offset!(pbf_info, backend), 48);
        assert_eq!(offset!(pbf_info, device_name), 80);
        assert_eq!(offset!(pbf_info, build_id), 176);
        assert_eq!(offset!(pbf_info, path), 272);
        assert_eq!(offset!(pbf_info, fallback_reason), 528);
    }

    #[test]
    fn pbf_batch_info_lies_as_in_c() {
        assert_eq!(size_of::<pbf_batch_info>(), 16);
        assert_eq!(offset!(pbf_batch_info, struct_size), 0);
        assert_eq!(offset!(pbf_batch_info, worlds), 4);
        assert_eq!(offset!(pbf_batch_info, threads), 8);
        assert_eq!(offset!(pbf_batch_info, device_type), 12);
    }

    #[test]
    fn pbf_diffuse_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_diffuse_desc>(), 136);
        assert_eq!(offset!(pbf_diffuse_desc, struct_size), 0);
        assert_eq!(offset!(pbf_diffuse_desc, capacity), 4);
        assert_eq!(offset!(pbf_diffuse_desc, seed), 8);
        assert_eq!(offset!(pbf_diffuse_desc, interval), 12);
        assert_eq!(offset!(pbf_diffuse_desc, foam_neighbors), 16);
        assert_eq!(offset!(pbf_diffuse_desc, bubble_neighbors), 20);
        assert_eq!(offset!(pbf_diffuse_desc, trapped_air_min), 24);
        assert_eq!(offset!(pbf_diffuse_desc, trapped_air_max), 32);
        assert_eq!(offset!(pbf_diffuse_desc, wave_crest_min), 40);
        assert_eq!(offset!(pbf_diffuse_desc, wave_crest_max), 48);
        assert_eq!(offset!(pbf_diffuse_desc, energy_min), 56);
        assert_eq!(offset!(pbf_diffuse_desc, energy_max), 64);
        assert_eq!(offset!(pbf_diffuse_desc, trapped_air_rate), 72);
        assert_eq!(offset!(pbf_diffuse_desc, wave_crest_rate), 80);
        assert_eq!(offset!(pbf_diffuse_desc, lifetime_min), 88);
        assert_eq!(offset!(pbf_diffuse_desc, lifetime_max), 96);
        assert_eq!(offset!(pbf_diffuse_desc, buoyancy), 104);
        assert_eq!(offset!(pbf_diffuse_desc, bubble_drag), 112);
        assert_eq!(offset!(pbf_diffuse_desc, spray_drag), 120);
        assert_eq!(offset!(pbf_diffuse_desc, scatter), 128);
    }

    #[test]
    fn pbf_diffuse_info_lies_as_in_c() {
        assert_eq!(size_of::<pbf_diffuse_info>(), 56);
        assert_eq!(offset!(pbf_diffuse_info, struct_size), 0);
        assert_eq!(offset!(pbf_diffuse_info, capacity), 4);
        assert_eq!(offset!(pbf_diffuse_info, count), 8);
        assert_eq!(offset!(pbf_diffuse_info, spray), 12);
        assert_eq!(offset!(pbf_diffuse_info, foam), 16);
        assert_eq!(offset!(pbf_diffuse_info, bubbles), 20);
        assert_eq!(offset!(pbf_diffuse_info, time), 24);
        assert_eq!(offset!(pbf_diffuse_info, generated), 32);
        assert_eq!(offset!(pbf_diffuse_info, expired), 40);
        assert_eq!(offset!(pbf_diffuse_info, recycled), 48);
    }

    #[test]
    fn pbf_diffuse_read_lies_as_in_c() {
        assert_eq!(size_of::<pbf_diffuse_read>(), 80);
        assert_eq!(offset!(pbf_diffuse_read, struct_size), 0);
        assert_eq!(offset!(pbf_diffuse_read, first), 4);
        assert_eq!(offset!(pbf_diffuse_read, count), 8);
        assert_eq!(offset!(pbf_diffuse_read, element_type), 12);
        assert_eq!(offset!(pbf_diffuse_read, components), 16);
        assert_eq!(offset!(pbf_diffuse_read, reserved), 20);
        assert_eq!(offset!(pbf_diffuse_read, stride), 24);
        assert_eq!(offset!(pbf_diffuse_read, positions), 32);
        assert_eq!(offset!(pbf_diffuse_read, velocities), 40);
        assert_eq!(offset!(pbf_diffuse_read, ages), 48);
        assert_eq!(offset!(pbf_diffuse_read, lives), 56);
        assert_eq!(offset!(pbf_diffuse_read, kinds), 64);
        assert_eq!(offset!(pbf_diffuse_read, ids), 72);
    }

    #[test]
    fn pbf_volume_lies_as_in_c() {
        assert_eq!(size_of::<pbf_volume>(), 128);
        assert_eq!(offset!(pbf_volume, struct_size), 0);
        assert_eq!(offset!(pbf_volume, shape), 4);
        assert_eq!(offset!(pbf_volume, position), 8);
        assert_eq!(offset!(pbf_volume, orientation), 32);
        assert_eq!(offset!(pbf_volume, half_extents), 64);
        assert_eq!(offset!(pbf_volume, axis), 88);
        assert_eq!(offset!(pbf_volume, radius), 112);
        assert_eq!(offset!(pbf_volume, half_length), 120);
    }

    #[test]
    fn pbf_volume_flow_lies_as_in_c() {
        assert_eq!(size_of::<pbf_volume_flow>(), 72);
        assert_eq!(offset!(pbf_volume_flow, struct_size), 0);
        assert_eq!(offset!(pbf_volume_flow, reserved), 4);
        assert_eq!(offset!(pbf_volume_flow, volume), 8);
        assert_eq!(offset!(pbf_volume_flow, fraction), 16);
        assert_eq!(offset!(pbf_volume_flow, centre), 24);
        assert_eq!(offset!(pbf_volume_flow, velocity), 48);
    }

    #[test]
    fn pbf_samples_lies_as_in_c() {
        assert_eq!(size_of::<pbf_samples>(), 48);
        assert_eq!(offset!(pbf_samples, struct_size), 0);
        assert_eq!(offset!(pbf_samples, count), 4);
        assert_eq!(offset!(pbf_samples, points), 8);
        assert_eq!(offset!(pbf_samples, densities), 16);
        assert_eq!(offset!(pbf_samples, velocities), 24);
        assert_eq!(offset!(pbf_samples, pressures), 32);
        assert_eq!(offset!(pbf_samples, wet), 40);
    }

    #[test]
    fn pbf_sample_grid_lies_as_in_c() {
        assert_eq!(size_of::<pbf_sample_grid>(), 64);
        assert_eq!(offset!(pbf_sample_grid, struct_size), 0);
        assert_eq!(offset!(pbf_sample_grid, counts), 4);
        assert_eq!(offset!(pbf_sample_grid, origin), 16);
        assert_eq!(offset!(pbf_sample_grid, step), 40);
    }

    #[test]
    fn pbf_emitter_lies_as_in_c() {
        assert_eq!(size_of::<pbf_emitter>(), 144);
        assert_eq!(offset!(pbf_emitter, struct_size), 0);
        assert_eq!(offset!(pbf_emitter, shape), 4);
        assert_eq!(offset!(pbf_emitter, recycle), 8);
        assert_eq!(offset!(pbf_emitter, seed), 12);
        assert_eq!(offset!(pbf_emitter, position), 16);
        assert_eq!(offset!(pbf_emitter, velocity), 40);
        assert_eq!(offset!(pbf_emitter, across), 64);
        assert_eq!(offset!(pbf_emitter, half_width), 88);
        assert_eq!(offset!(pbf_emitter, half_height), 96);
        assert_eq!(offset!(pbf_emitter, radius), 104);
        assert_eq!(offset!(pbf_emitter, rate), 112);
        assert_eq!(offset!(pbf_emitter, jitter), 120);
        assert_eq!(offset!(pbf_emitter, lifetime), 128);
        assert_eq!(offset!(pbf_emitter, phase), 136);
        assert_eq!(offset!(pbf_emitter, reserved), 140);
    }

    #[test]
    fn pbf_reservoir_lies_as_in_c() {
        assert_eq!(size_of::<pbf_reservoir>(), 120);
        assert_eq!(offset!(pbf_reservoir, struct_size), 0);
        assert_eq!(offset!(pbf_reservoir, phase), 4);
        assert_eq!(offset!(pbf_reservoir, position), 8);
        assert_eq!(offset!(pbf_reservoir, orientation), 32);
        assert_eq!(offset!(pbf_reservoir, half_extents), 64);
        assert_eq!(offset!(pbf_reservoir, depth), 88);
        assert_eq!(offset!(pbf_reservoir, pressure), 96);
        assert_eq!(offset!(pbf_reservoir, added), 104);
        assert_eq!(offset!(pbf_reservoir, removed), 112);
    }

    #[test]
    fn pbf_in_out_lies_as_in_c() {
        assert_eq!(size_of::<pbf_in_out>(), 56);
        assert_eq!(offset!(pbf_in_out, struct_size), 0);
        assert_eq!(offset!(pbf_in_out, emitters), 4);
        assert_eq!(offset!(pbf_in_out, drains), 8);
        assert_eq!(offset!(pbf_in_out, reserved), 12);
        assert_eq!(offset!(pbf_in_out, emitted), 16);
        assert_eq!(offset!(pbf_in_out, refused), 24);
        assert_eq!(offset!(pbf_in_out, recycled), 32);
        assert_eq!(offset!(pbf_in_out, drained), 40);
        assert_eq!(offset!(pbf_in_out, expired), 48);
    }

    #[test]
    fn pbf_phase_lies_as_in_c() {
        assert_eq!(size_of::<pbf_phase>(), 24);
        assert_eq!(offset!(pbf_phase, struct_size), 0);
        assert_eq!(offset!(pbf_phase, user), 4);
        assert_eq!(offset!(pbf_phase, rest_density), 8);
        assert_eq!(offset!(pbf_phase, viscosity), 16);
    }

    #[test]
    fn pbf_grid_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_grid_desc>(), 64);
        assert_eq!(offset!(pbf_grid_desc, struct_size), 0);
        assert_eq!(offset!(pbf_grid_desc, dimension), 4);
        assert_eq!(offset!(pbf_grid_desc, nodes), 8);
        assert_eq!(offset!(pbf_grid_desc, reserved), 20);
        assert_eq!(offset!(pbf_grid_desc, origin), 24);
        assert_eq!(offset!(pbf_grid_desc, cell), 48);
        assert_eq!(offset!(pbf_grid_desc, values), 56);
    }

    #[test]
    fn pbf_mesh_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_mesh_desc>(), 48);
        assert_eq!(offset!(pbf_mesh_desc, struct_size), 0);
        assert_eq!(offset!(pbf_mesh_desc, dimension), 4);
        assert_eq!(offset!(pbf_mesh_desc, vertex_count), 8);
        assert_eq!(offset!(pbf_mesh_desc, face_count), 12);
        assert_eq!(offset!(pbf_mesh_desc, vertices), 16);
        assert_eq!(offset!(pbf_mesh_desc, faces), 24);
        assert_eq!(offset!(pbf_mesh_desc, cell), 32);
        assert_eq!(offset!(pbf_mesh_desc, thickness), 40);
    }

    #[test]
    fn pbf_heights_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_heights_desc>(), 48);
        assert_eq!(offset!(pbf_heights_desc, struct_size), 0);
        assert_eq!(offset!(pbf_heights_desc, dimension), 4);
        assert_eq!(offset!(pbf_heights_desc, count), 8);
        assert_eq!(offset!(pbf_heights_desc, heights), 16);
        assert_eq!(offset!(pbf_heights_desc, spacing), 24);
        assert_eq!(offset!(pbf_heights_desc, base), 32);
        assert_eq!(offset!(pbf_heights_desc, cell), 40);
    }

    #[test]
    fn pbf_hull_desc_lies_as_in_c() {
        assert_eq!(size_of::<pbf_hull_desc>(), 32);
        assert_eq!(offset!(pbf_hull_desc, struct_size), 0);
        assert_eq!(offset!(pbf_hull_desc, dimension), 4);
        assert_eq!(offset!(pbf_hull_desc, point_count), 8);
        assert_eq!(offset!(pbf_hull_desc, reserved), 12);
        assert_eq!(offset!(pbf_hull_desc, points), 16);
        assert_eq!(offset!(pbf_hull_desc, cell), 24);
    }

    #[test]
    fn pbf_shape_info_lies_as_in_c() {
        assert_eq!(size_of::<pbf_shape_info>(), 136);
        assert_eq!(offset!(pbf_shape_info, struct_size), 0);
        assert_eq!(offset!(pbf_shape_info, dimension), 4);
        assert_eq!(offset!(pbf_shape_info, nodes), 8);
        assert_eq!(offset!(pbf_shape_info, references), 20);
        assert_eq!(offset!(pbf_shape_info, origin), 24);
        assert_eq!(offset!(pbf_shape_info, cell), 48);
        assert_eq!(offset!(pbf_shape_info, lower), 56);
        assert_eq!(offset!(pbf_shape_info, upper), 80);
        assert_eq!(offset!(pbf_shape_info, volume), 104);
        assert_eq!(offset!(pbf_shape_info, area), 112);
        assert_eq!(offset!(pbf_shape_info, bytes), 120);
        assert_eq!(offset!(pbf_shape_info, hash), 128);
    }
}
