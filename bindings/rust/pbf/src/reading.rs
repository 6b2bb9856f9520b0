use crate::error::{Error, Result};
use crate::raw::empty;
use crate::solver::{Real, Solver};
use crate::view::Field;
use pbf_sys as sys;
use std::ptr::null_mut;

/// Which rows [`Solver::read`] writes, and how: the fields of `pbf_read_desc`, all 0 by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rows {
    pub first: u32,
    /// Numbers of a particle; 0: as many as the field has.
    pub components: u32,
    /// From a row to the next, in numbers; 0: no gap.
    pub stride: usize,
    /// What the fourth of four numbers is: `PBF_W_…`.
    pub w: u32,
    pub w_value: f64,
    /// `PBF_ORDER_…`.
    pub order: u32,
    /// How far back between the last two steps; wants [`Solver::keep_previous`].
    pub behind: f64,
}

/// How particles are smoothed and stretched: the fields of `pbf_anisotropy_desc`; 0: the paper's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anisotropy {
    pub first: u32,
    pub min_neighbors: u32,
    pub radius: f64,
    pub smoothing: f64,
    pub max_ratio: f64,
    pub lone_scale: f64,
}

/// What renderers take.
impl<T: Real> Solver<T> {
    /// A field of as many particles as `into` has room for, in numbers of its type; what lies between
    /// rows stays as it is.
    pub fn read<E: Real>(&self, field: Field, rows: &Rows, into: &mut [E]) -> Result<()> {
        let vector = matches!(field, Field::Position | Field::Velocity);
        let own = if vector { self.dimension() } else { 1 };
        let width = if rows.components == 0 {
            own
        } else {
            rows.components
        } as usize;
        let stride = if rows.stride == 0 { width } else { rows.stride };
        let has = into.len();
        let count = has.checked_sub(width).map_or(0, |more| more / stride + 1);
        let end = count
            .checked_sub(1)
            .map_or(0, |before| before * stride + width);
        let gap = stride.checked_sub(width); // which may be behind the last row, too
        if gap.is_none() || (has != end && (count == 0 || Some(has - end) != gap)) {
            return Err(Error::invalid(format!(
                "the array has {has} numbers, which are no rows of {width} with {stride} from one to the next"
            )));
        }
        let mut raw = empty!(pbf_read_desc);
        raw.field = field.code();
        raw.first = rows.first;
        raw.count = self.particles_of(count, 1)?;
        raw.element_type = E::PRECISION; // the numbers of PBF_TYPE_… are the same
        raw.components = rows.components;
        raw.w = rows.w;
        raw.w_value = rows.w_value;
        raw.order = rows.order;
        raw.behind = rows.behind;
        raw.stride = (rows.stride as u64).saturating_mul(std::mem::size_of::<E>() as u64);
        raw.data = into.as_mut_ptr().cast();
        self.checked(unsafe { sys::pbf_read(self.as_raw(), &raw) })
    }

    /// Keeps the positions from before the last step, for [`Rows::behind`].
    pub fn keep_previous(&mut self, enabled: bool) -> Result<()> {
        self.checked(unsafe { sys::pbf_keep_previous(self.as_raw(), enabled.into()) })
    }

    /// Smoothed positions, `dimension` numbers each, and matrices, `dimension` squared.
    pub fn anisotropies(
        &self,
        wanted: &Anisotropy,
        positions: Option<&mut [T]>,
        stretches: Option<&mut [T]>,
    ) -> Result<()> {
        let dimension = self.dimension();
        let mut counts = [None; 2];
        let mut places = [null_mut(); 2];
        for (k, array) in [positions, stretches].into_iter().enumerate() {
            let each = dimension.pow(k as u32 + 1);
            if let Some(array) = array {
                counts[k] = Some(self.particles_of(array.len(), each)?);
                places[k] = array.as_mut_ptr();
            }
        }
        let count = counts[0].or(counts[1]).unwrap_or(0);
        if counts[1].unwrap_or(count) != count {
            return Err(Error::invalid(format!(
                "positions has {count} rows, stretches {}",
                counts[1].unwrap_or(0)
            )));
        }
        let mut raw = empty!(pbf_anisotropy_desc);
        raw.first = wanted.first;
        raw.count = count;
        raw.min_neighbors = wanted.min_neighbors;
        raw.radius = wanted.radius;
        raw.smoothing = wanted.smoothing;
        raw.max_ratio = wanted.max_ratio;
        raw.lone_scale = wanted.lone_scale;
        raw.positions = places[0].cast();
        raw.stretches = places[1].cast();
        self.checked(unsafe { sys::pbf_get_anisotropies(self.as_raw(), &raw) })
    }
}
