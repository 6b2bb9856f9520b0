//! Position based fluids: the C library pbf, with lifetimes, results and threads as Rust has them.
//!
//! ```no_run
//! let mut fluid = pbf::Solver::<f32>::new(&pbf::Desc::default(), &pbf::Params::default())?;
//! fluid.add_particles(&[0.5, 0.5, 0.5], None)?;
//! fluid.step(10)?;
//! println!("{:?}", fluid.positions()?);
//! # Ok::<(), pbf::Error>(())
//! ```
//!
//! `pbf.h` says what each parameter and each call does; names here are those there. A call that
//! fails leaves the solver as it was, and gives an [`Error`] with the library's sentence.
//!
//! A [`Solver`] may go from thread to thread (`Send`), and is used by one at a time (not `Sync`);
//! what others may do meanwhile, a [`Reader`] does. A panic in a log does not cross the library: it
//! goes on when the call has returned.
mod batch;
mod collider;
mod diffuse;
mod emission;
mod error;
mod handle;
mod log;
mod params;
mod phases;
mod query;
mod raw;
mod reading;
mod report;
mod shape;
mod snapshot;
mod solver;
mod view;

pub use batch::{Batch, World};
pub use collider::Collider;
pub use diffuse::{Diffuse, DiffuseArrays};
pub use emission::{Emitter, Reservoir};
pub use error::{Error, Result, Status};
pub use log::{Level, LogFn};
pub use params::{Desc, Determinism, Params};
pub use pbf_sys as sys;
pub use pbf_sys::pbf_batch_info as BatchInfo;
pub use pbf_sys::pbf_collider_load as Load;
pub use pbf_sys::pbf_diffuse_info as DiffuseInfo;
pub use pbf_sys::pbf_in_out as InOut;
pub use pbf_sys::pbf_shape_info as ShapeInfo;
pub use pbf_sys::pbf_stats as Stats;
pub use pbf_sys::pbf_volume_flow as Flow;
pub use phases::Phase;
pub use query::{SampleGrid, Samples, Volume};
pub use reading::{Anisotropy, Rows};
pub use report::{
    backends, load_backend, version, BackendInfo, Info, Plan, PlanArray, PlanStage, StageTime,
};
pub use shape::Shape;
pub use snapshot::{Reader, Snapshot};
pub use solver::{Real, Solver};
pub use view::{Field, View};
