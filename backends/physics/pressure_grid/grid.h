/* Deep water: what the weight of the fluid presses together is undone on a coarse grid, once a step
 * and before the iterations, which carry a pressure by about a layer each.
 *
 * The grid has a value lambda at each of its nodes and multilinear elements between them. With K
 * the stiffness of an element, N a node's function and w the moves that the forces alone make in
 * the step,
 *
 *   sum over the cells e at a node of  volume_e (K lambda)_node
 *       = - part * sum over them of  volume_e w_e · grad N_node + share error_e N_node
 *
 * and particles move by grad lambda. What the fluid brings along is left to the iterations:
 * it is free of divergence as far as these have made it so, and taking from it what a grid can't
 * tell from compression takes energy from every wave. Errors of density would stay; a share of them
 * goes along. It is the free volume of a cell that counts, the part that is free of walls and
 * colliders, and not what fills it: so nothing presses on fluid that falls, whose surface fills
 * cells in part. Where the surface cuts a cell, pressure ends in it, whatever its slope: lambda
 * goes on beyond it as it is below, and is 0 there (surface.h).
 *
 * Errors are of both signs: where fluid has room inside, as below a lid, in the middle of an eddy
 * or behind a wall that draws back, what is around it comes in. At a surface, where fluid ends, it
 * lacks density, too, and nothing pulls: there what is pressed counts alone.
 *
 * Only a part of all this is done, by the depth of the fluid (physics/depth.h): shallow fluid is
 * left to the iterations.
 *
 * Forces that differ from particle to particle are part of w_e, too: accelerations of their own,
 * and drag, which goes by the fluid's velocity (cell_forces.h).
 *
 * A thin solid divides cells into compartments (compartments.h), and what is said here of cells is
 * then true of each of these, and of each copy of a node (topology.h).
 *
 * lambda is 0 at nodes in the open and nowhere positive; beyond walls there is nothing to move,
 * which is what an element's edge does of itself. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_GRID_H
#define PBF_PHYSICS_PRESSURE_GRID_GRID_H

#include "physics/collide.h"
#include "physics/depth.h"
#include "physics/elementary.h"
#include "physics/facets.h"

/* A cell is filled from such a part of its free volume on. */
#define PBF_PRESSURE_GRID_FILLED 0.6

/* The room that there is for what fluid lacks of density. Where it comes off a solid it lacks half
 * of the gap: at its plane the half-space that a solid counts as makes half of a density, whatever
 * the kernel; a little less than 2 leaves ripples as they were. With 1 a cave below a lake boils.
 */
#define PBF_PRESSURE_GRID_ROOM 1.9

/* Nodes that are at least so many cells below the surface are not in the open. */
#define PBF_PRESSURE_GRID_SURFACE 0.001

enum { PBF_CORNERS = 1 << PBF_DIM };

/* In units of the cells' width: lambda of its square, moves of itself. A cell has the index of its
 * corner 0, and one row of cells and nodes lies before the walls on each side, so that no loop asks
 * where it ends. */
typedef struct pbf_pressure_grid {
  double lower[PBF_DIM], width; /* of the first cells inside: they lie evenly between the walls */
  double edge[PBF_DIM];         /* part of those at walls that is inside */
  int at_wall[2 * PBF_DIM];     /* whether the first and the last ones are at the walls:
                                   pbf_pressure_grid_window */
  double per_width;             /* 1 / width */
  double unit;                  /* what a particle fills of a cell */
  double spacing;               /* of particles */
  double push[PBF_DIM];         /* move by the forces in cells 0 … */
  double pull[PBF_DIM];         /* … and its change from cell to cell along that axis */
  double lower_gain[PBF_DIM];   /* what walls move more than in the last step: … */
  double upper_gain[PBF_DIM];   /* … the fluid before them does not yet */
  int middle[PBF_DIM];       /* nodes up to here are at the lower wall, others at the upper one */
  double move, accelerated;  /* at a velocity and by an acceleration of 1 */
  double drag_move[PBF_DIM]; /* at the velocity that drag pulls to */
  double drag;               /* what drag has added, of the difference to it that it leaves */
  double error;              /* pbf_depth_error of a head of 1 */
  double max_left;           /* to the iterations, of an error, … */
  double left_cells;         /* … or else the weight of so many cells' heights */
  double room;               /* of what lacks density; 0: solids do not count as fluid */
  int axis;                  /* along which the forces push most */
  int n[PBF_DIM];            /* cells inside */
  uint32_t size[PBF_DIM];    /* indices along an axis */
  uint32_t corner[PBF_CORNERS]; /* index of a cell's corners from its own */
  uint32_t wrap[PBF_DIM];       /* of a periodic axis: index of the last cell from the one outside,
                                   before the first; 0: there are walls */
  uint32_t nodes;               /* and cells: indices */
} pbf_pressure_grid;

/* Indices that a grid of so many particles takes at most, with those behind the last node that its
 * cells' corners have. */
static inline uint64_t pbf_pressure_grid_limit(uint32_t count) {
  return 4096 + (uint64_t)count / (PBF_DIM == 3 ? 8 : 2);
}

static inline uint64_t pbf_pressure_grid_max_nodes(uint32_t capacity) {
  return pbf_pressure_grid_limit(pbf_max_planned(capacity));
}

/* A step that leaves a part of the difference to the velocity that is dragged to has changed it by
 * 1 - 1 / part of what it leaves. Drag that leaves less than a half of it in a step is for the
 * iterations: rounding is most of what is left then. */
static inline double pbf_pressure_grid_drag(const pbf_params *params) {
  if (!(params->drag > 0)) return 0;
  return fmax(1 - 1 / fmax(pbf_exp(-params->drag * params->time_step), 0.5), -1);
}

static inline int pbf_pressure_grid_cells(const pbf_domain *domain, int axis, double width) {
  double length = (double)domain->upper.c[axis] - (double)domain->lower.c[axis];
  return (int)fmin(fmax(ceil(length / width - 1e-6), 1), 1e6);
}

/* Indices that a grid of so many cells takes, with those behind its last node. */
static inline double pbf_pressure_grid_indices(const int n[PBF_DIM]) {
  double nodes = 1, rows = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    rows = nodes;
    nodes *= n[k] + 2;
  }
  return nodes + 2 * rows + 2;
}

/* Where fluid can leave by the one face of a periodic axis and come in by the other: no container
 * is around it. */
static inline int pbf_pressure_grid_wraps(const pbf_params *params, const pbf_domain *domain,
                                          int axis) {
  return pbf_is_periodic(params, axis) &&
         (double)domain->lower.c[axis] <= params->domain_min[axis] &&
         (double)domain->upper.c[axis] >= params->domain_max[axis];
}

/* Periodic axes end where the domain does, … */
static inline pbf_domain pbf_pressure_grid_domain(const pbf_params *params, pbf_domain domain) {
  for (int k = 0; k < PBF_DIM; ++k)
    if (pbf_pressure_grid_wraps(params, &domain, k)) {
      domain.lower.c[k] = (pbf_real)params->domain_min[k];
      domain.upper.c[k] = (pbf_real)params->domain_max[k];
    }
  return domain;
}

static inline double pbf_pressure_grid_wanted(const pbf_params *params) {
  return (params->pressure_grid >= 0 ? params->pressure_grid : PBF_DEPTH_WIDTH) *
         params->smoothing_radius;
}

/* … and have whole cells, which are a little smaller for it; where several periods have no
 * common width, along the last such axis. */
static inline double pbf_pressure_grid_fitting(const pbf_params *params, const pbf_domain *walls,
                                               const pbf_domain *domain, double width) {
  for (int k = 0; k < PBF_DIM; ++k)
    if (pbf_pressure_grid_wraps(params, walls, k))
      width = ((double)domain->upper.c[k] - (double)domain->lower.c[k]) /
              pbf_pressure_grid_cells(domain, k, width);
  return width;
}

/* Where particles are. */
typedef struct pbf_fluid_bounds {
  pbf_vec lower, upper;
} pbf_fluid_bounds;

/* Of the cells that lie between the walls the ones that are kept, by their numbers from 0 on: all,
 * or those around the fluid. What is farther away than a cell from all fluid changes nothing of the
 * solution. */
typedef struct pbf_pressure_grid_window {
  int first[PBF_DIM], n[PBF_DIM];
} pbf_pressure_grid_window;

/* How far the cells between the walls reach beyond these, in cells, at both ends together. */
static inline double pbf_pressure_grid_beyond(const pbf_domain *domain, int axis, double width) {
  const double length = (double)domain->upper.c[axis] - (double)domain->lower.c[axis];
  return fmax(0, pbf_pressure_grid_cells(domain, axis, width) - length / width);
}

/* The cells around the fluid, as whole blocks of `block` cells, so that the window and what solids
 * divide in it stay as they are while the fluid moves a little; `fluid` null: all. */
static inline pbf_pressure_grid_window pbf_pressure_grid_window_of(const pbf_params *params,
                                                                   const pbf_domain *walls,
                                                                   const pbf_domain *domain,
                                                                   double width, int block,
                                                                   const pbf_fluid_bounds *fluid) {
  pbf_pressure_grid_window w;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int last = pbf_pressure_grid_cells(domain, k, width) - 1;
    w.first[k] = 0;
    w.n[k] = last + 1;
    if (!fluid || pbf_pressure_grid_wraps(params, walls, k)) continue;
    const double beyond = pbf_pressure_grid_beyond(domain, k, width);
    const double start = (double)domain->lower.c[k] - 0.5 * beyond * width;
    const double from = floor(((double)fluid->lower.c[k] - start) / width) - 1;
    const double to = floor(((double)fluid->upper.c[k] - start) / width) + 1;
    const int first = (int)fmin(fmax(from, 0), last) / block * block;
    const int end = ((int)fmin(fmax(to, first), last) / block + 1) * block;
    w.first[k] = first;
    w.n[k] = (end <= last ? end : last + 1) - first;
  }
  return w;
}

/* Whether all cells that are wanted between the walls are kept, wherever the fluid is. */
static inline int pbf_pressure_grid_is_whole(const pbf_params *params, const pbf_domain *walls,
                                             uint64_t limit) {
  const pbf_domain inside = pbf_pressure_grid_domain(params, *walls);
  const double width =
      pbf_pressure_grid_fitting(params, walls, &inside, pbf_pressure_grid_wanted(params));
  const pbf_pressure_grid_window all =
      pbf_pressure_grid_window_of(params, walls, &inside, width, 1, NULL);
  return pbf_pressure_grid_indices(all.n) <= (double)limit;
}

/* Cells of which width are kept, in a limited number of indices: all between the walls, or else
 * those around the fluid, in blocks or alone, or else wider ones. */
static inline pbf_pressure_grid_window pbf_pressure_grid_fit(
    const pbf_params *params, const pbf_domain *walls, const pbf_domain *domain, uint64_t limit,
    const pbf_fluid_bounds *fluid, double *width) {
  double wanted = pbf_pressure_grid_wanted(params);
  *width = pbf_pressure_grid_fitting(params, walls, domain, wanted);
  for (;;) {
    pbf_pressure_grid_window w =
        pbf_pressure_grid_window_of(params, walls, domain, *width, 1, NULL);
    for (int block = 8; pbf_pressure_grid_indices(w.n) > (double)limit && fluid && block > 0;
         block /= 2)
      w = pbf_pressure_grid_window_of(params, walls, domain, *width, block, fluid);
    if (!(pbf_pressure_grid_indices(w.n) > (double)limit)) return w;
    const double fitting = pbf_pressure_grid_fitting(params, walls, domain, wanted *= 1.1);
    /* Cells no wider than a short period may be too many along other axes however few they are to
     * be: then they are wider. Where each period has two cells or more a fitting width is not so
     * small. */
    *width = fitting < wanted / (1 << PBF_DIM) ? wanted : fitting;
  }
}

/* The grid between walls, in a limited number of indices. Where fluid is, `fluid` tells, if that is
 * known: it is asked for where not all is kept. */
static inline pbf_pressure_grid pbf_pressure_grid_between(const pbf_params *params,
                                                          const pbf_domain *walls,
                                                          int corrects_shear, uint64_t limit,
                                                          const pbf_fluid_bounds *fluid = NULL) {
  const pbf_domain inside = pbf_pressure_grid_domain(params, *walls), *domain = &inside;
  pbf_pressure_grid c;
  memset(&c, 0, sizeof c); /* so that two can be compared */
  double dt2 = params->time_step * params->time_step, width;
  const pbf_pressure_grid_window window =
      pbf_pressure_grid_fit(params, walls, domain, limit, fluid, &width);
  c.width = width;
  c.per_width = 1 / width;
  c.error = pbf_depth_error(params, width * width);
  c.max_left = corrects_shear ? PBF_DEPTH_SHEARED_LEFT : 1;
  c.spacing = pbf_derive_spacing(params) / width;
  c.left_cells = PBF_DEPTH_SHEARED_LEFT_LAYERS * c.spacing;
  c.unit = params->particle_volume > 0 ? params->particle_volume
                                       : pbf_pow(pbf_derive_spacing(params), PBF_DIM);
  c.room = params->wall_density < 1 ? 0 : PBF_PRESSURE_GRID_ROOM;
  c.move = params->time_step / width;
  c.accelerated = dt2 / width;
  c.drag = pbf_pressure_grid_drag(params);
  c.nodes = 1;
  c.axis = 0;
  for (int a = 0; a < PBF_CORNERS; ++a) c.corner[a] = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int cells = pbf_pressure_grid_cells(domain, k, width);
    const double beyond = pbf_pressure_grid_beyond(domain, k, width);
    c.n[k] = window.n[k];
    c.lower[k] = (double)domain->lower.c[k] + (window.first[k] - 0.5 * beyond) * width;
    c.edge[k] = cells == 1 ? 1 - beyond : 1 - 0.5 * beyond;
    c.at_wall[2 * k] = window.first[k] == 0;
    c.at_wall[2 * k + 1] = window.first[k] + window.n[k] == cells;
    c.unit /= width;
    c.push[k] = dt2 / width *
                (params->gravity[k] -
                 params->attraction * (c.lower[k] - 0.5 * width - params->attraction_center[k]));
    c.pull[k] = -dt2 * params->attraction;
    c.wrap[k] = pbf_pressure_grid_wraps(params, walls, k) ? (uint32_t)c.n[k] * c.nodes : 0;
    if (c.wrap[k]) c.push[k] = c.pull[k] = 0; /* fluid stands against nothing there, and flows */
    c.middle[k] = (c.n[k] + 1) / 2;
    c.drag_move[k] = c.move * params->drag_velocity[k];
    if (fabs(c.push[k]) > fabs(c.push[c.axis])) c.axis = k;
    for (int a = 0; a < PBF_CORNERS; ++a) c.corner[a] += (uint32_t)(a >> k & 1) * c.nodes;
    c.size[k] = (uint32_t)c.n[k] + 2;
    c.nodes *= c.size[k];
  }
  return c;
}

/* In the step that ends then, of the domain's own walls: where a container ends before, it is that
 * which gains. */
static inline void pbf_pressure_grid_set_gains(pbf_pressure_grid *c, const pbf_params *params,
                                               const pbf_domain *walls, double time) {
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real lower = (pbf_real)pbf_motion_wall(params, 2 * k, time);
    const pbf_real upper = (pbf_real)pbf_motion_wall(params, 2 * k + 1, time);
    if (c->at_wall[2 * k] && walls->lower.c[k] == lower)
      c->lower_gain[k] = c->per_width * pbf_motion_wall_gain(params, 2 * k, time);
    if (c->at_wall[2 * k + 1] && walls->upper.c[k] == upper)
      c->upper_gain[k] = c->per_width * pbf_motion_wall_gain(params, 2 * k + 1, time);
  }
}

PBF_FN int pbf_pressure_grid_is_periodic(const pbf_pressure_grid *c) {
  int any = 0;
  for (int k = 0; k < PBF_DIM; ++k) any |= c->wrap[k] > 0;
  return any;
}

/* Where along each axis an index is; 0 and n + 1 are cells outside, 0 is a node outside. */
PBF_FN void pbf_pressure_grid_place(const pbf_pressure_grid *c, uint32_t index, int at[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    at[k] = (int)(index % c->size[k]);
    index /= c->size[k];
  }
}

/* ---- Particles ----------------------------------------------------------------------------- */

/* How many cells inside lie before x, along an axis, … */
PBF_FN double pbf_pressure_grid_before(const pbf_pressure_grid *c, int axis, pbf_real x) {
  return pbf_max(((double)x - c->lower[axis]) * c->per_width, 0);
}

/* … the index of the cell that holds it, and where x is in that. */
PBF_FN uint32_t pbf_pressure_grid_index(const pbf_pressure_grid *c, int axis, double before,
                                        double *at) {
  int i = (int)pbf_min(before, c->n[axis] - 1);
  *at = pbf_min(before - i, 1);
  return (uint32_t)(i + 1);
}

PBF_FN uint32_t pbf_pressure_grid_cell(const pbf_pressure_grid *c, pbf_vec x, double at[PBF_DIM]) {
  uint32_t cell = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k)
    cell = cell * c->size[k] +
           pbf_pressure_grid_index(c, k, pbf_pressure_grid_before(c, k, x.c[k]), &at[k]);
  return cell;
}

/* What a particle adds to its cell's sum: one to the count in the upper 24 bits, its density
 * error to what is below, less what is allowed for an overlap (passes/overlap.h), which would be
 * thrown apart here as in the iterations. The sum of integers is the same in any order. */
PBF_FN int64_t pbf_pressure_grid_entry(pbf_real target, pbf_real density, pbf_real overlap) {
  double error = pbf_max(pbf_min((double)(density - target), 1), -1);
  if (error > 0) error = pbf_max(error - (double)overlap, 0);
  return ((int64_t)1 << 40) + (int)(error * (1 << 20));
}

/* And its place in the cell, in 128ths along each axis, of which the sums have 21 bits each: those
 * of so many particles and fewer. */
enum {
  PBF_CELL_PLACE_PARTS = 128,
  PBF_CELL_PLACE_BITS = 21,
  PBF_MAX_CELL_PLACES = (1 << PBF_CELL_PLACE_BITS) / PBF_CELL_PLACE_PARTS - 1
};

/* They are rounded where no lattice's rows are, which would go either way, all at once. */
PBF_FN int64_t pbf_pressure_grid_place_entry(const double at[PBF_DIM]) {
  int64_t entry = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k)
    entry = (entry << PBF_CELL_PLACE_BITS) +
            (int)(pbf_max(pbf_min(at[k], 1), 0) * PBF_CELL_PLACE_PARTS + 0.3);
  return entry;
}

/* The mean place of `count` particles along an axis, in cells. What rounds down after 0.3 has been
 * added takes 0.2 of a part away, on average. */
PBF_FN double pbf_pressure_grid_mean_place(int64_t places, int64_t count, int axis) {
  const int64_t sum = places >> PBF_CELL_PLACE_BITS * axis & ((1 << PBF_CELL_PLACE_BITS) - 1);
  return ((double)sum / (double)count + 0.2) / PBF_CELL_PLACE_PARTS;
}

/* From a to b: a difference, or what is between them. */
PBF_FN double pbf_pressure_grid_on_edge(double a, double b, int differs, double at) {
  return differs ? b - a : a + at * (b - a);
}

/* A face's function and a cell's at the place `at`, from the values at its corners: the derivative
 * along an axis, or where `axis` is none of them the value. */
PBF_FN double pbf_pressure_grid_on_face(const double *values, const double *at, int axis) {
  return pbf_pressure_grid_on_edge(
      pbf_pressure_grid_on_edge(values[0], values[1], axis == 0, at[0]),
      pbf_pressure_grid_on_edge(values[2], values[3], axis == 0, at[0]), axis == 1, at[1]);
}

PBF_FN double pbf_pressure_grid_in_cell(const double values[PBF_CORNERS], const double at[PBF_DIM],
                                        int axis) {
  double first = pbf_pressure_grid_on_face(values, at, axis);
  if (PBF_DIM == 2) return first;
  double second = pbf_pressure_grid_on_face(values + PBF_CORNERS / 2, at, axis);
  return pbf_pressure_grid_on_edge(first, second, axis == 2, at[PBF_DIM - 1]);
}

PBF_FN double pbf_pressure_grid_deepest(const double values[PBF_CORNERS]) {
  double deepest = 0;
  for (int a = 0; a < PBF_CORNERS; ++a) deepest = pbf_min(deepest, values[a]);
  return deepest;
}

/* u there, from lambda at the corners of a cell. It ends a quarter of a cell above the surface:
 * what flies there falls. */
PBF_FN pbf_vec pbf_pressure_grid_correction_from(const pbf_pressure_grid *c,
                                                 const double values[PBF_CORNERS],
                                                 const double at[PBF_DIM]) {
  const double above = pbf_pressure_grid_in_cell(values, at, PBF_DIM);
  const double any = pbf_pressure_grid_deepest(values) < 0 ? 1 : 0;
  double slope[PBF_DIM], slope2 = 1e-60;
  for (int k = 0; k < PBF_DIM; ++k) {
    slope[k] = pbf_pressure_grid_in_cell(values, at, k);
    slope2 += slope[k] * slope[k];
  }
  const double fades = pbf_min(1 - 4 * above / sqrt(slope2), 1);
  const double scale = any * c->width * pbf_max(fades, 0);
  pbf_vec u;
  for (int k = 0; k < PBF_DIM; ++k) u.c[k] = (pbf_real)(scale * slope[k]);
  return u;
}

/* ---- Cells --------------------------------------------------------------------------------- */

PBF_FN int64_t pbf_pressure_grid_count(int64_t sum) { return (sum + ((int64_t)1 << 39)) >> 40; }

PBF_FN double pbf_pressure_grid_fill(const pbf_pressure_grid *c, int64_t sum) {
  return c->unit * (double)pbf_pressure_grid_count(sum);
}

PBF_FN double pbf_pressure_grid_error(const pbf_pressure_grid *c, int64_t sum) {
  return c->unit * (double)(sum - pbf_pressure_grid_count(sum) * ((int64_t)1 << 40)) / (1 << 20);
}

/* Whether the i-th cell along an axis is the first at the lower wall, or the last at the upper one.
 */
PBF_FN int pbf_pressure_grid_is_first(const pbf_pressure_grid *c, int axis, int i) {
  return i == 1 && c->at_wall[2 * axis];
}

PBF_FN int pbf_pressure_grid_is_last(const pbf_pressure_grid *c, int axis, int i) {
  return i == c->n[axis] && c->at_wall[2 * axis + 1];
}

/* The part of a cell, the i-th along each axis, that is inside the walls. */
PBF_FN double pbf_pressure_grid_inside(const pbf_pressure_grid *c, const int i[PBF_DIM]) {
  double inside = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    if (i[k] == 0 || i[k] > c->n[k]) return 0;
    if (pbf_pressure_grid_is_first(c, k, i[k]) || pbf_pressure_grid_is_last(c, k, i[k]))
      inside *= c->edge[k];
  }
  return inside;
}

/* Particles come to rest half a spacing off a solid: less of a cell than so many spacings, and a
 * little, holds no row of them. */
#define PBF_PRESSURE_GRID_SLIVER 0.6

/* The part of a cell around `middle` that a surface leaves free; none where it has no row of
 * particles: an empty sliver would be air, in which pressure ends. */
template <class Surface>
PBF_FN double pbf_part_free_of(const pbf_pressure_grid *c, const Surface *s, pbf_vec middle,
                               pbf_vec *normal) {
  const pbf_real enough = (pbf_real)(0.5 * c->width);
  const double distance = (double)pbf_nearest_distance(s, middle, enough, normal);
  const double part = pbf_min(0.5 + distance / c->width, 1);
  return part < PBF_PRESSURE_GRID_SLIVER * c->spacing ? 0 : part;
}

/* The part that two surfaces leave which leave `a` and `b`: the product where they are at right
 * angles, the smaller one where they face the same way, as flush boxes in a floor, and what is
 * between where they face each other: nothing below a box that stands on another one. */
PBF_FN double pbf_part_free_of_both(double a, double b, double cosine) {
  const double aligned = cosine > 0 ? pbf_min(a, b) : pbf_max(a + b - 1, 0);
  const double weight = fabs(cosine);
  return (1 - weight) * (a * b) + weight * aligned;
}

namespace {

/* The part of what earlier ones leave of a cell that the surface of a number leaves. */
template <class Obstacles>
PBF_FN double pbf_part_left_by(const pbf_pressure_grid *c, const Obstacles &o, int number,
                               pbf_vec middle) {
  pbf_vec normal, of_other;
  const double part = pbf_part_free_of(c, &o.surfaces[number], middle, &normal);
  double left = part;
  for (int s = 0; s < number && part < 1; ++s) {
    const double other = pbf_part_free_of(c, &o.surfaces[s], middle, &of_other);
    if (!(other > 0 && other < 1)) continue;
    const double cosine = (double)pbf_dot(normal, of_other);
    const double both = pbf_part_free_of_both(other, part, pbf_max(pbf_min(cosine, 1), -1)) / other;
    if (fabs(both - part) > fabs(left - part)) left = both;
  }
  return left;
}

/* The part that is free of colliders, too. */
template <class Obstacles>
PBF_FN double pbf_pressure_grid_free_volume_at(const pbf_pressure_grid *c, const Obstacles &o,
                                               const int i[PBF_DIM]) {
  double free_volume = pbf_pressure_grid_inside(c, i);
  pbf_vec middle;
  for (int k = 0; k < PBF_DIM; ++k) middle.c[k] = (pbf_real)(c->lower[k] + (i[k] - 0.5) * c->width);
  for (int s = 0; s < pbf_surface_count(o) && free_volume > 0; ++s)
    free_volume *= pbf_part_left_by(c, o, s, middle);
  return free_volume;
}

template <class Obstacles>
PBF_FN double pbf_pressure_grid_free_volume(const pbf_pressure_grid *c, const Obstacles &o,
                                            uint32_t cell) {
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, cell, i);
  return pbf_pressure_grid_free_volume_at(c, o, i);
}

}  // namespace

/* Whether what fills a cell counts for the fluid's depth: nodes that are not in the open have one
 * that does. */
PBF_FN int pbf_pressure_grid_is_filled(const pbf_pressure_grid *c, int64_t sum,
                                       double free_volume) {
  return free_volume > 0 &&
         pbf_pressure_grid_fill(c, sum) >= PBF_PRESSURE_GRID_FILLED * free_volume;
}

/* Where filled cells are along each axis: the largest of their indices, and of these from the other
 * end; 0 when there are none. */
typedef struct pbf_pressure_grid_extent {
  uint32_t above[PBF_DIM], below[PBF_DIM];
} pbf_pressure_grid_extent;

/* What a step does about the fluid in these cells. */
typedef struct pbf_pressure_grid_source_scale {
  double part;  /* of the forces' pressure, */
  double share; /* and of the density errors, before that part is taken */
  int longest;  /* run of nodes along an axis, at most */
} pbf_pressure_grid_source_scale;

/* The part of the forces' pressure that the grid carries, where the iterations alone would leave
 * `error` under all of the fluid and the forces push by `fastest` cells a step. In long steps,
 * which fall by a 36th of a cell and more, the weight of a cell's height is left to the iterations,
 * too, in shorter ones less of it: with too little, fluid of lambda's one sign spreads until it
 * fills 1.4 times its volume. Where forces alone cross half a cell in a step, what the grid sees is
 * not where the fluid is. */
PBF_FN double pbf_pressure_grid_part(const pbf_pressure_grid *c, double error, double fastest) {
  double cell = c->error * fastest;
  double left = pbf_max(PBF_DEPTH_LEFT, PBF_DEPTH_SHARE * (error - PBF_DEPTH_FROM));
  left = pbf_min(left, pbf_max(c->max_left * error, c->left_cells * cell));
  left = pbf_max(left, cell * pbf_min(36 * fastest, 1));
  if (!(error > left && fastest < 0.5)) return 0;
  return (1 - left / error) * pbf_min(1, 2 - 4 * fastest);
}

/* Errors go as fast as the fluid could fall through its depth: a faster share throws it up, a
 * slower one is not heard. */
PBF_FN pbf_pressure_grid_source_scale
pbf_pressure_grid_source_scale_of(const pbf_pressure_grid *c, const pbf_pressure_grid_extent *e) {
  pbf_pressure_grid_source_scale source_scale = {0, 0, 1};
  double head = 0, fastest = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    int last = (int)e->above[k], first = c->n[k] + 1 - (int)e->below[k], cells = last + 1 - first;
    if (cells <= 0) return source_scale;
    double push =
        pbf_max(fabs(c->push[k] + c->pull[k] * first), fabs(c->push[k] + c->pull[k] * last));
    head += cells * push;
    fastest = pbf_max(fastest, push);
    if (cells >= source_scale.longest) source_scale.longest = cells + 1;
  }
  source_scale.part = pbf_pressure_grid_part(c, c->error * head, fastest);
  if (source_scale.part > 0) source_scale.share = fastest / sqrt(head);
  return source_scale;
}

#endif
