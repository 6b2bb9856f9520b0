use crate::error::checked;
use pbf_sys as sys;
use std::mem::{size_of, zeroed};
use std::ops::{Deref, DerefMut};

/// A collider, by the names of `pbf_collider`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Collider(sys::pbf_collider);

// SAFETY: whether `geometry` is a shape the library asks its own list, before it looks at one, and
// shapes never change.
unsafe impl Send for Collider {}
unsafe impl Sync for Collider {}

impl Collider {
    /// At rest at the origin, sizes 1. `shape` is one of `PBF_COLLIDER_…`, those that there are.
    fn new(shape: u32, position: [f64; 3]) -> Self {
        let mut raw: sys::pbf_collider = unsafe { zeroed() };
        let status = unsafe {
            sys::pbf_collider_init(&mut raw, size_of::<sys::pbf_collider>() as u32, shape)
        };
        checked(status).expect("libpbf is of the version of this crate");
        raw.position = position;
        Collider(raw)
    }

    pub fn sphere(center: [f64; 3], radius: f64) -> Self {
        let mut made = Self::new(sys::PBF_COLLIDER_SPHERE, center);
        made.radius = radius;
        made
    }

    /// From its middle `half_length` along `axis` to either end.
    pub fn capsule(center: [f64; 3], axis: [f64; 3], half_length: f64, radius: f64) -> Self {
        let mut made = Self::new(sys::PBF_COLLIDER_CAPSULE, center);
        made.axis = axis;
        made.half_length = half_length;
        made.radius = radius;
        made
    }

    pub fn cuboid(center: [f64; 3], half_extents: [f64; 3]) -> Self {
        let mut made = Self::new(sys::PBF_COLLIDER_BOX, center);
        made.half_extents = half_extents;
        made
    }

    /// Through a point; the fluid is on the side of the normal.
    pub fn plane(point: [f64; 3], normal: [f64; 3]) -> Self {
        let mut made = Self::new(sys::PBF_COLLIDER_PLANE, point);
        made.axis = normal;
        made
    }

    /// A container: the fluid stays inside.
    pub fn inverted(mut self) -> Self {
        self.0.inverted = 1;
        self
    }

    pub(crate) fn from_raw(raw: sys::pbf_collider) -> Self {
        Collider(raw)
    }

    pub(crate) fn sized(&self) -> sys::pbf_collider {
        sys::pbf_collider {
            struct_size: size_of::<sys::pbf_collider>() as u32,
            ..self.0
        }
    }
}

impl Deref for Collider {
    type Target = sys::pbf_collider;
    fn deref(&self) -> &sys::pbf_collider {
        &self.0
    }
}

impl DerefMut for Collider {
    fn deref_mut(&mut self) -> &mut sys::pbf_collider {
        &mut self.0
    }
}
