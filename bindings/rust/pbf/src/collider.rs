use crate::error::checked;
use crate::raw::{empty, fields_of_c};
use crate::shape::Shape;
use pbf_sys as sys;

/// A collider, by the names of `pbf_collider`.
#[derive(Clone)]
pub struct Collider {
    raw: sys::pbf_collider,
    shape: Option<Shape>, // which lives while this does
}
fields_of_c!(Collider, pbf_collider);

// SAFETY: whether `geometry` is a shape the library asks its own list, before it looks at one, and
// shapes never change.
unsafe impl Send for Collider {}
unsafe impl Sync for Collider {}

impl Collider {
    /// At rest at the origin, sizes 1. `shape` is one of `PBF_COLLIDER_…`, those that there are.
    fn new(shape: u32, position: [f64; 3]) -> Self {
        let mut raw = empty!(pbf_collider);
        let status = unsafe { sys::pbf_collider_init(&mut raw, raw.struct_size, shape) };
        checked(status).expect("libpbf is of the version of this crate");
        raw.position = position;
        Collider { raw, shape: None }
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

    /// As large as the shape is, whose own 0 is at `position`; `scale` makes it larger.
    pub fn solid(shape: &Shape, position: [f64; 3]) -> Self {
        let mut made = Self::new(sys::PBF_COLLIDER_SHAPE, position);
        made.geometry = shape.as_raw();
        made.shape = Some(shape.clone());
        made
    }

    /// The shape of one that has one.
    pub fn shape(&self) -> Option<&Shape> {
        self.shape.as_ref()
    }

    /// A container: the fluid stays inside.
    pub fn inverted(mut self) -> Self {
        self.raw.inverted = 1;
        self
    }

    /// `shape` is what `raw` has for its geometry.
    pub(crate) fn from_raw(raw: sys::pbf_collider, shape: Option<Shape>) -> Self {
        Collider { raw, shape }
    }
}
