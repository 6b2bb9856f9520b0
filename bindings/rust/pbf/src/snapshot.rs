use crate::error::{checked, Result};
use crate::handle::Handle;
use pbf_sys as sys;
use std::marker::PhantomData;
use std::mem::{size_of, zeroed};
use std::sync::Arc;

/// What other threads may do while one is inside the solver.
pub struct Reader<T> {
    handle: Arc<Handle>,
    _element: PhantomData<fn() -> T>,
}

impl<T> Clone for Reader<T> {
    fn clone(&self) -> Self {
        Self::new(self.handle.clone())
    }
}

impl<T> Reader<T> {
    pub(crate) fn new(handle: Arc<Handle>) -> Self {
        Reader {
            handle,
            _element: PhantomData,
        }
    }

    /// Has the step that is inside the solver end with [`crate::Status::Cancelled`].
    pub fn cancel(&self) -> Result<()> {
        checked(unsafe { sys::pbf_cancel(self.handle.raw()) })
    }

    /// The latest snapshot; see [`crate::Solver::set_snapshots`]. Waits for nothing.
    pub fn snapshot(&self) -> Result<Snapshot<T>> {
        Snapshot::of(&self.handle)
    }
}

/// The state after a step. It does not change, and outlives the solver.
pub struct Snapshot<T> {
    raw: sys::pbf_snapshot,
    _elements: PhantomData<Box<[T]>>,
}

// What it points to is not written to while it is held, and it may be released in any thread.
unsafe impl<T: Send> Send for Snapshot<T> {}
unsafe impl<T: Sync> Sync for Snapshot<T> {}

impl<T> Snapshot<T> {
    pub(crate) fn of(handle: &Handle) -> Result<Self> {
        let mut raw: sys::pbf_snapshot = unsafe { zeroed() };
        raw.struct_size = size_of::<sys::pbf_snapshot>() as u32;
        checked(unsafe { sys::pbf_acquire_snapshot(handle.raw(), &mut raw) })?;
        debug_assert_eq!(raw.element_type as usize, size_of::<T>());
        Ok(Snapshot {
            raw,
            _elements: PhantomData,
        })
    }

    pub fn step(&self) -> u64 {
        self.raw.step
    }

    pub fn time(&self) -> f64 {
        self.raw.time
    }

    /// Coordinates one after the other, in the order of adding.
    pub fn positions(&self) -> &[T] {
        self.slice(self.raw.positions.cast(), self.raw.dimension)
    }

    pub fn velocities(&self) -> &[T] {
        self.slice(self.raw.velocities.cast(), self.raw.dimension)
    }

    pub fn ids(&self) -> &[u32] {
        self.slice(self.raw.ids, 1)
    }

    fn slice<E>(&self, data: *const E, components: u32) -> &[E] {
        if self.raw.count == 0 {
            return &[];
        }
        unsafe { std::slice::from_raw_parts(data, self.raw.count as usize * components as usize) }
    }
}

impl<T> Drop for Snapshot<T> {
    fn drop(&mut self) {
        unsafe { sys::pbf_release_snapshot(&mut self.raw) };
    }
}
