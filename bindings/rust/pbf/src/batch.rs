use crate::collider::Collider;
use crate::error::{checked, Error, Result};
use crate::handle::{BatchHandle, Handle};
use crate::log::{self, Target};
use crate::params::{Desc, Params};
use crate::raw::empty;
use crate::solver::{Real, Solver};
use crate::view::Field;
use crate::BatchInfo;
use pbf_sys as sys;
use std::cell::Cell;
use std::ffi::CStr;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};
use std::ptr::{null, null_mut, NonNull};
use std::sync::Arc;

/// Many worlds of one kind in one call. Arrays are world after world; a mask has a truth value a
/// world, and None is all of them. A log is called from all of a batch's threads at once.
pub struct Batch<T: Real> {
    handle: Arc<BatchHandle>,
    worlds: usize,
    dimension: usize,
    _one_thread_at_a_time: PhantomData<Cell<T>>,
}

/// A world as a solver. While there is one, its batch can't be used.
pub struct World<'b, T: Real> {
    solver: Solver<T>,
    _batch: PhantomData<&'b mut Batch<T>>,
}

impl<T: Real> Deref for World<'_, T> {
    type Target = Solver<T>;
    fn deref(&self) -> &Solver<T> {
        &self.solver
    }
}

impl<T: Real> DerefMut for World<'_, T> {
    fn deref_mut(&mut self) -> &mut Solver<T> {
        &mut self.solver
    }
}

impl<T: Real> Batch<T> {
    /// So many empty worlds, each as [`Solver::new`] would make it; `desc.threads` step them.
    pub fn new(desc: &Desc, params: &Params, worlds: u32) -> Result<Self> {
        let target = desc.log.clone().map(Target::new);
        let mut made = null_mut();
        let created = desc.with_raw(T::PRECISION, |mut raw| {
            log::set(&mut raw, &target);
            checked(unsafe { sys::pbf_batch_create(&raw, &params.sized(), worlds, &mut made) })
        });
        log::unless_it_panicked(created, &target)?;
        let raw = NonNull::new(made).expect("a batch, as pbf_batch_create says");
        let batch = Batch {
            handle: Arc::new(BatchHandle::new(raw, target)),
            worlds: worlds as usize,
            dimension: desc.dimension as usize,
            _one_thread_at_a_time: PhantomData,
        };
        batch.checked(sys::PBF_OK)?; // a panic of the log goes on
        Ok(batch)
    }

    /// For calls of [`crate::sys`] that are not here. It is not to be destroyed.
    pub fn as_raw(&self) -> *mut sys::pbf_batch {
        self.handle.raw()
    }

    fn checked(&self, status: sys::pbf_status) -> Result<()> {
        self.handle.checked(status)
    }

    /// How many worlds there are.
    pub fn len(&self) -> usize {
        self.worlds
    }

    pub fn is_empty(&self) -> bool {
        self.worlds == 0
    }

    pub fn info(&self) -> Result<BatchInfo> {
        let mut info = empty!(pbf_batch_info);
        self.checked(unsafe { sys::pbf_batch_get_info(self.as_raw(), &mut info) })?;
        Ok(info)
    }

    pub fn world(&mut self, world: u32) -> Result<World<'_, T>> {
        let mut found = null_mut();
        self.checked(unsafe { sys::pbf_batch_get_world(self.as_raw(), world, &mut found) })?;
        let raw = NonNull::new(found).expect("a world, as pbf_batch_get_world says");
        let handle = Handle::of_world(raw, &self.handle);
        Ok(World {
            solver: Solver::of_world(handle, self.dimension as u32),
            _batch: PhantomData,
        })
    }

    /// What became of each world in the last call that went through worlds.
    pub fn results(&self) -> Result<Vec<Result<()>>> {
        let mut statuses = vec![sys::PBF_OK; self.worlds];
        self.checked(unsafe { sys::pbf_batch_get_statuses(self.as_raw(), statuses.as_mut_ptr()) })?;
        (0u32..)
            .zip(statuses)
            .map(|(world, status)| self.result_of(world, status))
            .collect()
    }

    fn result_of(&self, world: u32, status: sys::pbf_status) -> Result<Result<()>> {
        let mut sentence = null();
        self.checked(unsafe { sys::pbf_batch_get_sentence(self.as_raw(), world, &mut sentence) })?;
        if status == sys::PBF_OK {
            return Ok(Ok(()));
        }
        let sentence = unsafe { CStr::from_ptr(sentence) };
        Ok(Err(Error::new(
            status.into(),
            sentence.to_string_lossy().into_owned(),
        )))
    }

    /// Steps each world; where one fails the others go on, and the first failure is the result.
    pub fn step(&mut self, mask: Option<&[bool]>, steps: u32) -> Result<()> {
        let mask = self.mask(mask)?;
        self.checked(unsafe { sys::pbf_batch_step(self.as_raw(), mask, steps) })
    }

    /// What [`Batch::reset`] goes back to: a state of [`Solver::save`], or the present one of each.
    pub fn set_start(&mut self, mask: Option<&[bool]>, state: Option<&[u8]>) -> Result<()> {
        let mask = self.mask(mask)?;
        let (at, size) = state.map_or((null(), 0), |state| (state.as_ptr(), state.len() as u64));
        self.checked(unsafe { sys::pbf_batch_set_start(self.as_raw(), mask, at.cast(), size) })
    }

    pub fn reset(&mut self, mask: Option<&[bool]>) -> Result<()> {
        let mask = self.mask(mask)?;
        self.checked(unsafe { sys::pbf_batch_reset(self.as_raw(), mask) })
    }

    /// Of each world.
    pub fn set_gravity(&mut self, mask: Option<&[bool]>, gravity: &[[f64; 3]]) -> Result<()> {
        let mask = self.mask(mask)?;
        self.of_each_world("gravity", gravity.len(), 1)?;
        self.checked(unsafe {
            sys::pbf_batch_set_gravity(self.as_raw(), mask, gravity.as_ptr().cast())
        })
    }

    /// The same ones for all.
    pub fn set_colliders(&mut self, mask: Option<&[bool]>, colliders: &[Collider]) -> Result<()> {
        let mask = self.mask(mask)?;
        let raw: Vec<_> = colliders.iter().map(Collider::sized).collect();
        let count = count_of(raw.len())?;
        self.checked(unsafe {
            sys::pbf_batch_set_colliders(self.as_raw(), mask, count, raw.as_ptr())
        })
    }

    /// All that each world has, world after world; without orientations they keep theirs.
    pub fn move_colliders(
        &mut self,
        mask: Option<&[bool]>,
        positions: &[[f64; 3]],
        orientations: Option<&[[f64; 4]]>,
        duration: f64,
    ) -> Result<()> {
        let mask = self.mask(mask)?;
        let count = positions.len() / self.worlds;
        self.of_each_world("positions", positions.len(), count)?;
        if let Some(orientations) = orientations {
            self.of_each_world("orientations", orientations.len(), count)?;
        }
        self.checked(unsafe {
            sys::pbf_batch_move_colliders(
                self.as_raw(),
                mask,
                count_of(count)?,
                positions.as_ptr().cast(),
                orientations.map_or(null(), |from| from.as_ptr().cast()),
                duration,
            )
        })
    }

    /// So many to each world; without velocities they are at rest.
    pub fn add_particles(
        &mut self,
        counts: &[u32],
        positions: &[T],
        velocities: Option<&[T]>,
    ) -> Result<()> {
        self.of_each_world("counts", counts.len(), 1)?;
        let particles: u64 = counts.iter().map(|&count| u64::from(count)).sum();
        let wanted = particles * self.dimension as u64;
        for (name, array) in [("positions", Some(positions)), ("velocities", velocities)] {
            let has = array.map_or(wanted, |array| array.len() as u64);
            if has != wanted {
                return Err(uneven(name, has, wanted));
            }
        }
        self.checked(unsafe {
            sys::pbf_batch_add_particles(
                self.as_raw(),
                counts.as_ptr(),
                positions.as_ptr().cast(),
                velocities.map_or(null(), |from| from.as_ptr().cast()),
            )
        })
    }

    /// Particles of each world.
    pub fn counts(&self) -> Result<Vec<u32>> {
        let mut counts = vec![0; self.worlds];
        self.checked(unsafe { sys::pbf_batch_get_counts(self.as_raw(), counts.as_mut_ptr()) })?;
        Ok(counts)
    }

    /// A field of each world, in as many rows as `into` has room for; rows that a world lacks are 0.
    pub fn read(&self, mask: Option<&[bool]>, field: Field, into: &mut [T]) -> Result<()> {
        let mask = self.mask(mask)?;
        let vector = matches!(field, Field::Position | Field::Velocity);
        let width = if vector { self.dimension } else { 1 };
        let rows = into.len() / (self.worlds * width);
        self.of_each_world("the array", into.len(), rows * width)?;
        let mut read = empty!(pbf_read_desc);
        read.field = field.code();
        read.count = count_of(rows)?;
        read.data = into.as_mut_ptr().cast();
        self.checked(unsafe { sys::pbf_batch_read(self.as_raw(), mask, &read, 0) })
    }

    /// Truth values are the bytes that C wants.
    fn mask(&self, mask: Option<&[bool]>) -> Result<*const u8> {
        match mask {
            None => Ok(null()),
            Some(mask) => {
                self.of_each_world("mask", mask.len(), 1)?;
                Ok(mask.as_ptr().cast())
            }
        }
    }

    fn of_each_world(&self, name: &str, has: usize, each: usize) -> Result<()> {
        if has == self.worlds * each {
            return Ok(());
        }
        let worlds = self.worlds;
        Err(Error::invalid(format!(
            "{name} has {has} elements, not as many for each of {worlds} worlds"
        )))
    }
}

fn uneven(name: &str, has: u64, wanted: u64) -> Error {
    Error::invalid(format!(
        "{name} has {has} numbers; by counts it must have {wanted}"
    ))
}

fn count_of(elements: usize) -> Result<u32> {
    u32::try_from(elements)
        .map_err(|_| Error::invalid(format!("{elements} elements are more than 32 bits count")))
}
