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
    pub(crate) fn new(call: LogFn) -> Box<Self> {
        Box::new(Target {
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

/// `user` is a Target that outlives the solver.
pub(crate) unsafe extern "C" fn write(user: *mut c_void, level: i32, message: *const c_char) {
    let target = &*(user as *const Target);
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
}
