use crate::error::{checked, Error, Result};
use crate::raw::empty;
use pbf_sys as sys;
use std::ptr::{null_mut, NonNull};

/// A solid of any form, which colliders of [`crate::Collider::solid`] have. A clone is the same one,
/// and it lives while a clone, a collider or a solver has it.
pub struct Shape {
    raw: NonNull<sys::pbf_shape>,
    dimension: u32,
}

// SAFETY: the functions on shapes may be called in any threads at any time.
unsafe impl Send for Shape {}
unsafe impl Sync for Shape {}

type Make<D> = unsafe extern "C" fn(*const D, *mut *mut sys::pbf_shape) -> sys::pbf_status;

impl Shape {
    /// Signed distances, negative inside, at `origin + cell (i, j, k)`, the first index the fastest;
    /// as many dimensions as `nodes` has numbers.
    pub fn from_grid(nodes: &[u32], origin: &[f64], cell: f64, values: &[f32]) -> Result<Self> {
        let mut desc = empty!(pbf_grid_desc);
        desc.dimension = dimension_of("nodes", nodes.len())?;
        let wanted = nodes
            .iter()
            .try_fold(1usize, |all, &n| all.checked_mul(n as usize));
        if wanted != Some(values.len()) || origin.len() != nodes.len() {
            return Err(Error::invalid(format!(
                "values has {} numbers and origin {}, of a grid of {nodes:?} nodes",
                values.len(),
                origin.len()
            )));
        }
        desc.nodes[..nodes.len()].copy_from_slice(nodes);
        desc.origin[..origin.len()].copy_from_slice(origin);
        desc.cell = cell;
        desc.values = values.as_ptr();
        Self::made(desc.dimension, sys::pbf_shape_from_grid, &desc)
    }

    /// What a closed surface of triangles encloses, in 2D a closed line of segments: coordinates of
    /// vertices and numbers of faces, `dimension` of them each.
    pub fn from_mesh(dimension: u32, vertices: &[f64], faces: &[u32], cell: f64) -> Result<Self> {
        Self::from_shell(dimension, vertices, faces, cell, 0.)
    }

    /// Half the thickness to each side of a surface, open or not.
    pub fn from_shell(
        dimension: u32,
        vertices: &[f64],
        faces: &[u32],
        cell: f64,
        thickness: f64,
    ) -> Result<Self> {
        let mut desc = empty!(pbf_mesh_desc);
        desc.dimension = dimension;
        desc.vertex_count = rows("vertices", vertices.len(), dimension)?;
        desc.face_count = rows("faces", faces.len(), dimension)?;
        desc.vertices = vertices.as_ptr();
        desc.faces = faces.as_ptr();
        desc.cell = cell;
        desc.thickness = thickness;
        Self::made(dimension, sys::pbf_shape_from_mesh, &desc)
    }

    /// A terrain down to `base`: `heights[j counts[0] + i]` is the y above `(i, j) spacing`, along x
    /// and z; in 2D `counts` has one number.
    pub fn from_heights(
        counts: &[u32],
        heights: &[f64],
        spacing: f64,
        base: f64,
        cell: f64,
    ) -> Result<Self> {
        let mut desc = empty!(pbf_heights_desc);
        desc.dimension = dimension_of("counts", counts.len() + 1)?;
        let wanted = counts
            .iter()
            .try_fold(1usize, |all, &n| all.checked_mul(n as usize));
        if wanted != Some(heights.len()) {
            return Err(Error::invalid(format!(
                "heights has {} numbers, of a terrain of {counts:?}",
                heights.len()
            )));
        }
        desc.count[..counts.len()].copy_from_slice(counts);
        desc.heights = heights.as_ptr();
        desc.spacing = spacing;
        desc.base = base;
        desc.cell = cell;
        Self::made(desc.dimension, sys::pbf_shape_from_heights, &desc)
    }

    /// The convex hull of points, `dimension` coordinates each.
    pub fn from_points(dimension: u32, points: &[f64], cell: f64) -> Result<Self> {
        let mut desc = empty!(pbf_hull_desc);
        desc.dimension = dimension;
        desc.point_count = rows("points", points.len(), dimension)?;
        desc.points = points.as_ptr();
        desc.cell = cell;
        Self::made(dimension, sys::pbf_shape_from_points, &desc)
    }

    fn made<D>(dimension: u32, make: Make<D>, desc: &D) -> Result<Self> {
        let mut made = null_mut();
        checked(unsafe { make(desc, &mut made) })?;
        let raw = NonNull::new(made).expect("a shape, as its function says");
        Ok(Shape { raw, dimension })
    }

    /// One more reference of a shape that lives.
    pub(crate) fn held(raw: NonNull<sys::pbf_shape>, dimension: u32) -> Self {
        checked(unsafe { sys::pbf_hold_shape(raw.as_ptr()) }).expect("the shape lives");
        Shape { raw, dimension }
    }

    /// For calls of [`crate::sys`]. It is not to be released.
    pub fn as_raw(&self) -> *mut sys::pbf_shape {
        self.raw.as_ptr()
    }

    pub fn dimension(&self) -> u32 {
        self.dimension
    }

    pub fn info(&self) -> Result<crate::ShapeInfo> {
        let mut info = empty!(pbf_shape_info);
        checked(unsafe { sys::pbf_get_shape_info(self.as_raw(), &mut info) })?;
        Ok(info)
    }

    /// The distance of a point in the shape's own space, and the direction in which it grows.
    pub fn distance(&self, point: &[f64]) -> Result<(f64, [f64; 3])> {
        if point.len() != self.dimension as usize {
            return Err(Error::invalid(format!(
                "point has {} numbers; the shape is in {}D",
                point.len(),
                self.dimension
            )));
        }
        let (mut distance, mut normal) = (0., [0.; 3]);
        checked(unsafe {
            sys::pbf_get_shape_distance(
                self.as_raw(),
                point.as_ptr(),
                &mut distance,
                normal.as_mut_ptr(),
            )
        })?;
        Ok((distance, normal))
    }

    /// The distances at its nodes, as [`Shape::from_grid`] takes them.
    pub fn values(&self) -> Result<Vec<f32>> {
        let nodes = self.info()?.nodes;
        let used = &nodes[..self.dimension as usize];
        let mut values = vec![0.; used.iter().map(|&n| n as usize).product()];
        checked(unsafe {
            sys::pbf_get_shape_values(self.as_raw(), values.len() as u64, values.as_mut_ptr())
        })?;
        Ok(values)
    }

    /// As bytes, for a file.
    pub fn save(&self) -> Result<Vec<u8>> {
        let mut size = 0;
        checked(unsafe { sys::pbf_save_shape(self.as_raw(), null_mut(), &mut size) })?;
        let mut saved = vec![0; size as usize];
        checked(unsafe {
            sys::pbf_save_shape(self.as_raw(), saved.as_mut_ptr().cast(), &mut size)
        })?;
        Ok(saved)
    }

    /// Of what [`Shape::save`] or `pbf-bake` wrote.
    pub fn load(saved: &[u8]) -> Result<Self> {
        let mut made = null_mut();
        checked(unsafe {
            sys::pbf_load_shape(saved.as_ptr().cast(), saved.len() as u64, &mut made)
        })?;
        let mut info = empty!(pbf_shape_info);
        checked(unsafe { sys::pbf_get_shape_info(made, &mut info) })?;
        let raw = NonNull::new(made).expect("a shape, as its function says");
        Ok(Shape {
            raw,
            dimension: info.dimension,
        })
    }
}

impl Clone for Shape {
    fn clone(&self) -> Self {
        Self::held(self.raw, self.dimension)
    }
}

impl Drop for Shape {
    fn drop(&mut self) {
        unsafe { sys::pbf_release_shape(self.as_raw()) }
    }
}

fn dimension_of(name: &str, numbers: usize) -> Result<u32> {
    match numbers {
        2 | 3 => Ok(numbers as u32),
        _ => Err(Error::invalid(format!(
            "{name} is of {numbers} dimensions; there are 2 and 3"
        ))),
    }
}

fn rows(name: &str, numbers: usize, dimension: u32) -> Result<u32> {
    if !(2..=3).contains(&dimension) {
        return Err(Error::invalid(format!(
            "dimension is {dimension}; it must be 2 or 3"
        )));
    }
    let rows = numbers / dimension as usize;
    if numbers % dimension as usize != 0 || rows > u32::MAX as usize {
        return Err(Error::invalid(format!(
            "{name} has {numbers} numbers, which are no rows of {dimension}"
        )));
    }
    Ok(rows as u32)
}
