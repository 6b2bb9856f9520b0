use crate::error::{checked, Result};
use crate::query::Volume;
use crate::raw::{empty, fields_of_c};
use crate::solver::{Real, Solver};
use pbf_sys as sys;

/// An opening that particles come from, by the names of `pbf_emitter`.
#[derive(Clone, Copy)]
pub struct Emitter {
    pub(crate) raw: sys::pbf_emitter,
}
fields_of_c!(Emitter, pbf_emitter);

impl Emitter {
    fn new(shape: u32, position: [f64; 3], velocity: [f64; 3]) -> Self {
        let mut raw = empty!(pbf_emitter);
        let status = unsafe { sys::pbf_emitter_init(&mut raw, raw.struct_size, shape) };
        checked(status).expect("libpbf is of the version of this crate");
        raw.position = position;
        raw.velocity = velocity;
        Emitter { raw }
    }

    /// Across the stream, whose first side points along `across`; as much comes as it carries, unless
    /// `rate` says less.
    pub fn rectangle(
        center: [f64; 3],
        velocity: [f64; 3],
        half_width: f64,
        half_height: f64,
    ) -> Self {
        let mut made = Self::new(sys::PBF_EMITTER_RECTANGLE, center, velocity);
        made.half_width = half_width;
        made.half_height = half_height;
        made
    }

    pub fn disc(center: [f64; 3], velocity: [f64; 3], radius: f64) -> Self {
        let mut made = Self::new(sys::PBF_EMITTER_DISC, center, velocity);
        made.radius = radius;
        made
    }
}

/// An open boundary of given level or pressure, by the names of `pbf_reservoir`.
#[derive(Clone, Copy)]
pub struct Reservoir {
    pub(crate) raw: sys::pbf_reservoir,
}
fields_of_c!(Reservoir, pbf_reservoir);

impl Reservoir {
    /// A box in which fluid always stands so deep.
    pub fn cuboid(center: [f64; 3], half_extents: [f64; 3], depth: f64) -> Self {
        let mut raw = empty!(pbf_reservoir);
        let status = unsafe { sys::pbf_reservoir_init(&mut raw, raw.struct_size) };
        checked(status).expect("libpbf is of the version of this crate");
        raw.position = center;
        raw.half_extents = half_extents;
        raw.depth = depth;
        Reservoir { raw }
    }
}

/// What comes and goes in each step.
impl<T: Real> Solver<T> {
    /// Replaces all emitters; each goes on where it was before, whatever its number.
    pub fn set_emitters(&mut self, emitters: &[Emitter]) -> Result<()> {
        let raw: Vec<_> = emitters.iter().map(Emitter::sized).collect();
        let count = self.particles_of(raw.len(), 1)?;
        self.checked(unsafe { sys::pbf_set_emitters(self.as_raw(), count, raw.as_ptr()) })
    }

    pub fn emitters(&self) -> Result<Vec<Emitter>> {
        (0..self.in_out()?.emitters)
            .map(|index| {
                let mut raw = empty!(pbf_emitter);
                self.checked(unsafe { sys::pbf_get_emitter(self.as_raw(), index, &mut raw) })?;
                Ok(Emitter { raw })
            })
            .collect()
    }

    /// What is in one of these volumes when a step begins is removed.
    pub fn set_drains(&mut self, drains: &[Volume]) -> Result<()> {
        let raw: Vec<_> = drains.iter().map(Volume::sized).collect();
        let count = self.particles_of(raw.len(), 1)?;
        self.checked(unsafe { sys::pbf_set_drains(self.as_raw(), count, raw.as_ptr()) })
    }

    pub fn drains(&self) -> Result<Vec<Volume>> {
        (0..self.in_out()?.drains)
            .map(|index| {
                let mut raw = empty!(pbf_volume);
                self.checked(unsafe { sys::pbf_get_drain(self.as_raw(), index, &mut raw) })?;
                Ok(Volume { raw })
            })
            .collect()
    }

    /// Replaces all open boundaries of given level or pressure.
    pub fn set_reservoirs(&mut self, reservoirs: &[Reservoir]) -> Result<()> {
        let raw: Vec<_> = reservoirs.iter().map(Reservoir::sized).collect();
        let count = self.particles_of(raw.len(), 1)?;
        self.checked(unsafe { sys::pbf_set_reservoirs(self.as_raw(), count, raw.as_ptr()) })
    }

    pub fn reservoirs(&self) -> Result<Vec<Reservoir>> {
        (0..self.number(sys::pbf_get_reservoir_count, 0)?)
            .map(|index| {
                let mut raw = empty!(pbf_reservoir);
                self.checked(unsafe { sys::pbf_get_reservoir(self.as_raw(), index, &mut raw) })?;
                Ok(Reservoir { raw })
            })
            .collect()
    }

    /// What came and went, in particles.
    pub fn in_out(&self) -> Result<crate::InOut> {
        self.number(sys::pbf_get_in_out, empty!(pbf_in_out))
    }
}
