/* Part of kernels.cpp: loops over single particles, left to the compiler's vectoriser. */
#ifndef PBF_CPU_KERNELS_PARTICLES_H
#define PBF_CPU_KERNELS_PARTICLES_H

#include "cpu/clear_lanes.h"
#include "cpu/kernels_collide.h"
#include "physics/passes/density.h"
#include "physics/passes/predict.h"
#include "physics/passes/start.h"
#include "physics/passes/velocity.h"

static void clamp_range(const pbf_domain *between, field x, uint32_t first, uint32_t last) {
  const pbf_domain domain = *between;
  for (uint32_t i = first; i < last; ++i)
    field_set(&x, i, pbf_keep_in_domain(&domain, field_at(&x, i)));
}

/* Where they are and where they come from. */
static group_bounds bounds_of_range(const field *from, const field *x, uint32_t first,
                                    uint32_t last) {
  pbf_vec lower = field_at(x, first), upper = lower;
  pbf_real way2 = 0;
  for (uint32_t i = first; i < last; ++i) {
    pbf_vec to = field_at(x, i), start = field_at(from, i), way = pbf_sub(to, start);
    for (int k = 0; k < PBF_DIM; ++k) {
      lower.c[k] = pbf_real_min(lower.c[k], pbf_real_min(to.c[k], start.c[k]));
      upper.c[k] = pbf_real_max(upper.c[k], pbf_real_max(to.c[k], start.c[k]));
    }
    way2 = pbf_real_max(way2, pbf_dot(way, way));
  }
  return bounds_between(lower, upper, pbf_real_sqrt(way2));
}

/* As many particles as there are lanes, or fewer: those that meet a collider alone ask for those
 * that they may meet. False: nothing is known of any. */
static __attribute__((noinline)) bool collide_lanes(const pbf_obstacles *o,
                                                    int with_obstacle_motion, const field *from,
                                                    const field *x, uint32_t first,
                                                    uint32_t lanes) {
  const lane_values starts = load_some_lanes(from, first, lanes);
  const lane_values ends = load_some_lanes(x, first, lanes);
  lane_values kept = ends;
  lane_marks clear;
  clamp_group(o, &kept);
  if (!find_clear_lanes(o, with_obstacle_motion, &starts, &ends, &kept, &clear)) return false;
  if (!o->grid && lane_any_below(lane_load(clear.is), ops<lane>::set(1))) return false;
  for (uint32_t l = 0; l < lanes; ++l)
    if (!(clear.is[l] > 0))
      set_lane(
          &kept, l,
          resolve_alone(o, with_obstacle_motion, lane_value(&starts, l), lane_value(&ends, l)));
  store_lanes(x, first, lanes, &kept);
  return true;
}

/* Particles on their way from `from` to x; from before the obstacles moved where
 * `with_obstacle_motion`. */
static __attribute__((noinline)) void collide_range(const pbf_obstacles *o,
                                                    int with_obstacle_motion, field from, field x,
                                                    uint32_t first, uint32_t last) {
  enum { AT_ONCE = 32, OF_MANY_AT_ONCE = 8 };
  if (pbf_surface_count(*o) == 0) {
    clamp_range(&o->domain, x, first, last);
    return;
  }
  if (!BUILT_FOR_SIZE && last - first > WIDTH) {
    for (uint32_t begin = first, lanes; begin < last; begin += lanes) {
      lanes = last - begin < WIDTH ? last - begin : (uint32_t)WIDTH;
      if (!collide_lanes(o, with_obstacle_motion, &from, &x, begin, lanes))
        collide_range(o, with_obstacle_motion, from, x, begin, begin + lanes);
    }
    return;
  }
  const uint32_t most = o->grid ? (uint32_t)OF_MANY_AT_ONCE : (uint32_t)AT_ONCE;
  for (uint32_t begin = first, end; begin < last; begin = end) {
    end = last - begin < most ? last : begin + most;
    const group_bounds these = bounds_of_range(&from, &x, begin, end);
    if (!resolve_ways(o, &these, with_obstacle_motion, [&](auto resolve) {
          for (uint32_t i = begin; i < end; ++i)
            field_set(&x, i, resolve(field_at(&from, i), field_at(&x, i)));
        }))
      clamp_range(&o->domain, x, begin, end);
  }
}

PBF_FN void predict_lanes(const pbf_forces *f, const field *x, const field *v,
                          const field *predicted, const field *kept, uint32_t i, uint32_t lanes) {
  const lane_values xs = load_lanes(x, i, lanes), vs = load_lanes(v, i, lanes);
  lane_values ys;
  for (uint32_t l = 0; l < WIDTH; ++l)
    set_lane(&ys, l, pbf_predict(f, lane_value(&xs, l), lane_value(&vs, l)));
  store_lanes(predicted, i, lanes, &ys);
  store_lanes(kept, i, lanes, &ys);
}

PBF_FN void predict_velocities(const pbf_forces *f, const field *x, const field *v,
                               const field *predicted, const field *velocity, uint32_t i,
                               uint32_t lanes) {
  const lane_values xs = load_lanes(x, i, lanes), vs = load_lanes(v, i, lanes);
  const lane_values ys = load_lanes(velocity, i, lanes), after = load_lanes(predicted, i, lanes);
  lane_values us;
  for (uint32_t l = 0; l < WIDTH; ++l)
    set_lane(&us, l,
             pbf_predicted_velocity(f, lane_value(&xs, l), lane_value(&vs, l), lane_value(&ys, l),
                                    lane_value(&after, l)));
  store_lanes(velocity, i, lanes, &us);
}

static void predict(const pbf_forces *forces, const pbf_obstacles *obstacles, int collide, field x,
                    field v, field predicted, field velocity, uint32_t first, uint32_t last) {
  const pbf_forces f = *forces;
  const uint32_t rest = (last - first) % WIDTH, whole = last - rest;
  /* `velocity` keeps the prediction until the obstacles are done. */
  for (uint32_t i = first; i < whole; i += WIDTH)
    predict_lanes(&f, &x, &v, &predicted, &velocity, i, WIDTH);
  predict_lanes(&f, &x, &v, &predicted, &velocity, whole, rest);
  if (collide) collide_range(obstacles, 1, x, predicted, first, last);
  for (uint32_t i = first; i < whole; i += WIDTH)
    predict_velocities(&f, &x, &v, &predicted, &velocity, i, WIDTH);
  predict_velocities(&f, &x, &v, &predicted, &velocity, whole, rest);
}

/* Where particles were at the start of the step. */
static void backtrack(pbf_real time_step, field predicted, field velocity, field before,
                      uint32_t first, uint32_t last) {
  for (uint32_t i = first; i < last; ++i)
    field_set(&before, i, pbf_start(time_step, field_at(&predicted, i), field_at(&velocity, i)));
}

static void residual_density(const pbf_constants *constants, pbf_real *density, uint32_t first,
                             uint32_t last) {
  const pbf_constants c = *constants;
  for (uint32_t i = first; i < last; ++i) density[i] = pbf_residual_density(&c, density[i]);
}

/* NaN leaves the bounds as they are. Lower ones are the greatest of the opposite numbers. */
static void bounds(field x, uint32_t first, uint32_t last, pbf_vec *lower, pbf_vec *upper) {
  const uint32_t whole = last - (last - first) % WIDTH;
  lane_vector<lane> below, above;
  for (int k = 0; k < PBF_DIM; ++k) {
    below.c[k] = ops<lane>::set(-lower->c[k]);
    above.c[k] = ops<lane>::set(upper->c[k]);
  }
  for (uint32_t i = first; i < whole; i += WIDTH)
    for (int k = 0; k < PBF_DIM; ++k) {
      const lane at = lane_load(x.c[k] + i);
      below.c[k] = ops<lane>::max(-at, below.c[k]);
      above.c[k] = ops<lane>::max(at, above.c[k]);
    }
  const lane_values opposite = values_of(below), highs = values_of(above);
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real low = lower->c[k], high = upper->c[k];
    for (uint32_t l = 0; l < WIDTH; ++l) {
      low = pbf_real_min(-opposite.c[k][l], low);
      high = pbf_real_max(highs.c[k][l], high);
    }
    for (uint32_t i = whole; i < last; ++i) {
      low = pbf_real_min(x.c[k][i], low);
      high = pbf_real_max(x.c[k][i], high);
    }
    lower->c[k] = low;
    upper->c[k] = high;
  }
}

static inline __attribute__((always_inline)) void cells_of(const grid *of, field x, uint32_t first,
                                                           uint32_t last, const int wrapped,
                                                           uint32_t *restrict cell) {
  const grid g = *of;
  for (uint32_t i = first; i < last; ++i) cell[i] = grid_cell(&g, field_at(&x, i), wrapped);
}

static void cells(const grid *of, field x, uint32_t first, uint32_t last, uint32_t *cell,
                  uint32_t *lowest, uint32_t *highest) {
  uint32_t low = UINT32_MAX, high = 0;
  if (grid_is_wrapped(of))
    cells_of(of, x, first, last, 1, cell);
  else
    cells_of(of, x, first, last, 0, cell);
  for (uint32_t i = first; i < last; ++i) {
    low = cell[i] < low ? cell[i] : low;
    high = cell[i] > high ? cell[i] : high;
  }
  *lowest = low;
  *highest = high;
}

/* Once the velocity is that of x. */
static void collide(const pbf_obstacles *o, pbf_real inv_time_step, field predicted, field x,
                    field velocity, uint32_t first, uint32_t last) {
  enum { AT_ONCE = 64 };
  pbf_vec before[AT_ONCE];
  for (uint32_t begin = first, end; begin < last; begin = end) {
    end = last - begin < AT_ONCE ? last : begin + AT_ONCE;
    for (uint32_t i = begin; i < end; ++i) before[i - begin] = field_at(&x, i);
    collide_range(o, 0, predicted, x, begin, end);
    for (uint32_t i = begin; i < end; ++i)
      field_set(
          &velocity, i,
          pbf_velocity(inv_time_step, field_at(&velocity, i), before[i - begin], field_at(&x, i)));
  }
}

#endif
