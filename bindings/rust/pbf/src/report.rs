//! What the library says of itself and of a solver.
use crate::error::{checked, Error, Result};
use crate::params::Desc;
use pbf_sys as sys;
use std::ffi::{CStr, CString};
use std::mem::{size_of, zeroed};
use std::os::raw::c_char;

/// MAJOR, MINOR, PATCH of the library at run time.
pub fn version() -> (u32, u32, u32) {
    let version = unsafe { sys::pbf_version() };
    (
        version / 1_000_000,
        version / 1_000 % 1_000,
        version % 1_000,
    )
}

/// Loads a plugin from an absolute path, for the life of the process.
///
/// # Safety
/// The code in the file is run.
pub unsafe fn load_backend(path: &str) -> Result<()> {
    let path = CString::new(path).map_err(|_| Error::invalid("path has a zero byte".into()))?;
    checked(sys::pbf_load_backend(path.as_ptr()))
}

/// A text that ends within its array.
pub(crate) fn text(of: &[c_char]) -> String {
    unsafe { CStr::from_ptr(of.as_ptr()) }
        .to_string_lossy()
        .into_owned()
}

#[derive(Clone, Debug)]
pub struct Info {
    pub dimension: u32,
    pub capacity: u32,
    /// CPU threads in use; 0 on a device.
    pub threads: u32,
    pub device: i32,
    pub fell_back: bool,
    pub step: u64,
    pub time: f64,
    pub backend: String,
    pub device_name: String,
    pub build_id: String,
    pub path: String,
    pub fallback_reason: String,
}

impl Info {
    pub(crate) fn from_raw(raw: &sys::pbf_info) -> Self {
        Info {
            dimension: raw.dimension,
            capacity: raw.capacity,
            threads: raw.threads,
            device: raw.device,
            fell_back: raw.fell_back != 0,
            step: raw.step,
            time: raw.time,
            backend: text(&raw.backend),
            device_name: text(&raw.device_name),
            build_id: text(&raw.build_id),
            path: text(&raw.path),
            fallback_reason: text(&raw.fallback_reason),
        }
    }
}

#[derive(Clone, Debug)]
pub struct PlanStage {
    pub name: String,
    pub runs_per_step: u32,
    pub launches_per_step: u32,
}

#[derive(Clone, Debug)]
pub struct PlanArray {
    pub name: String,
    pub bytes_per_particle: f64,
    pub bytes: u64,
}

/// What a solver runs and holds.
#[derive(Clone, Debug)]
pub struct Plan {
    pub variant: String,
    pub bytes_per_particle: f64,
    pub bytes: u64,
    pub stages: Vec<PlanStage>,
    pub arrays: Vec<PlanArray>,
}

impl Plan {
    pub(crate) fn from_raw(raw: &sys::pbf_plan) -> Self {
        let stage = |one: &sys::pbf_plan_stage| PlanStage {
            name: text(&one.name),
            runs_per_step: one.runs_per_step,
            launches_per_step: one.launches_per_step,
        };
        let array = |one: &sys::pbf_plan_array| PlanArray {
            name: text(&one.name),
            bytes_per_particle: one.bytes_per_particle,
            bytes: one.bytes,
        };
        Plan {
            variant: text(&raw.variant),
            bytes_per_particle: raw.bytes_per_particle,
            bytes: raw.bytes,
            stages: raw
                .stages
                .iter()
                .take(raw.stage_count as usize)
                .map(stage)
                .collect(),
            arrays: raw
                .arrays
                .iter()
                .take(raw.array_count as usize)
                .map(array)
                .collect(),
        }
    }
}

/// Of a stage since timing was switched on.
#[derive(Clone, Debug)]
pub struct StageTime {
    pub name: String,
    pub milliseconds: f64,
    pub runs: u64,
}

#[derive(Clone, Debug)]
pub struct BackendInfo {
    pub available: bool,
    /// "auto" takes the highest.
    pub score: i32,
    pub name: String,
    pub device_name: String,
    pub build_id: String,
    pub path: String,
    /// Why it can't serve.
    pub reason: String,
}

/// Every backend found, judged for a solver like `desc` in single precision, and every file that
/// failed to load.
pub fn backends(desc: &Desc) -> Result<Vec<BackendInfo>> {
    let mut count = 0;
    checked(unsafe { sys::pbf_get_backend_count(&mut count) })?;
    desc.with_raw(sys::PBF_FLOAT32, |raw| {
        (0..count)
            .map(|index| {
                let mut info: sys::pbf_backend_info = unsafe { zeroed() };
                info.struct_size = size_of::<sys::pbf_backend_info>() as u32;
                checked(unsafe { sys::pbf_get_backend_info(&raw, index, &mut info) })?;
                Ok(BackendInfo {
                    available: info.available != 0,
                    score: info.score,
                    name: text(&info.name),
                    device_name: text(&info.device_name),
                    build_id: text(&info.build_id),
                    path: text(&info.path),
                    reason: text(&info.reason),
                })
            })
            .collect()
    })
}
