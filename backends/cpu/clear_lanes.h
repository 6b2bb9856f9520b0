/* How far the particles of a group may go until one of some colliders is met, a particle in each
 * lane, and which of them meet none on their ways: nearly all, which then need not ask one after
 * another. */
#ifndef PBF_CPU_CLEAR_LANES_H
#define PBF_CPU_CLEAR_LANES_H

#include "cpu/field_lanes.h"
#include "cpu/kernels_collide.h"

/* Whether the domain leaves all lanes where they are; it does not what is no number. */
PBF_FN bool is_inside(const pbf_domain *domain, const lane_values *x) {
  bool inside = true;
  for (int k = 0; k < PBF_DIM; ++k)
    inside = inside && lane_all_below(ops<lane>::set(domain->lower.c[k]), lane_load(x->c[k])) &&
             lane_all_below(lane_load(x->c[k]), ops<lane>::set(domain->upper.c[k]));
  return inside;
}

PBF_FN void clamp_group(const pbf_obstacles *obstacles, lane_values *x) {
  if (is_inside(&obstacles->domain, x)) return;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec clamped = pbf_keep_in_domain(&obstacles->domain, lane_value(x, l));
    set_lane(x, l, clamped);
  }
}

/* Of a group's particles, on their way from `from`. */
static __attribute__((noinline)) group_bounds bounds_of_group(const lane_values *from,
                                                              const lane_values *x) {
  pbf_vec lower = lane_value(x, 0), upper = lower;
  pbf_real way2 = 0;
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) {
      lower.c[k] = pbf_real_min(lower.c[k], pbf_real_min(x->c[k][l], from->c[k][l]));
      upper.c[k] = pbf_real_max(upper.c[k], pbf_real_max(x->c[k][l], from->c[k][l]));
    }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec way = pbf_sub(lane_value(x, l), lane_value(from, l));
    way2 = pbf_real_max(way2, pbf_dot(way, way));
  }
  return bounds_between(lower, upper, pbf_real_sqrt(way2));
}

namespace {

/* Calls question(shape) with the shape of a surface; false: it has no closed form. */
template <class Ask>
PBF_FN bool ask_closed(const pbf_surface *s, Ask question) {
  if (pbf_surface_is_field(s)) return false;
  closed_shapes::ask(s->shape, question);
  return true;
}

/* Lets ways from x be no longer than is clear of one surface, 0 where it may be met at x. Its
 * distance changes by no more than the way, whatever the shape. */
template <class Shape>
static __attribute__((noinline)) void shorten_ways(Shape shape, const pbf_surface *surface,
                                                   const lane_values *x, pbf_real *restrict ways) {
  const pbf_surface s = *surface;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec normal;
    int sides;
    const pbf_vec p = pbf_sub(lane_value(x, l), s.center);
    const pbf_real distance = s.sign * pbf_shape_distance(shape, &s, p, &normal, &sides);
    const pbf_real clear = distance - 2 * s.skin - 16 * s.rounding;
    ways[l] = clear > 0 ? pbf_real_min(ways[l], clear) : 0;
  }
}

/* The same of a field, of ways that its ball is not farther than: its distance changes by no more
 * than `steepest` times the way. */
static inline __attribute__((noinline)) void shorten_ways_by_field(const pbf_surface *surface,
                                                                   const lane_values *x,
                                                                   const pbf_real longest[WIDTH],
                                                                   pbf_real *restrict ways) {
  const pbf_surface s = *surface;
  alignas(64) pbf_real near[WIDTH];
  lane_nearest nearest;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real reach = longest[l] + 2 * s.skin + 16 * s.rounding;
    near[l] = pbf_surface_is_beyond(&s, lane_value(x, l), reach) ? 0 : 1;
  }
  if (!lane_any_below(ops<lane>::set(0), lane_load(near))) return;
  find_nearest_of(surface, x, near, &nearest);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real there = nearest.distance[l], beyond2 = nearest.beyond2[l], way = ways[l];
    const pbf_real past = pbf_real_sqrt(beyond2 + there * there); /* pbf_field_past_grid */
    const pbf_real distance = s.sign * (beyond2 > 0 ? past : there);
    const pbf_real clear = (distance - 2 * s.skin - 16 * s.rounding) / s.steepest;
    const pbf_real shorter = clear > 0 ? pbf_real_min(way, clear) : 0;
    ways[l] = near[l] > 0 ? shorter : way;
  }
}

/* The same of some, of ways up to these; false: there are too many nodes for lanes. */
PBF_FN bool shorten_ways_by(const pbf_obstacles *near, const lane_values *x,
                            const pbf_real longest[WIDTH], pbf_real *ways) {
  for (int k = 0; k < near->count; ++k) {
    const pbf_surface *s = &near->surfaces[k];
    if (ask_closed(s, [&](auto shape) { shorten_ways(shape, s, x, ways); })) continue;
    if (!fits_lanes(s->field)) return false;
    shorten_ways_by_field(s, x, longest, ways);
  }
  return true;
}

/* Of each lane 1, where it is one of these, or 0. */
struct lane_marks {
  alignas(64) pbf_real is[WIDTH];
};

}  // namespace

/* The longer of the ways from `from` to x, and to where the domain keeps that: by the axes. */
PBF_FN void find_longest_ways(const lane_values *from, const lane_values *x,
                              const lane_values *kept, pbf_real *restrict ways) {
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real to = 0, back = 0;
    for (int k = 0; k < PBF_DIM; ++k) {
      const pbf_real a = x->c[k][l] - from->c[k][l], b = kept->c[k][l] - from->c[k][l];
      to += pbf_real_max(a, -a);
      back += pbf_real_max(b, -b);
    }
    ways[l] = (1 + bounds_rounding) * pbf_real_max(to, back);
  }
}

/* Those that meet no collider on their way from `from` to x, which the domain keeps at `kept`, and
 * that none carries along; false: nothing is known. */
static inline __attribute__((noinline)) bool find_clear_lanes(
    const pbf_obstacles *o, int with_obstacle_motion, const lane_values *from, const lane_values *x,
    const lane_values *kept, lane_marks *clear) {
  alignas(64) pbf_real gone[WIDTH], ways[WIDTH];
  pbf_obstacles near = *o;
  pbf_real longest = 0;
  bool still = true;
  find_longest_ways(from, x, kept, gone);
  for (uint32_t l = 0; l < WIDTH; ++l) longest = pbf_real_max(longest, gone[l]);
  for (uint32_t l = 0; l < WIDTH; ++l) ways[l] = INFINITY;
  const group_bounds these = bounds_of_group(from, from);
  const pbf_real reach = (o->grid ? (pbf_real)o->grid->stretch : 1) * longest;
  collect_surfaces(
      pbf_obstacles_around(*o, these.lower, these.upper, reach), o->room,
      [&](const pbf_surface *s) {
        const bool moves = with_obstacle_motion && (s->step > 0 || s->turn > 0);
        still = still && !moves;
        return moves ||
               !pbf_surface_is_beyond(s, these.center, these.radius + longest + 2 * s->skin);
      },
      &near);
  if (!still || !shorten_ways_by(&near, from, gone, ways)) return false;
  for (uint32_t l = 0; l < WIDTH; ++l) clear->is[l] = gone[l] < ways[l] ? 1 : 0;
  return true;
}

#endif
