use crate::error::Result;
use pbf_sys as sys;
use std::any::Any;
use std::ffi::CStr;
use std::os::raw::{c_char, c_void};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::{Arc, Mutex};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    Info,
    Warning,
}

pub type LogFn = Arc<dyn Fn(Level, &str) + Send + Sync>;

/// What the library calls, and the first panic of it that has not gone on yet.
pub(crate) struct Target {
    call: LogFn,
    panic: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Target {
    pub(crate) fn new(call: LogFn) -> Arc<Self> {
        Arc::new(Target {
            call,
            panic: Mutex::new(None),
        })
    }

    pub(crate) fn take_panic(&self) -> Option<Box<dyn Any + Send>> {
        self.panic.lock().map_or(None, |mut kept| kept.take())
    }

    fn keep(&self, payload: Box<dyn Any + Send>) {
        match self.panic.lock() {
            Ok(mut kept) if kept.is_none() => *kept = Some(payload),
            _ => std::mem::forget(payload), // its drop might panic, too
        }
    }
}

/// Has the library call it.
pub(crate) fn set(desc: &mut sys::pbf_desc, target: &Option<Arc<Target>>) {
    if let Some(target) = target {
        desc.log = Some(write);
        desc.log_user = Arc::as_ptr(target) as *mut c_void;
    }
}

/// Of what the log was told of while it was made: a panic goes on where it failed.
pub(crate) fn unless_it_panicked(made: Result<()>, target: &Option<Arc<Target>>) -> Result<()> {
    if made.is_err() {
        if let Some(payload) = target.as_ref().and_then(|target| target.take_panic()) {
            std::panic::resume_unwind(payload);
        }
    }
    made
}

/// `user` is a Target that lives when the call begins. The log may drop the solver, and so what held it.
unsafe extern "C" fn write(user: *mut c_void, level: i32, message: *const c_char) {
    Arc::increment_strong_count(user as *const Target);
    let target = Arc::from_raw(user as *const Target);
    let wrote = catch_unwind(AssertUnwindSafe(|| {
        let level = if level as u32 == sys::PBF_LOG_INFO {
            Level::Info
        } else {
            Level::Warning
        };
        (target.call)(level, &CStr::from_ptr(message).to_string_lossy());
    }));
    if let Err(payload) = wrote {
        target.keep(payload);
    }
    if let Err(payload) = catch_unwind(AssertUnwindSafe(|| drop(target))) {
        std::mem::forget(payload);
    }
}
