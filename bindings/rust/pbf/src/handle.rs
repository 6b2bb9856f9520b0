use crate::error::{checked, Result};
use crate::log::Target;
use pbf_sys as sys;
use std::ptr::NonNull;

/// The solver of C and what its callbacks use, for all that need it; the last one destroys it.
pub(crate) struct Handle {
    raw: NonNull<sys::pbf_solver>,
    log: Option<Box<Target>>,
}

// A solver belongs to one thread at a time, which Solver (not Sync) sees to. A Reader, in any
// thread, calls what may be called from any thread.
unsafe impl Send for Handle {}
unsafe impl Sync for Handle {}

impl Handle {
    pub(crate) fn new(raw: NonNull<sys::pbf_solver>, log: Option<Box<Target>>) -> Self {
        Handle { raw, log }
    }

    pub(crate) fn raw(&self) -> *mut sys::pbf_solver {
        self.raw.as_ptr()
    }

    /// The result of a call; a panic of the log in it goes on here. One in steps that have begun
    /// waits for their end: until then the solver is busy.
    pub(crate) fn checked(&self, status: sys::pbf_status) -> Result<()> {
        let result = checked(status);
        if status == sys::PBF_ERROR_BUSY {
            return result;
        }
        if let Some(payload) = self.log.as_ref().and_then(|log| log.take_panic()) {
            std::panic::resume_unwind(payload);
        }
        result
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        unsafe { sys::pbf_destroy(self.raw()) }
    }
}
