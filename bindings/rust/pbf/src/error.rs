use pbf_sys as sys;
use std::ffi::CStr;

/// What kind of failure it was: `PBF_ERROR_…`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Status {
    InvalidArgument,
    StructSize,
    OutOfMemory,
    Capacity,
    NotFound,
    Unavailable,
    Unsupported,
    Busy,
    State,
    Device,
    Plugin,
    Data,
    Cancelled,
    /// A code of a later library.
    Other(i32),
}

impl From<sys::pbf_status> for Status {
    fn from(code: sys::pbf_status) -> Self {
        match code {
            sys::PBF_ERROR_INVALID_ARGUMENT => Status::InvalidArgument,
            sys::PBF_ERROR_STRUCT_SIZE => Status::StructSize,
            sys::PBF_ERROR_OUT_OF_MEMORY => Status::OutOfMemory,
            sys::PBF_ERROR_CAPACITY => Status::Capacity,
            sys::PBF_ERROR_NOT_FOUND => Status::NotFound,
            sys::PBF_ERROR_UNAVAILABLE => Status::Unavailable,
            sys::PBF_ERROR_UNSUPPORTED => Status::Unsupported,
            sys::PBF_ERROR_BUSY => Status::Busy,
            sys::PBF_ERROR_STATE => Status::State,
            sys::PBF_ERROR_DEVICE => Status::Device,
            sys::PBF_ERROR_PLUGIN => Status::Plugin,
            sys::PBF_ERROR_DATA => Status::Data,
            sys::PBF_ERROR_CANCELLED => Status::Cancelled,
            other => Status::Other(other),
        }
    }
}

/// A status and the library's sentence, which names what was wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    status: Status,
    message: String,
}

pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    pub fn status(&self) -> Status {
        self.status
    }

    pub(crate) fn new(status: Status, message: String) -> Self {
        Error { status, message }
    }

    pub(crate) fn invalid(message: String) -> Self {
        Error::new(Status::InvalidArgument, message)
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

/// Of the call that this thread has just made.
pub(crate) fn checked(status: sys::pbf_status) -> Result<()> {
    if status == sys::PBF_OK {
        return Ok(());
    }
    let sentence = unsafe { CStr::from_ptr(sys::pbf_last_error()) };
    Err(Error {
        status: status.into(),
        message: sentence.to_string_lossy().into_owned(),
    })
}
