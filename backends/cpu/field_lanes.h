/* Part of clear_lanes.h: how far the particles of a group are from a surface of interpolated
 * distances (physics/surfaces/field.h), a particle in each lane, as pbf_look_within has it to the
 * bit. The nodes around each are fetched one after another, for those that are wanted; all else is
 * of all lanes, in loops that are left to the compiler's vectoriser. */
#ifndef PBF_CPU_FIELD_LANES_H
#define PBF_CPU_FIELD_LANES_H

#include "cpu/lane_values.h"
#include "physics/facets.h"

namespace {

/* Weights of the nodes around places, and the nodes, row by row. */
struct lane_nodes {
  alignas(64) pbf_real weight[PBF_DIM][3][WIDTH], slope[PBF_DIM][3][WIDTH];
  alignas(64) int middle[PBF_DIM][WIDTH];
  alignas(64) pbf_real of[3 * PBF_FIELD_ROWS][WIDTH];
};

/* pbf_field_nearest in each lane, and how far it is past the grid. */
struct lane_nearest {
  alignas(64) pbf_real distance[WIDTH], beyond2[WIDTH];
  lane_values slope, beyond;
};

/* What is nearest of a surface, and how steep its distance is there. */
struct lane_looks {
  alignas(64) pbf_real distance[WIDTH], steepness[WIDTH];
  lane_values normal;
};

struct lane_aheads {
  alignas(64) pbf_real plane[WIDTH], point[WIDTH], asks[WIDTH];
  lane_values way, foot;
};

}  // namespace

/* Whether indices of its nodes are numbers of 32 bits, as places in lanes are. */
PBF_FN bool fits_lanes(const pbf_shape *f) {
  return (uint64_t)f->nodes[0] * f->nodes[1] * f->nodes[2] <= INT32_MAX;
}

static __attribute__((noinline)) void find_weights(const pbf_surface *surface,
                                                   const lane_values *at,
                                                   lane_nearest *restrict nearest,
                                                   lane_nodes *restrict nodes) {
  const pbf_shape f = *surface->field;
  pbf_surface s = *surface;
  s.field = &f;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec beyond;
    pbf_real beyond2;
    const pbf_vec place = pbf_field_within_grid(&s, lane_value(at, l), &beyond, &beyond2);
    nearest->beyond2[l] = beyond2;
    for (int k = 0; k < PBF_DIM; ++k) {
      const int middle = pbf_field_middle(&f, k, place.c[k]);
      const pbf_spline along = pbf_spline_at(place.c[k] - (pbf_real)middle);
      nearest->beyond.c[k][l] = beyond.c[k];
      nodes->middle[k][l] = middle;
      for (int i = 0; i < 3; ++i) nodes->weight[k][i][l] = along.weight[i];
      for (int i = 0; i < 3; ++i) nodes->slope[k][i][l] = along.slope[i];
    }
  }
}

static __attribute__((noinline)) void fetch_nodes(const pbf_shape *f, const pbf_real wanted[WIDTH],
                                                  lane_nodes *nodes) {
  const uint64_t row = f->nodes[0], level = PBF_DIM == 3 ? row * f->nodes[1] : 0;
  memset(nodes->of, 0, sizeof nodes->of);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    if (!(wanted[l] > 0)) continue;
    const float *first = f->values + (nodes->middle[0][l] - 1);
    first += (uint64_t)(nodes->middle[1][l] - 1) * row;
    if (PBF_DIM == 3) first += (uint64_t)(nodes->middle[PBF_DIM - 1][l] - 1) * level;
    for (int j = 0; j < PBF_FIELD_ROWS; ++j)
      for (int i = 0; i < 3; ++i)
        nodes->of[3 * j + i][l] = (pbf_real)first[(j / 3) * level + (j % 3) * row + i];
  }
}

/* pbf_field_interpolated. */
static __attribute__((noinline)) void add_nodes(const lane_nodes *nodes, pbf_real inverse,
                                                pbf_real scale, lane_nearest *restrict nearest) {
  alignas(64) pbf_real sums[1 + PBF_DIM][WIDTH] = {{0}};
  pbf_unrolled<PBF_FIELD_ROWS>([&](int j) __attribute__((always_inline)) {
    for (uint32_t l = 0; l < WIDTH; ++l) {
      pbf_spline along[PBF_DIM];
      pbf_real here = 0, rise = 0;
      for (int k = 0; k < PBF_DIM; ++k)
        for (int i = 0; i < 3; ++i) along[k].weight[i] = nodes->weight[k][i][l];
      for (int k = 0; k < PBF_DIM; ++k)
        for (int i = 0; i < 3; ++i) along[k].slope[i] = nodes->slope[k][i][l];
      for (int i = 0; i < 3; ++i) here += along[0].weight[i] * nodes->of[3 * j + i][l];
      for (int i = 0; i < 3; ++i) rise += along[0].slope[i] * nodes->of[3 * j + i][l];
      const pbf_field_weights weights = pbf_field_row_weights(along, j, inverse);
      for (int k = 0; k <= PBF_DIM; ++k) sums[k][l] += weights.of[k] * (k == 1 ? rise : here);
    }
  });
  for (uint32_t l = 0; l < WIDTH; ++l) nearest->distance[l] = scale * sums[0][l];
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) nearest->slope.c[k][l] = sums[1 + k][l];
}

/* pbf_field_nearest_to places in the frame of the grid. */
static void find_nearest(const pbf_surface *s, const lane_values *at, const pbf_real wanted[WIDTH],
                         lane_nearest *nearest) {
  lane_nodes nodes;
  find_weights(s, at, nearest, &nodes);
  fetch_nodes(s->field, wanted, &nodes);
  add_nodes(&nodes, (pbf_real)(1 / s->field->cell), s->scale, nearest);
}

static __attribute__((noinline)) void look_ahead(const pbf_surface *surface, const lane_values *at,
                                                 const lane_nearest *nearest,
                                                 const pbf_real enough[WIDTH],
                                                 const pbf_real wanted[WIDTH],
                                                 lane_aheads *restrict aheads) {
  const pbf_shape f = *surface->field;
  pbf_surface s = *surface;
  s.field = &f;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_field_nearest one = {nearest->distance[l], lane_value(&nearest->slope, l)};
    const pbf_field_ahead ahead =
        pbf_field_look_ahead(&s, lane_value(at, l), lane_value(&nearest->beyond, l), &one);
    const pbf_real asks = pbf_field_asks_ahead(ahead, enough[l]) ? wanted[l] : 0;
    aheads->plane[l] = ahead.plane;
    aheads->point[l] = ahead.point;
    aheads->asks[l] = nearest->beyond2[l] > 0 ? asks : 0;
    for (int k = 0; k < PBF_DIM; ++k) aheads->way.c[k][l] = ahead.way.c[k];
    for (int k = 0; k < PBF_DIM; ++k) aheads->foot.c[k][l] = ahead.foot.c[k];
  }
}

/* pbf_field_go_on, of those that are past the grid. */
static __attribute__((noinline)) void go_on(const pbf_surface *s, const lane_values *at,
                                            const pbf_real enough[WIDTH],
                                            const pbf_real wanted[WIDTH], lane_nearest *nearest) {
  lane_aheads aheads;
  lane_nearest feet;
  look_ahead(s, at, nearest, enough, wanted, &aheads);
  const bool any = lane_any_below(ops<lane>::set(0), lane_load(aheads.asks));
  if (any) find_nearest(s, &aheads.foot, aheads.asks, &feet);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    if (!(nearest->beyond2[l] > 0)) continue;
    nearest->distance[l] = aheads.plane[l];
    if (!(aheads.asks[l] > 0) || !pbf_field_ends_before(s, feet.distance[l], feet.beyond2[l]))
      continue;
    nearest->distance[l] = aheads.point[l];
    set_lane(&nearest->slope, l, pbf_scaled(lane_value(&aheads.way, l), 1 / aheads.point[l]));
  }
}

static __attribute__((noinline)) void find_grid_places(const pbf_surface *surface,
                                                       const lane_values *x,
                                                       lane_values *restrict at) {
  const pbf_shape f = *surface->field;
  pbf_surface s = *surface;
  s.field = &f;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_vec place = pbf_field_place(&s, pbf_sub(lane_value(x, l), s.center));
    for (int k = 0; k < PBF_DIM; ++k) at->c[k][l] = place.c[k];
  }
}

static __attribute__((noinline)) void turn_looks(const pbf_surface *surface,
                                                 const lane_nearest *nearest,
                                                 lane_looks *restrict looks) {
  const pbf_surface s = *surface;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec normal;
    looks->steepness[l] = pbf_field_turned(&s, lane_value(&nearest->slope, l), &normal);
    looks->distance[l] = s.sign * nearest->distance[l];
    for (int k = 0; k < PBF_DIM; ++k) looks->normal.c[k][l] = s.sign * normal.c[k];
  }
}

/* The same to places in space. */
static void find_nearest_of(const pbf_surface *s, const lane_values *x,
                            const pbf_real wanted[WIDTH], lane_nearest *nearest) {
  lane_values at;
  find_grid_places(s, x, &at);
  find_nearest(s, &at, wanted, nearest);
}

/* pbf_look_within at the lanes that are wanted. */
static void find_looks(const pbf_surface *s, const lane_values *x, const pbf_real enough[WIDTH],
                       const pbf_real wanted[WIDTH], lane_looks *looks) {
  lane_values at;
  lane_nearest nearest;
  find_grid_places(s, x, &at);
  find_nearest(s, &at, wanted, &nearest);
  if (lane_any_below(ops<lane>::set(0), lane_load(nearest.beyond2)))
    go_on(s, &at, enough, wanted, &nearest);
  turn_looks(s, &nearest, looks);
}

#endif
