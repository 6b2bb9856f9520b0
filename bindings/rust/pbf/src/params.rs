use crate::error::{checked, Error, Result};
use crate::log::{Level, LogFn};
use crate::raw::{empty, fields_of_c};
use pbf_sys as sys;
use std::ffi::CString;
use std::sync::Arc;

/// The parameters, by the names of `pbf_params`; the defaults are those of `pbf_params_init`.
#[derive(Clone, Copy)]
pub struct Params {
    raw: sys::pbf_params,
}
fields_of_c!(Params, pbf_params);

impl Default for Params {
    fn default() -> Self {
        let mut raw = empty!(pbf_params);
        let status = unsafe { sys::pbf_params_init(&mut raw, raw.struct_size) };
        checked(status).expect("libpbf is of the version of this crate");
        Params { raw }
    }
}

impl Params {
    pub(crate) fn from_raw(raw: sys::pbf_params) -> Self {
        Params { raw }
    }
}

/// Between which runs the bits are the same: `pbf_desc.determinism`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum Determinism {
    #[default]
    AcrossMachines = sys::PBF_DETERMINISM_ACROSS_MACHINES,
    /// Faster on CPUs with fused multiply-add.
    PerMachine = sys::PBF_DETERMINISM_PER_MACHINE,
}

/// What cannot change in a solver's life: `pbf_desc`. Its precision is the type of [`crate::Solver`].
#[derive(Clone)]
pub struct Desc {
    pub dimension: u32,
    pub capacity: u32,
    /// `backend` or failure; else another one may serve, see [`crate::Info::fell_back`].
    pub strict: bool,
    pub backend: String,
    pub device: i32,
    pub threads: u32,
    pub isa: Option<String>,
    pub determinism: Determinism,
    /// Is told complete sentences, from whichever thread is in the library; see [`Desc::with_log`].
    pub log: Option<LogFn>,
}

impl Default for Desc {
    fn default() -> Self {
        let mut raw = empty!(pbf_desc);
        let status = unsafe { sys::pbf_desc_init(&mut raw, raw.struct_size) };
        checked(status).expect("libpbf is of the version of this crate");
        Desc {
            dimension: raw.dimension,
            capacity: raw.capacity,
            strict: raw.strict != 0,
            backend: "auto".into(),
            device: raw.device,
            threads: raw.threads,
            isa: None,
            determinism: Determinism::default(),
            log: None,
        }
    }
}

impl Desc {
    /// With a log; a panic in it goes on when the call that logs has returned.
    pub fn with_log(mut self, log: impl Fn(Level, &str) + Send + Sync + 'static) -> Self {
        self.log = Some(Arc::new(log));
        self
    }

    /// Calls with the description of C, without a log.
    pub(crate) fn with_raw<R>(
        &self,
        precision: u32,
        call: impl FnOnce(sys::pbf_desc) -> Result<R>,
    ) -> Result<R> {
        let text = |name: &str, value: &str| {
            CString::new(value).map_err(|_| Error::invalid(format!("desc.{name} has a zero byte")))
        };
        let backend = text("backend", &self.backend)?;
        let isa = self
            .isa
            .as_deref()
            .map(|name| text("isa", name))
            .transpose()?;
        let mut raw = empty!(pbf_desc);
        checked(unsafe { sys::pbf_desc_init(&mut raw, raw.struct_size) })?;
        raw.dimension = self.dimension;
        raw.precision = precision;
        raw.capacity = self.capacity;
        raw.strict = self.strict.into();
        raw.backend = backend.as_ptr();
        raw.device = self.device;
        raw.threads = self.threads;
        raw.determinism = self.determinism as u32;
        raw.isa = isa.as_ref().map_or(std::ptr::null(), |name| name.as_ptr());
        call(raw)
    }
}
