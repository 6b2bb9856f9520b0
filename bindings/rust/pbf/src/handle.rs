use crate::error::{checked, Result};
use crate::log::Target;
use pbf_sys as sys;
use std::ptr::NonNull;
use std::sync::Arc;

/// The solver of C and what its callbacks use, for all that need it; the last one destroys it.
pub(crate) struct Handle {
    raw: NonNull<sys::pbf_solver>,
    log: Option<Arc<Target>>,
    batch: Option<Arc<BatchHandle>>, // that it is a world of, and ends with
}

/// The same of a batch.
pub(crate) struct BatchHandle {
    raw: NonNull<sys::pbf_batch>,
    log: Option<Arc<Target>>,
}

// A solver belongs to one thread at a time, which Solver (not Sync) sees to. A Reader, in any
// thread, calls what may be called from any thread.
unsafe impl Send for Handle {}
unsafe impl Sync for Handle {}
// The same of a batch; a world's Handle only keeps it.
unsafe impl Send for BatchHandle {}
unsafe impl Sync for BatchHandle {}

/// The result of a call; a panic of the log in it goes on here. One in steps that have begun waits for
/// their end: until then the solver is busy.
fn checked_with(log: &Option<Arc<Target>>, status: sys::pbf_status) -> Result<()> {
    let result = checked(status);
    if status == sys::PBF_ERROR_BUSY {
        return result;
    }
    if let Some(payload) = log.as_ref().and_then(|log| log.take_panic()) {
        std::panic::resume_unwind(payload);
    }
    result
}

impl Handle {
    pub(crate) fn new(raw: NonNull<sys::pbf_solver>, log: Option<Arc<Target>>) -> Self {
        let batch = None;
        Handle { raw, log, batch }
    }

    pub(crate) fn of_world(raw: NonNull<sys::pbf_solver>, batch: &Arc<BatchHandle>) -> Self {
        Handle {
            raw,
            log: batch.log.clone(),
            batch: Some(batch.clone()),
        }
    }

    pub(crate) fn raw(&self) -> *mut sys::pbf_solver {
        self.raw.as_ptr()
    }

    pub(crate) fn is_world(&self) -> bool {
        self.batch.is_some()
    }

    pub(crate) fn checked(&self, status: sys::pbf_status) -> Result<()> {
        checked_with(&self.log, status)
    }
}

impl BatchHandle {
    pub(crate) fn new(raw: NonNull<sys::pbf_batch>, log: Option<Arc<Target>>) -> Self {
        BatchHandle { raw, log }
    }

    pub(crate) fn raw(&self) -> *mut sys::pbf_batch {
        self.raw.as_ptr()
    }

    pub(crate) fn checked(&self, status: sys::pbf_status) -> Result<()> {
        checked_with(&self.log, status)
    }
}

impl Drop for Handle {
    /// Of a world nothing is done here.
    fn drop(&mut self) {
        unsafe { sys::pbf_destroy(self.raw()) }
    }
}

impl Drop for BatchHandle {
    fn drop(&mut self) {
        unsafe { sys::pbf_batch_destroy(self.raw()) }
    }
}
