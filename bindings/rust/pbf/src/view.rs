use crate::handle::Handle;
use pbf_sys as sys;
use std::marker::PhantomData;
use std::mem::size_of;

/// A field; all but the density can be mapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    Position,
    Velocity,
    Pressure,
    Density,
}

impl Field {
    pub(crate) fn code(self) -> u32 {
        match self {
            Field::Position => sys::PBF_FIELD_POSITION,
            Field::Velocity => sys::PBF_FIELD_VELOCITY,
            Field::Pressure => sys::PBF_FIELD_PRESSURE,
            Field::Density => sys::PBF_FIELD_DENSITY,
        }
    }
}

/// A field where the backend has it, in its own order: [`View::ids`] tells which element is which
/// particle. While there is one, the solver can't be used.
pub struct View<'s, T> {
    handle: &'s Handle,
    raw: sys::pbf_view,
    _elements: PhantomData<&'s [T]>,
}

impl<'s, T: Copy> View<'s, T> {
    /// `raw` is mapped, of element type T.
    pub(crate) fn new(handle: &'s Handle, raw: sys::pbf_view) -> Self {
        View {
            handle,
            raw,
            _elements: PhantomData,
        }
    }

    pub fn len(&self) -> usize {
        self.raw.count as usize
    }

    pub fn is_empty(&self) -> bool {
        self.raw.count == 0
    }

    pub fn components(&self) -> usize {
        self.raw.components as usize
    }

    /// In host memory. On a device, [`View::raw`] has its address there, and the rest panics.
    pub fn on_host(&self) -> bool {
        self.raw.device_type == sys::PBF_DEVICE_CPU
    }

    /// Component `c` of element `i`.
    ///
    /// # Panics
    /// Where there is none, or on a device.
    pub fn at(&self, i: usize, c: usize) -> T {
        assert!(self.on_host(), "the view is of a device's memory");
        assert!(
            i < self.len() && c < self.components(),
            "element {i}, component {c} is outside"
        );
        let offset = i as i64 * self.raw.particle_stride + c as i64 * self.raw.component_stride;
        unsafe {
            (self.raw.data as *const u8)
                .offset(offset as isize)
                .cast::<T>()
                .read_unaligned()
        }
    }

    /// Component `c` of all elements, where they lie next to each other.
    pub fn component(&self, c: usize) -> Option<&[T]> {
        assert!(self.on_host(), "the view is of a device's memory");
        assert!(c < self.components(), "component {c} is outside");
        if self.raw.particle_stride != size_of::<T>() as i64 || self.is_empty() {
            return None;
        }
        let start = unsafe {
            (self.raw.data as *const u8).offset((c as i64 * self.raw.component_stride) as isize)
        };
        Some(unsafe { std::slice::from_raw_parts(start.cast(), self.len()) })
    }

    /// Which particle each element is.
    pub fn ids(&self) -> &[u32] {
        assert!(self.on_host(), "the view is of a device's memory");
        if self.is_empty() {
            return &[];
        }
        unsafe { std::slice::from_raw_parts(self.raw.ids, self.len()) }
    }

    pub fn raw(&self) -> &sys::pbf_view {
        &self.raw
    }
}

impl<T> Drop for View<'_, T> {
    fn drop(&mut self) {
        unsafe { sys::pbf_unmap(self.handle.raw(), self.raw.field) };
    }
}
