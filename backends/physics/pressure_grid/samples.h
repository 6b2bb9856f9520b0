/* The points in a cell that tell what of it is on which side of a solid (compartments.h). */
#ifndef PBF_PHYSICS_PRESSURE_GRID_SAMPLES_H
#define PBF_PHYSICS_PRESSURE_GRID_SAMPLES_H

#include "physics/pressure_grid/compartments.h"

/* The point `at` along each axis in the cell that is the i-th along each. */
PBF_FN pbf_vec pbf_sample_at(const pbf_pressure_grid *c, const int i[PBF_DIM],
                             const int at[PBF_DIM]) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k)
    x.c[k] = (pbf_real)(c->lower[k] + (i[k] - 1 + (at[k] + 0.5) / PBF_SAMPLES) * c->width);
  return x;
}

PBF_FN void pbf_sample_place(int sample, int at[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    at[k] = sample % PBF_SAMPLES;
    sample /= PBF_SAMPLES;
  }
}

PBF_FN int pbf_sample_stride(int axis) {
  return axis == 0 ? 1 : axis == 1 ? PBF_SAMPLES : PBF_SAMPLES * PBF_SAMPLES;
}

PBF_FN int pbf_sample_index(const int at[PBF_DIM]) {
  int index = 0;
  for (int k = 0; k < PBF_DIM; ++k) index += at[k] * pbf_sample_stride(k);
  return index;
}

PBF_FN pbf_vec pbf_cell_middle(const pbf_pressure_grid *c, const int i[PBF_DIM]) {
  pbf_vec middle;
  for (int k = 0; k < PBF_DIM; ++k) middle.c[k] = (pbf_real)(c->lower[k] + (i[k] - 0.5) * c->width);
  return middle;
}

/* Nothing in a cell is farther from its middle. */
PBF_FN double pbf_cell_reach(const pbf_pressure_grid *c) {
  return (PBF_DIM == 3 ? 0.867 : 0.708) * c->width;
}

/* Whether a solid can have two sides in one cell, or at one node: nodes are twice as far apart as
 * their cells reach. */
PBF_FN int pbf_surface_is_thin(const pbf_pressure_grid *c, const pbf_surface *s) {
  return !pbf_surface_is_unbounded(s) && pbf_surface_width(s) < 4 * pbf_cell_reach(c);
}

template <class Topology>
PBF_FN int pbf_thin_solid_reaches(const pbf_pressure_grid *c, const Topology *t,
                                  const int i[PBF_DIM]) {
  const pbf_vec middle = pbf_cell_middle(c, i);
  const pbf_topology_near near = pbf_topology_near_of(t, middle, pbf_cell_reach(c));
  for (int k = 0; k < near.count; ++k) {
    const int s = pbf_topology_number(&near, k);
    pbf_vec normal;
    if (pbf_surface_is_thin(c, &t->surfaces[s]) &&
        (double)pbf_surface_distance(pbf_topology_surface(t, s), middle, &normal) <
            (double)t->surfaces[s].steepest * pbf_cell_reach(c))
      return 1;
  }
  return 0;
}

/* Nothing is nearer to a point than to all others and farther from it, in distances between points:
 * half a diagonal, with a margin. */
#define PBF_SAMPLE_REACH (PBF_DIM == 3 ? 0.88f : 0.72f)

/* Of a cell: which points are free, which see all that they are nearest to, which are connected
 * with the next one along each axis, and how far each is from what is nearest, at most a distance
 * between points. */
typedef struct pbf_cell_points {
  uint64_t free, clear, open[PBF_DIM];
  float nearest[64];
} pbf_cell_points;

/* A way is free of a solid that is farther from both its ends together than it is long. */
template <class Surface>
PBF_FN_HOST_NOINLINE void pbf_cell_points_around(const pbf_pressure_grid *c, const Surface *s,
                                                 const int i[PBF_DIM], pbf_cell_points *points) {
  const float spacing = (float)(c->width / PBF_SAMPLES);
  float distances[64];
  int at[PBF_DIM];
  for (int p = 0; p < 64; ++p) {
    pbf_vec normal;
    pbf_sample_place(p, at);
    distances[p] = (float)pbf_surface_distance(s, pbf_sample_at(c, i, at), &normal);
    if (!(distances[p] > PBF_SAMPLE_CLEARANCE * spacing)) points->free &= ~(UINT64_C(1) << p);
    if (!(distances[p] > PBF_SAMPLE_REACH * (float)s->steepest * spacing))
      points->clear &= ~(UINT64_C(1) << p);
    if (distances[p] < points->nearest[p]) points->nearest[p] = distances[p];
  }
  for (int p = 0; p < 64; ++p) {
    if (!(points->free >> p & 1)) continue;
    pbf_sample_place(p, at);
    const pbf_vec from = pbf_sample_at(c, i, at);
    for (int k = 0; k < PBF_DIM; ++k) {
      const int next = p + pbf_sample_stride(k);
      if (at[k] == PBF_SAMPLES - 1 || !(points->free >> next & 1)) continue;
      if (distances[p] + distances[next] > 1.001f * (float)s->steepest * spacing) continue;
      pbf_vec to = from;
      to.c[k] += (pbf_real)spacing;
      if (pbf_surface_blocks(s, from, to)) points->open[k] &= ~(UINT64_C(1) << p);
    }
  }
}

PBF_FN void pbf_cell_points_within(const pbf_pressure_grid *c, const pbf_domain *domain,
                                   const int i[PBF_DIM], pbf_cell_points *points) {
  int at[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) points->open[k] = 0;
  points->free = points->clear = PBF_ALL_SAMPLES;
  for (int p = 0; p < 64; ++p) {
    pbf_sample_place(p, at);
    points->nearest[p] = (float)pbf_domain_distance(domain, pbf_sample_at(c, i, at));
    if (!(points->nearest[p] > 0)) points->free &= ~(UINT64_C(1) << p);
    for (int k = 0; k < PBF_DIM; ++k)
      if (at[k] < PBF_SAMPLES - 1) points->open[k] |= UINT64_C(1) << p;
  }
}

template <class Topology>
PBF_FN_HOST_NOINLINE void pbf_find_cell_points(const pbf_pressure_grid *c, const Topology *t,
                                               const int i[PBF_DIM], pbf_cell_points *points) {
  const pbf_vec middle = pbf_cell_middle(c, i);
  const double reach = pbf_cell_reach(c) + c->width / PBF_SAMPLES;
  const pbf_topology_near near = pbf_topology_near_of(t, middle, reach);
  pbf_cell_points_within(c, &t->domain, i, points);
  for (int k = 0; k < near.count; ++k) {
    const int s = pbf_topology_number(&near, k);
    pbf_vec normal;
    const double distance =
        (double)pbf_surface_distance(pbf_topology_surface(t, s), middle, &normal);
    if (distance < (double)t->surfaces[s].steepest * reach)
      pbf_cell_points_around(c, pbf_topology_surface(t, s), i, points);
  }
  points->clear &= points->free;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int stride = pbf_sample_stride(k);
    points->open[k] &= points->free & points->free >> stride;
  }
}

/* The points that hang together with the lowest of these. */
PBF_FN uint64_t pbf_points_connected(const pbf_cell_points *points, uint64_t of) {
  uint64_t reached = of & (~of + 1), before = 0;
  while (reached != before) {
    before = reached;
    for (int k = 0; k < PBF_DIM; ++k) {
      const int stride = pbf_sample_stride(k);
      reached |= (reached & points->open[k]) << stride;
      reached |= reached >> stride & points->open[k];
    }
  }
  return reached;
}

/* What is free around points, in cells: one next to a solid has half of what is between points, and
 * what is between it and the solid, so that the sum grows evenly as a solid moves away. */
PBF_FN void pbf_points_volume(const pbf_pressure_grid *c, const pbf_cell_points *points,
                              uint64_t of, double parts[PBF_PARTS]) {
  const double per_spacing = PBF_SAMPLES / c->width;
  for (int k = 0; k < PBF_PARTS; ++k) parts[k] = 0;
  for (int p = 0; p < 64; ++p) {
    if (!(of >> p & 1)) continue;
    const double nearest = (double)points->nearest[p] * per_spacing;
    const double volume = (nearest < 1 + PBF_SAMPLE_CLEARANCE ? 0.5 + nearest : 1) / 64;
    int at[PBF_DIM];
    pbf_sample_place(p, at);
    parts[0] += volume;
    for (int k = 0; k < PBF_DIM; ++k) parts[1 + k] += volume * (at[k] + 0.5) / PBF_SAMPLES;
  }
}

#endif
