use crate::error::{checked, Result};
use crate::raw::{empty, fields_of_c};
use crate::solver::{Real, Solver};
use pbf_sys as sys;

/// One of several fluids in a solver, by the names of `pbf_phase`.
#[derive(Clone, Copy)]
pub struct Phase {
    pub(crate) raw: sys::pbf_phase,
}
fields_of_c!(Phase, pbf_phase);

impl Phase {
    /// Over the reference density: water 1, oil 0.9.
    pub fn new(rest_density: f64) -> Self {
        let mut raw = empty!(pbf_phase);
        let status = unsafe { sys::pbf_phase_init(&mut raw, raw.struct_size) };
        checked(status).expect("libpbf is of the version of this crate");
        raw.rest_density = rest_density;
        Phase { raw }
    }
}

/// Several fluids in one solver.
impl<T: Real> Solver<T> {
    /// Replaces all phases; with none all particles are alike again.
    pub fn set_phases(&mut self, phases: &[Phase]) -> Result<()> {
        let raw: Vec<_> = phases.iter().map(Phase::sized).collect();
        let count = self.particles_of(raw.len(), 1)?;
        self.checked(unsafe { sys::pbf_set_phases(self.as_raw(), count, raw.as_ptr()) })
    }

    pub fn phases(&self) -> Result<Vec<Phase>> {
        (0..self.number(sys::pbf_get_phase_count, 0)?)
            .map(|index| {
                let mut raw = empty!(pbf_phase);
                self.checked(unsafe { sys::pbf_get_phase(self.as_raw(), index, &mut raw) })?;
                Ok(Phase { raw })
            })
            .collect()
    }

    /// Which phase particles are of, from row `first` on.
    pub fn set_particle_phases(&mut self, first: u32, phases: &[u32]) -> Result<()> {
        let count = self.particles_of(phases.len(), 1)?;
        self.checked(unsafe {
            sys::pbf_set_particle_phases(self.as_raw(), first, count, phases.as_ptr())
        })
    }

    pub fn particle_phases(&self) -> Result<Vec<u32>> {
        let mut phases = vec![0; self.count()?];
        let count = self.particles_of(phases.len(), 1)?;
        self.checked(unsafe {
            sys::pbf_get_particle_phases(self.as_raw(), 0, count, phases.as_mut_ptr())
        })?;
        Ok(phases)
    }
}
