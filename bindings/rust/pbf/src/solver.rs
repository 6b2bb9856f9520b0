use crate::collider::Collider;
use crate::error::{checked, Error, Result};
use crate::handle::Handle;
use crate::log::{self, Target};
use crate::params::{Desc, Params};
use crate::raw::empty;
use crate::report::{text, Info, Plan, StageTime};
use crate::shape::Shape;
use crate::snapshot::{Reader, Snapshot};
use crate::view::{Field, View};
use crate::{Load, Stats};
use pbf_sys as sys;
use std::cell::Cell;
use std::marker::PhantomData;
use std::os::raw::c_void;
use std::ptr::{null, null_mut, NonNull};
use std::sync::Arc;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// The numbers that a solver holds: `f32` or `f64`.
pub trait Real: Copy + Default + Send + Sync + 'static + sealed::Sealed {
    #[doc(hidden)]
    const PRECISION: u32;
}
impl Real for f32 {
    const PRECISION: u32 = sys::PBF_FLOAT32;
}
impl Real for f64 {
    const PRECISION: u32 = sys::PBF_FLOAT64;
}

/// A fluid. Arrays have the coordinates of a particle one after the other, `dimension` of them.
pub struct Solver<T: Real> {
    handle: Arc<Handle>,
    dimension: u32,
    _one_thread_at_a_time: PhantomData<Cell<T>>,
}

type Get<R> = unsafe extern "C" fn(*mut sys::pbf_solver, *mut R) -> sys::pbf_status;
type Loads = unsafe extern "C" fn(*mut sys::pbf_solver, u32, *mut Load) -> sys::pbf_status;
type Rows = unsafe extern "C" fn(*mut sys::pbf_solver, u32, u32, *mut c_void) -> sys::pbf_status;
type SetRows =
    unsafe extern "C" fn(*mut sys::pbf_solver, u32, u32, *const c_void) -> sys::pbf_status;

impl<T: Real> Solver<T> {
    pub fn new(desc: &Desc, params: &Params) -> Result<Self> {
        let target = desc.log.clone().map(Target::new);
        let mut made = null_mut();
        let created = desc.with_raw(T::PRECISION, |mut raw| {
            log::set(&mut raw, &target);
            checked(unsafe { sys::pbf_create(&raw, &params.sized(), &mut made) })
        });
        log::unless_it_panicked(created, &target)?;
        let raw = NonNull::new(made).expect("a solver, as pbf_create says");
        let solver = Solver {
            handle: Arc::new(Handle::new(raw, target)),
            dimension: desc.dimension,
            _one_thread_at_a_time: PhantomData,
        };
        solver.handle.checked(sys::PBF_OK)?; // a panic of the log goes on
        Ok(solver)
    }

    /// A world of a batch, with which it ends.
    pub(crate) fn of_world(handle: Handle, dimension: u32) -> Self {
        Solver {
            handle: Arc::new(handle),
            dimension,
            _one_thread_at_a_time: PhantomData,
        }
    }

    /// For calls of [`crate::sys`] that are not here. It is not to be destroyed.
    pub fn as_raw(&self) -> *mut sys::pbf_solver {
        self.handle.raw()
    }

    pub fn dimension(&self) -> u32 {
        self.dimension
    }

    pub fn reader(&self) -> Reader<T> {
        Reader::new(self.handle.clone())
    }

    pub fn step(&mut self, steps: u32) -> Result<()> {
        self.checked(unsafe { sys::pbf_step(self.as_raw(), steps) })
    }

    /// Runs them in a thread of the solver's, until [`Solver::end_step`]; other calls are refused
    /// meanwhile, but for those of a [`Reader`].
    pub fn begin_step(&mut self, steps: u32) -> Result<()> {
        checked(unsafe { sys::pbf_begin_step(self.as_raw(), steps) })
    }

    pub fn end_step(&mut self) -> Result<()> {
        self.checked(unsafe { sys::pbf_end_step(self.as_raw()) })
    }

    pub fn synchronize(&mut self) -> Result<()> {
        self.checked(unsafe { sys::pbf_synchronize(self.as_raw()) })
    }

    pub fn set_params(&mut self, params: &Params) -> Result<()> {
        self.checked(unsafe { sys::pbf_set_params(self.as_raw(), &params.sized()) })
    }

    pub fn params(&self) -> Result<Params> {
        let sized = Params::default();
        let mut raw = sized.sized();
        self.checked(unsafe { sys::pbf_get_params(self.as_raw(), &mut raw) })?;
        Ok(Params::from_raw(raw))
    }

    /// Gives the first new id. Without velocities they are at rest.
    pub fn add_particles(&mut self, positions: &[T], velocities: Option<&[T]>) -> Result<u32> {
        let count = self.particles_of(positions.len(), self.dimension)?;
        if let Some(velocities) = velocities {
            if velocities.len() != positions.len() {
                return Err(Error::invalid(format!(
                    "velocities has {} numbers, positions {}",
                    velocities.len(),
                    positions.len()
                )));
            }
        }
        let velocities = velocities.map_or(null(), |from| from.as_ptr());
        let mut first = 0;
        self.checked(unsafe {
            sys::pbf_add_particles(
                self.as_raw(),
                count,
                positions.as_ptr().cast(),
                velocities.cast(),
                &mut first,
            )
        })?;
        Ok(first)
    }

    pub fn remove_particles(&mut self, ids: &[u32]) -> Result<()> {
        let count = self.particles_of(ids.len(), 1)?;
        self.checked(unsafe { sys::pbf_remove_particles(self.as_raw(), count, ids.as_ptr()) })
    }

    /// Gives how many they were.
    pub fn remove_in_box(&mut self, lower: [f64; 3], upper: [f64; 3]) -> Result<u32> {
        let mut count = 0;
        self.checked(unsafe {
            sys::pbf_remove_in_box(self.as_raw(), lower.as_ptr(), upper.as_ptr(), &mut count)
        })?;
        Ok(count)
    }

    /// The ids of the particles there, ascending.
    pub fn find_in_box(&self, lower: [f64; 3], upper: [f64; 3]) -> Result<Vec<u32>> {
        let mut ids = vec![0; self.count()?];
        let (mut found, room) = (0, self.particles_of(ids.len(), 1)?);
        self.checked(unsafe {
            sys::pbf_find_in_box(
                self.as_raw(),
                lower.as_ptr(),
                upper.as_ptr(),
                room,
                ids.as_mut_ptr(),
                &mut found,
            )
        })?;
        ids.truncate(found as usize);
        Ok(ids)
    }

    pub fn count(&self) -> Result<usize> {
        Ok(self.number(sys::pbf_get_count, 0)? as usize)
    }

    pub fn positions(&self) -> Result<Vec<T>> {
        self.all(sys::pbf_get_positions, self.dimension)
    }

    pub fn velocities(&self) -> Result<Vec<T>> {
        self.all(sys::pbf_get_velocities, self.dimension)
    }

    pub fn densities(&self) -> Result<Vec<T>> {
        self.all(sys::pbf_get_densities, 1)
    }

    pub fn pressures(&self) -> Result<Vec<T>> {
        self.all(sys::pbf_get_pressures, 1)
    }

    pub fn ids(&self) -> Result<Vec<u32>> {
        let mut ids = vec![0; self.count()?];
        let count = self.particles_of(ids.len(), 1)?;
        self.checked(unsafe { sys::pbf_get_ids(self.as_raw(), 0, count, ids.as_mut_ptr()) })?;
        Ok(ids)
    }

    /// Into an array that is there: as many particles as it has room for, from row `first` on.
    pub fn read_positions(&self, first: u32, into: &mut [T]) -> Result<()> {
        self.rows(sys::pbf_get_positions, first, into, self.dimension)
    }

    pub fn read_velocities(&self, first: u32, into: &mut [T]) -> Result<()> {
        self.rows(sys::pbf_get_velocities, first, into, self.dimension)
    }

    pub fn set_positions(&mut self, first: u32, positions: &[T]) -> Result<()> {
        self.set_rows(sys::pbf_set_positions, first, positions)
    }

    pub fn set_velocities(&mut self, first: u32, velocities: &[T]) -> Result<()> {
        self.set_rows(sys::pbf_set_velocities, first, velocities)
    }

    /// Beside gravity, in each step until they are set anew.
    pub fn set_accelerations(&mut self, first: u32, accelerations: &[T]) -> Result<()> {
        self.set_rows(sys::pbf_set_accelerations, first, accelerations)
    }

    /// Takes all of them away, and their memory.
    pub fn clear_accelerations(&mut self) -> Result<()> {
        self.checked(unsafe { sys::pbf_set_accelerations(self.as_raw(), 0, 0, null()) })
    }

    pub fn set_colliders(&mut self, colliders: &[Collider]) -> Result<()> {
        let (raw, count) = self.raw_colliders(colliders)?;
        self.checked(unsafe { sys::pbf_set_colliders(self.as_raw(), count, raw.as_ptr()) })
    }

    /// To these poses and sizes, in this time from now.
    pub fn move_colliders(&mut self, targets: &[Collider], duration: f64) -> Result<()> {
        let (raw, count) = self.raw_colliders(targets)?;
        self.checked(unsafe {
            sys::pbf_move_colliders(self.as_raw(), count, raw.as_ptr(), duration)
        })
    }

    pub fn colliders(&self) -> Result<Vec<Collider>> {
        (0..self.number(sys::pbf_get_collider_count, 0)?)
            .map(|index| {
                let mut raw = empty!(pbf_collider);
                self.checked(unsafe { sys::pbf_get_collider(self.as_raw(), index, &mut raw) })?;
                let shape = NonNull::new(raw.geometry).map(|raw| Shape::held(raw, self.dimension));
                Ok(Collider::from_raw(raw, shape))
            })
            .collect()
    }

    /// What the fluid does to each collider; begins their sums anew. Wants `params.loads`.
    pub fn collider_loads(&mut self) -> Result<Vec<Load>> {
        let count = self.number(sys::pbf_get_collider_count, 0)?;
        self.loads(sys::pbf_get_collider_loads, count)
    }

    /// The same of the domain's walls, by `PBF_WALL_…`.
    pub fn wall_loads(&mut self) -> Result<Vec<Load>> {
        self.loads(sys::pbf_get_wall_loads, 2 * self.dimension)
    }

    pub fn map(&mut self, field: Field) -> Result<View<'_, T>> {
        let mut raw = empty!(pbf_view);
        self.checked(unsafe { sys::pbf_map(self.as_raw(), field.code(), &mut raw) })?;
        Ok(View::new(&self.handle, raw))
    }

    /// Keeps room for so many snapshots; from then on each step ends with one. 0: none.
    pub fn set_snapshots(&mut self, snapshots: u32) -> Result<()> {
        self.checked(unsafe { sys::pbf_set_snapshots(self.as_raw(), snapshots) })
    }

    pub fn snapshot(&self) -> Result<Snapshot<T>> {
        Snapshot::of(&self.handle)
    }

    pub fn stats(&self) -> Result<Stats> {
        let stats = empty!(pbf_stats);
        self.number(sys::pbf_get_stats, stats)
    }

    pub fn info(&self) -> Result<Info> {
        let raw = empty!(pbf_info);
        Ok(Info::from_raw(&self.number(sys::pbf_get_info, raw)?))
    }

    pub fn plan(&self) -> Result<Plan> {
        let raw = empty!(pbf_plan);
        Ok(Plan::from_raw(&self.number(sys::pbf_get_plan, raw)?))
    }

    pub fn set_timing(&mut self, enabled: bool) -> Result<()> {
        self.checked(unsafe { sys::pbf_set_timing(self.as_raw(), enabled.into()) })
    }

    pub fn timings(&self) -> Result<Vec<StageTime>> {
        let raw = empty!(pbf_timings);
        let raw = self.number(sys::pbf_get_timings, raw)?;
        let stage = |one: &sys::pbf_stage_time| StageTime {
            name: text(&one.name),
            milliseconds: one.milliseconds,
            runs: one.runs,
        };
        Ok(raw
            .stages
            .iter()
            .take(raw.stage_count as usize)
            .map(stage)
            .collect())
    }

    pub fn step_limit(&self) -> Result<f64> {
        self.number(sys::pbf_get_step_limit, 0.)
    }

    pub fn hash(&self) -> Result<u64> {
        self.number(sys::pbf_hash, 0)
    }

    pub fn save(&self) -> Result<Vec<u8>> {
        let mut size = 0;
        self.checked(unsafe { sys::pbf_save(self.as_raw(), null_mut(), &mut size) })?;
        let mut state = vec![0; size as usize];
        self.checked(unsafe {
            sys::pbf_save(self.as_raw(), state.as_mut_ptr().cast(), &mut size)
        })?;
        state.truncate(size as usize);
        Ok(state)
    }

    pub fn load(&mut self, state: &[u8]) -> Result<()> {
        self.checked(unsafe {
            sys::pbf_load(self.as_raw(), state.as_ptr().cast(), state.len() as u64)
        })
    }

    pub(crate) fn checked(&self, status: sys::pbf_status) -> Result<()> {
        self.handle.checked(status)
    }

    pub(crate) fn particles_of(&self, numbers: usize, components: u32) -> Result<u32> {
        if numbers % components as usize != 0 {
            return Err(Error::invalid(format!(
                "an array has {numbers} numbers, no multiple of {components}"
            )));
        }
        u32::try_from(numbers / components as usize).map_err(|_| {
            Error::invalid(format!(
                "an array has {numbers} numbers, more than 32 bits count"
            ))
        })
    }

    fn loads(&mut self, get: Loads, count: u32) -> Result<Vec<Load>> {
        let empty = empty!(pbf_collider_load);
        let mut loads = vec![empty; count as usize];
        self.checked(unsafe { get(self.as_raw(), count, loads.as_mut_ptr()) })?;
        Ok(loads)
    }

    pub(crate) fn number<R>(&self, get: Get<R>, mut into: R) -> Result<R> {
        self.checked(unsafe { get(self.as_raw(), &mut into) })?;
        Ok(into)
    }

    fn rows(&self, get: Rows, first: u32, into: &mut [T], components: u32) -> Result<()> {
        let count = self.particles_of(into.len(), components)?;
        self.checked(unsafe { get(self.as_raw(), first, count, into.as_mut_ptr().cast()) })
    }

    fn set_rows(&mut self, set: SetRows, first: u32, from: &[T]) -> Result<()> {
        let count = self.particles_of(from.len(), self.dimension)?;
        self.checked(unsafe { set(self.as_raw(), first, count, from.as_ptr().cast()) })
    }

    fn all(&self, get: Rows, components: u32) -> Result<Vec<T>> {
        let mut into = vec![T::default(); self.count()? * components as usize];
        self.rows(get, 0, &mut into, components)?;
        Ok(into)
    }

    fn raw_colliders(&self, colliders: &[Collider]) -> Result<(Vec<sys::pbf_collider>, u32)> {
        Ok((
            colliders.iter().map(Collider::sized).collect(),
            self.particles_of(colliders.len(), 1)?,
        ))
    }
}

impl<T: Real> Drop for Solver<T> {
    /// Steps that have begun end here, though a Reader, or a batch, may still hold what is left.
    fn drop(&mut self) {
        if Arc::strong_count(&self.handle) > 1 || self.handle.is_world() {
            unsafe {
                sys::pbf_cancel(self.as_raw());
                sys::pbf_end_step(self.as_raw());
            }
        }
    }
}
