use crate::error::{Error, Result};
use crate::query::{place, uneven};
use crate::raw::{empty, fields_of_c};
use crate::solver::{Real, Solver};
use crate::DiffuseInfo;
use pbf_sys as sys;
use std::ptr::null;

/// What spray, foam and bubbles are made by, by the names of `pbf_diffuse_desc`;
/// [`Solver::default_diffuse`] gives one.
#[derive(Clone, Copy)]
pub struct Diffuse {
    raw: sys::pbf_diffuse_desc,
}
fields_of_c!(Diffuse, pbf_diffuse_desc);

/// Where [`Solver::read_diffuse`] writes to: arrays for as many each, positions and velocities with
/// `dimension` numbers of each; `None`: that is not asked for.
pub struct DiffuseArrays<'a, T> {
    pub positions: Option<&'a mut [T]>,
    pub velocities: Option<&'a mut [T]>,
    pub ages: Option<&'a mut [T]>,
    /// Times that are left to them.
    pub lives: Option<&'a mut [T]>,
    /// `PBF_DIFFUSE_SPRAY`, `PBF_DIFFUSE_FOAM`, `PBF_DIFFUSE_BUBBLE`.
    pub kinds: Option<&'a mut [u32]>,
    pub ids: Option<&'a mut [u64]>,
}

impl<T> Default for DiffuseArrays<'_, T> {
    fn default() -> Self {
        DiffuseArrays {
            positions: None,
            velocities: None,
            ages: None,
            lives: None,
            kinds: None,
            ids: None,
        }
    }
}

/// Spray, foam and bubbles, for looks.
impl<T: Real> Solver<T> {
    /// What suits the solver's dimension, smoothing_radius, spacing and gravity.
    pub fn default_diffuse(&self) -> Result<Diffuse> {
        let mut raw = empty!(pbf_diffuse_desc);
        self.checked(unsafe { sys::pbf_diffuse_init(self.as_raw(), &mut raw, raw.struct_size) })?;
        Ok(Diffuse { raw })
    }

    /// Has steps make and move them from now on; with `None` there are none.
    pub fn set_diffuse(&mut self, wanted: Option<&Diffuse>) -> Result<()> {
        let sized = wanted.map(Diffuse::sized);
        let raw = sized.as_ref().map_or(null(), |raw| raw as *const _);
        self.checked(unsafe { sys::pbf_set_diffuse(self.as_raw(), raw) })
    }

    /// What they are made by, where there are any.
    pub fn diffuse(&self) -> Result<Option<Diffuse>> {
        if self.diffuse_info()?.capacity == 0 {
            return Ok(None);
        }
        let raw = self.number(sys::pbf_get_diffuse, empty!(pbf_diffuse_desc))?;
        Ok(Some(Diffuse { raw }))
    }

    /// How many there are, by kind, and what became of others.
    pub fn diffuse_info(&self) -> Result<DiffuseInfo> {
        self.number(sys::pbf_get_diffuse_info, empty!(pbf_diffuse_info))
    }

    /// Of `count` of them from number `first` on, the oldest being 0.
    pub fn read_diffuse(&self, first: u32, count: u32, into: DiffuseArrays<'_, T>) -> Result<()> {
        let (each, numbers) = (count as usize, count as usize * self.dimension() as usize);
        let mut raw = empty!(pbf_diffuse_read);
        raw.first = first;
        raw.count = count;
        raw.positions = place("positions", into.positions, numbers)?.cast();
        raw.velocities = place("velocities", into.velocities, numbers)?.cast();
        raw.ages = place("ages", into.ages, each)?.cast();
        raw.lives = place("lives", into.lives, each)?.cast();
        raw.kinds = place("kinds", into.kinds, each)?;
        raw.ids = place("ids", into.ids, each)?;
        self.checked(unsafe { sys::pbf_read_diffuse(self.as_raw(), &raw) })
    }

    /// Adds your own, as many as `lives` has numbers, the times that they have; without velocities
    /// they are at rest.
    pub fn add_diffuse(
        &mut self,
        positions: &[T],
        velocities: Option<&[T]>,
        lives: &[T],
    ) -> Result<()> {
        let numbers = lives.len() * self.dimension() as usize;
        for (name, array) in [("positions", Some(positions)), ("velocities", velocities)] {
            match array {
                Some(array) if array.len() != numbers => {
                    return Err(uneven(name, array.len(), numbers))
                }
                _ => (),
            }
        }
        let count = self.particles_of(lives.len(), 1)?;
        self.checked(unsafe {
            sys::pbf_add_diffuse(
                self.as_raw(),
                count,
                positions.as_ptr().cast(),
                velocities.map_or(null(), |from| from.as_ptr()).cast(),
                lives.as_ptr().cast(),
            )
        })
    }

    /// Moves all of them, as where the world's origin is moved: `dimension` numbers.
    pub fn shift_diffuse(&mut self, way: &[f64]) -> Result<()> {
        if way.len() != self.dimension() as usize {
            return Err(Error::invalid(format!(
                "way has {} numbers; it must have {}",
                way.len(),
                self.dimension()
            )));
        }
        self.checked(unsafe { sys::pbf_shift_diffuse(self.as_raw(), way.as_ptr()) })
    }
}
