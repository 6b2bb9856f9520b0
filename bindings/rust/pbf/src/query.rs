use crate::error::{checked, Error, Result};
use crate::raw::{empty, fields_of_c};
use crate::solver::{Real, Solver};
use crate::Flow;
use pbf_sys as sys;
use std::ptr::null_mut;

/// A part of space, by the names of `pbf_volume`: what queries ask about, and what drains are.
#[derive(Clone, Copy)]
pub struct Volume {
    pub(crate) raw: sys::pbf_volume,
}
fields_of_c!(Volume, pbf_volume);

impl Volume {
    fn new(shape: u32, position: [f64; 3]) -> Self {
        let mut raw = empty!(pbf_volume);
        let status = unsafe { sys::pbf_volume_init(&mut raw, raw.struct_size, shape) };
        checked(status).expect("libpbf is of the version of this crate");
        raw.position = position;
        Volume { raw }
    }

    pub fn cuboid(center: [f64; 3], half_extents: [f64; 3]) -> Self {
        let mut made = Self::new(sys::PBF_VOLUME_BOX, center);
        made.half_extents = half_extents;
        made
    }

    pub fn sphere(center: [f64; 3], radius: f64) -> Self {
        let mut made = Self::new(sys::PBF_VOLUME_SPHERE, center);
        made.radius = radius;
        made
    }

    /// From its middle `half_length` along `axis` to either end.
    pub fn capsule(center: [f64; 3], axis: [f64; 3], half_length: f64, radius: f64) -> Self {
        let mut made = Self::new(sys::PBF_VOLUME_CAPSULE, center);
        made.axis = axis;
        made.half_length = half_length;
        made.radius = radius;
        made
    }
}

/// Where answers at points go, a number a point, of velocities `dimension`; None: that is not asked for.
#[derive(Default)]
pub struct Samples<'a> {
    /// Over that at rest.
    pub densities: Option<&'a mut [f64]>,
    pub velocities: Option<&'a mut [f64]>,
    pub pressures: Option<&'a mut [f64]>,
    /// 1 where there is water, or 0.
    pub wet: Option<&'a mut [u8]>,
}

/// Points `origin + (i, j, k) step`; in arrays the last index is the fastest. In 2D the third numbers
/// are not looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleGrid {
    pub counts: [u32; 3],
    pub origin: [f64; 3],
    pub step: [f64; 3],
}

/// Where there is one, its address, if it has as many elements as are wanted.
pub(crate) fn place<E>(name: &str, array: Option<&mut [E]>, wanted: usize) -> Result<*mut E> {
    match array {
        None => Ok(null_mut()),
        Some(array) if array.len() == wanted => Ok(array.as_mut_ptr()),
        Some(array) => Err(uneven(name, array.len(), wanted)),
    }
}

pub(crate) fn uneven(name: &str, has: usize, wanted: usize) -> Error {
    Error::invalid(format!("{name} has {has} elements; it must have {wanted}"))
}

/// Questions by place, all in `f64`.
impl<T: Real> Solver<T> {
    /// The ids of the particles there, ascending.
    pub fn find_in(&self, volume: &Volume) -> Result<Vec<u32>> {
        let mut ids = vec![0; self.count()?];
        let (mut found, room) = (0, self.particles_of(ids.len(), 1)?);
        self.checked(unsafe {
            sys::pbf_find_in_volume(
                self.as_raw(),
                &volume.sized(),
                room,
                ids.as_mut_ptr(),
                &mut found,
            )
        })?;
        ids.truncate(found as usize);
        Ok(ids)
    }

    /// How much of each volume is below the surface, and how that flows.
    pub fn measure(&self, volumes: &[Volume]) -> Result<Vec<Flow>> {
        let raw: Vec<_> = volumes.iter().map(Volume::sized).collect();
        let count = self.particles_of(raw.len(), 1)?;
        let mut flows = vec![empty!(pbf_volume_flow); raw.len()];
        self.checked(unsafe {
            sys::pbf_measure_volumes(self.as_raw(), count, raw.as_ptr(), flows.as_mut_ptr())
        })?;
        Ok(flows)
    }

    /// At points, `dimension` coordinates each.
    pub fn sample(&self, points: &[f64], into: Samples<'_>) -> Result<()> {
        let count = self.particles_of(points.len(), self.dimension())?;
        let mut raw = self.samples(count as usize, into)?;
        raw.points = points.as_ptr();
        self.checked(unsafe { sys::pbf_sample(self.as_raw(), &raw) })
    }

    /// At the points of a grid.
    pub fn sample_on_grid(&self, grid: &SampleGrid, into: Samples<'_>) -> Result<()> {
        let counts = &grid.counts[..self.dimension() as usize];
        let points = counts
            .iter()
            .try_fold(1usize, |all, &n| all.checked_mul(n as usize))
            .ok_or_else(|| Error::invalid(format!("counts is {counts:?}, too many points")))?;
        let raw = self.samples(points, into)?;
        let mut place = empty!(pbf_sample_grid);
        place.counts = grid.counts;
        place.origin = grid.origin;
        place.step = grid.step;
        self.checked(unsafe { sys::pbf_sample_on_grid(self.as_raw(), &place, &raw) })
    }

    fn samples(&self, points: usize, into: Samples<'_>) -> Result<sys::pbf_samples> {
        let mut raw = empty!(pbf_samples);
        raw.count = self.particles_of(points, 1)?;
        let numbers = points * self.dimension() as usize;
        raw.densities = place("densities", into.densities, points)?;
        raw.velocities = place("velocities", into.velocities, numbers)?;
        raw.pressures = place("pressures", into.pressures, points)?;
        raw.wet = place("wet", into.wet, points)?;
        Ok(raw)
    }

    /// How far rays are from the surface, infinite where they do not meet it, and its normals there:
    /// as many rays as `distances` has numbers.
    pub fn cast_rays(
        &self,
        origins: &[f64],
        directions: &[f64],
        length: f64,
        distances: &mut [f64],
        normals: Option<&mut [f64]>,
    ) -> Result<()> {
        let numbers = distances.len() * self.dimension() as usize;
        for (name, array) in [("origins", origins), ("directions", directions)] {
            if array.len() != numbers {
                return Err(uneven(name, array.len(), numbers));
            }
        }
        let count = self.particles_of(distances.len(), 1)?;
        let normals = place("normals", normals, numbers)?;
        self.checked(unsafe {
            sys::pbf_cast_rays(
                self.as_raw(),
                count,
                origins.as_ptr(),
                directions.as_ptr(),
                length,
                distances.as_mut_ptr(),
                normals,
            )
        })
    }

    /// How high the water stands at points, against gravity; NaN where there is none.
    pub fn levels(&self, points: &[f64]) -> Result<Vec<f64>> {
        let count = self.particles_of(points.len(), self.dimension())?;
        let mut levels = vec![0.; count as usize];
        self.checked(unsafe {
            sys::pbf_get_levels(self.as_raw(), count, points.as_ptr(), levels.as_mut_ptr())
        })?;
        Ok(levels)
    }

    /// Gives back the memory that queries keep.
    pub fn end_queries(&mut self) -> Result<()> {
        self.checked(unsafe { sys::pbf_end_queries(self.as_raw()) })
    }
}
