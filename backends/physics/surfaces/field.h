/* Any solid, by signed distances on a grid, between its nodes by quadratic B-splines: planes are
 * exact, spheres of radius r off by cell²/(4 r), and edges rounded off within a cell. With
 * linear interpolation the slopes have steps, and water in a cup stayed in motion at 0.06 to 0.09
 * √(g d) instead of 0.02 (cells of half a spacing). What is between true distances may change by
 * more than the way, `steepest` says by how much. The solid ends within the grid. */
#ifndef PBF_PHYSICS_SURFACES_FIELD_H
#define PBF_PHYSICS_SURFACES_FIELD_H

#include "physics/surfaces/shape.h"

enum {
  PBF_FIELD_ROWS = PBF_DIM == 3 ? 9 : 3, /* of three nodes each that a place has a part of */
  PBF_FIELD_STEPS = 8192                 /* more than any way through a grid takes */
};

PBF_FN pbf_real pbf_field_cell(const pbf_surface *s) { return s->scale * (pbf_real)s->field->cell; }

/* ---- Between nodes -------------------------------------------------------------------------- */

/* Weights of the three nodes around a place along an axis, and their derivatives. */
typedef struct pbf_spline {
  pbf_real weight[3], slope[3];
} pbf_spline;

PBF_FN pbf_spline pbf_spline_at(pbf_real u) {
  const pbf_real half = (pbf_real)0.5, below = half - u, above = half + u;
  const pbf_spline spline = {{half * below * below, (pbf_real)0.75 - u * u, half * above * above},
                             {-below, -2 * u, above}};
  return spline;
}

/* The middle one of the three nodes around a place along an axis. */
PBF_FN int pbf_field_middle(const pbf_shape *f, int axis, pbf_real along) {
  const int last = (int)f->nodes[axis] - 2, nearest = (int)(along + (pbf_real)0.5);
  return nearest < 1 ? 1 : nearest < last ? nearest : last;
}

/* The nodes around a place that is in cells from the first one: the first of them; *along gets
 * their weights, *stride what nodes are apart in memory. */
PBF_FN uint64_t pbf_field_nodes_around(const pbf_shape *f, pbf_vec place, pbf_spline along[PBF_DIM],
                                       uint64_t stride[PBF_DIM]) {
  uint64_t first = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int middle = pbf_field_middle(f, k, place.c[k]);
    stride[k] = k == 0 ? 1 : stride[k - 1] * f->nodes[k - 1];
    along[k] = pbf_spline_at(place.c[k] - (pbf_real)middle);
    first += (uint64_t)(middle - 1) * stride[k];
  }
  return first;
}

/* What a row of three nodes has a part in: the distance, and its slope along each axis. */
typedef struct pbf_field_weights {
  pbf_real of[1 + PBF_DIM];
} pbf_field_weights;

/* Of row j. */
PBF_FN pbf_field_weights pbf_field_row_weights(const pbf_spline along[PBF_DIM], int j,
                                               pbf_real inverse) {
  const int row[2] = {j % 3, j / 3};
  pbf_field_weights weights = {{1}};
  for (int k = 1; k < PBF_DIM; ++k) weights.of[0] *= along[k].weight[row[k - 1]];
  weights.of[1] = inverse * weights.of[0];
  for (int k = 1; k < PBF_DIM; ++k) {
    pbf_real across = along[k].slope[row[k - 1]];
    for (int a = 1; a < PBF_DIM; ++a)
      if (a != k) across *= along[a].weight[row[a - 1]];
    weights.of[1 + k] = inverse * across;
  }
  return weights;
}

/* The distance, and its slopes, lengths over lengths: what compilers make vectors of, all rows at
 * once and then all sums. */
PBF_FN pbf_real pbf_field_interpolated(const pbf_shape *f, pbf_vec place, pbf_vec *slope) {
  pbf_spline along[PBF_DIM];
  uint64_t stride[PBF_DIM];
  const float *first = f->values + pbf_field_nodes_around(f, place, along, stride);
  const pbf_real inverse = (pbf_real)(1 / f->cell);
  pbf_real nodes[3][PBF_FIELD_ROWS], here[PBF_FIELD_ROWS], rise[PBF_FIELD_ROWS];
  pbf_real sums[1 + PBF_DIM] = {0};
  for (int j = 0; j < PBF_FIELD_ROWS; ++j) {
    const float *at = first + (uint64_t)(j % 3) * stride[1];
    if (PBF_DIM == 3) at += (uint64_t)(j / 3) * stride[PBF_DIM - 1];
    for (int i = 0; i < 3; ++i) nodes[i][j] = (pbf_real)at[i];
  }
  for (int j = 0; j < PBF_FIELD_ROWS; ++j) {
    here[j] = rise[j] = 0;
    for (int i = 0; i < 3; ++i) here[j] += along[0].weight[i] * nodes[i][j];
    for (int i = 0; i < 3; ++i) rise[j] += along[0].slope[i] * nodes[i][j];
  }
  for (int j = 0; j < PBF_FIELD_ROWS; ++j) {
    const pbf_field_weights weights = pbf_field_row_weights(along, j, inverse);
    for (int k = 0; k <= PBF_DIM; ++k) sums[k] += weights.of[k] * (k == 1 ? rise : here)[j];
  }
  for (int k = 0; k < PBF_DIM; ++k) slope->c[k] = sums[1 + k];
  return sums[0];
}

/* Nothing of the solid is nearer than the hypotenuse of the way to the grid and of the distance
 * there: it lies within, and so at an obtuse angle. */
PBF_FN pbf_real pbf_field_past_grid(pbf_vec beyond, pbf_real beyond2, pbf_real there,
                                    pbf_vec *slope) {
  const pbf_real distance = pbf_real_sqrt(beyond2 + there * there);
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real by = beyond.c[k];
    slope->c[k] = (by > 0 || by < 0 ? by : there * slope->c[k]) / distance;
  }
  return distance;
}

/* What is nearest of a field, in the frame of its grid, lengths in cells from the first node. */
typedef struct pbf_field_nearest {
  pbf_real distance; /* a length */
  pbf_vec slope;
} pbf_field_nearest;

/* The nearest place that is within the grid, and the way from there. */
PBF_FN pbf_vec pbf_field_within_grid(const pbf_surface *s, pbf_vec at, pbf_vec *beyond,
                                     pbf_real *beyond2) {
  pbf_vec place;
  *beyond2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real last = (pbf_real)s->field->nodes[k] - (pbf_real)1.5;
    place.c[k] = pbf_real_max(pbf_real_min(at.c[k], last), (pbf_real)0.5);
    beyond->c[k] = pbf_field_cell(s) * (at.c[k] - place.c[k]);
    *beyond2 += beyond->c[k] * beyond->c[k];
  }
  return place;
}

PBF_FN_NOINLINE pbf_field_nearest pbf_field_nearest_to(const pbf_surface *s, pbf_vec at,
                                                       pbf_vec *beyond, pbf_real *beyond2) {
  pbf_field_nearest nearest;
  const pbf_vec place = pbf_field_within_grid(s, at, beyond, beyond2);
  nearest.distance = s->scale * pbf_field_interpolated(s->field, place, &nearest.slope);
  return nearest;
}

PBF_FN pbf_vec pbf_field_place(const pbf_surface *s, pbf_vec p) {
  pbf_vec at;
  for (int k = 0; k < PBF_DIM; ++k)
    at.c[k] = pbf_dot(p, s->frame[k]) / pbf_field_cell(s) -
              (pbf_real)(s->field->origin[k] / s->field->cell);
  return at;
}

/* The normal, and how steep the distance is along it: 1 where one plane is nearest to all around,
 * less where several are to parts of it. */
PBF_FN pbf_real pbf_field_turned(const pbf_surface *s, pbf_vec slope, pbf_vec *normal) {
  pbf_real steepness = pbf_real_sqrt(pbf_dot(slope, slope));
  slope.c[0] = steepness > 0 ? slope.c[0] : 1;
  steepness = steepness > 0 ? steepness : 1;
  for (int row = 0; row < PBF_DIM; ++row) slope.c[row] /= steepness;
  for (int k = 0; k < PBF_DIM; ++k) {
    normal->c[k] = 0;
    for (int row = 0; row < PBF_DIM; ++row) normal->c[k] += s->frame[row].c[k] * slope.c[row];
  }
  return steepness;
}

PBF_FN_NOINLINE pbf_real pbf_field_normal(const pbf_surface *s, pbf_vec slope, pbf_vec *normal) {
  return pbf_field_turned(s, slope, normal);
}

/* The distance of p, which counts from the center, or what it is at least. */
PBF_FN_NOINLINE pbf_real pbf_field_distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
  pbf_vec beyond;
  pbf_real beyond2;
  pbf_field_nearest nearest = pbf_field_nearest_to(s, pbf_field_place(s, p), &beyond, &beyond2);
  if (beyond2 > 0)
    nearest.distance = pbf_field_past_grid(beyond, beyond2, nearest.distance, &nearest.slope);
  pbf_field_normal(s, nearest.slope, normal);
  return nearest.distance;
}

/* How far a place past the grid is from what is nearest to the grid's border: from the plane that
 * this is on, and from the point, along a way. */
typedef struct pbf_field_ahead {
  pbf_real plane, point;
  pbf_vec way, foot; /* foot: of the plane, in the frame of the grid */
} pbf_field_ahead;

PBF_FN pbf_field_ahead pbf_field_look_ahead(const pbf_surface *s, pbf_vec at, pbf_vec beyond,
                                            const pbf_field_nearest *nearest) {
  pbf_field_ahead ahead;
  pbf_real steepness = pbf_real_sqrt(pbf_dot(nearest->slope, nearest->slope));
  steepness = steepness > 0 ? steepness : 1;
  const pbf_vec normal = pbf_scaled(nearest->slope, 1 / steepness);
  ahead.plane = nearest->distance + pbf_dot(beyond, normal);
  ahead.way = pbf_add_scaled(beyond, nearest->distance, normal);
  ahead.point = pbf_real_sqrt(pbf_dot(ahead.way, ahead.way));
  ahead.foot = pbf_add_scaled(at, -ahead.plane / pbf_field_cell(s), normal);
  return ahead;
}

/* Whether it decides something which of both it is. */
PBF_FN bool pbf_field_asks_ahead(const pbf_field_ahead &ahead, pbf_real enough) {
  return ahead.plane < (pbf_real)0.9999 * ahead.point && !(ahead.plane > enough);
}

/* Whether the plane does not go on to its foot, which is so far from the surface, and past the
 * grid. */
PBF_FN bool pbf_field_ends_before(const pbf_surface *s, pbf_real off, pbf_real past2) {
  const pbf_real cell = pbf_field_cell(s);
  return past2 > 0 || off > cell / 4 || off < -cell / 4;
}

/* Past the grid: what is nearest to its border is about nearest there, too, or the plane that it is
 * on, if that goes on to there. The plane is never the farther one: which of both it is need not be
 * known where even the plane is farther than `enough`. */
PBF_FN_NOINLINE void pbf_field_go_on(const pbf_surface *s, pbf_vec at, pbf_vec beyond,
                                     pbf_real enough, pbf_field_nearest *nearest) {
  pbf_vec ignored;
  pbf_real past2;
  const pbf_field_ahead ahead = pbf_field_look_ahead(s, at, beyond, nearest);
  nearest->distance = ahead.plane;
  if (!pbf_field_asks_ahead(ahead, enough)) return;
  const pbf_real off = pbf_field_nearest_to(s, ahead.foot, &ignored, &past2).distance;
  if (!pbf_field_ends_before(s, off, past2)) return;
  nearest->distance = ahead.point;
  nearest->slope = pbf_scaled(ahead.way, 1 / ahead.point);
}

/* The distance, also where that may be more than what something else of it has, the normal, and how
 * steep it is. Farther than `enough` it is only known to be so. */
PBF_FN_NOINLINE pbf_real pbf_field_look(const pbf_surface *s, pbf_vec p, pbf_real enough,
                                        pbf_vec *normal, pbf_real *steepness) {
  pbf_vec beyond;
  pbf_real beyond2;
  const pbf_vec at = pbf_field_place(s, p);
  pbf_field_nearest nearest = pbf_field_nearest_to(s, at, &beyond, &beyond2);
  if (beyond2 > 0) pbf_field_go_on(s, at, beyond, enough, &nearest);
  *steepness = pbf_field_normal(s, nearest.slope, normal);
  return nearest.distance;
}

/* Whether p is farther than `reach` from the box around it, each side of which is known to a cell.
 */
PBF_FN int pbf_field_box_is_beyond(const pbf_surface *s, pbf_vec p, pbf_real reach) {
  pbf_real beyond2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real at = pbf_dot(p, s->frame[k]);
    const pbf_real below = s->scale * (pbf_real)s->field->lower[k] - at;
    const pbf_real above = at - s->scale * (pbf_real)s->field->upper[k];
    const pbf_real beyond = pbf_real_max(below, above) - pbf_field_cell(s);
    beyond2 += beyond > 0 ? beyond * beyond : 0;
  }
  return s->sign > 0 && beyond2 > reach * reach;
}

PBF_FN_NOINLINE int pbf_field_is_beyond(const pbf_surface *s, pbf_vec p, pbf_real reach) {
  return pbf_field_box_is_beyond(s, p, reach);
}

/* ---- Ways ----------------------------------------------------------------------------------- */

/* On by the distance, or by a quarter of a cell where it is less: whatever is thicker than that is
 * not passed. */
PBF_FN pbf_real pbf_field_stride(const pbf_surface *s, pbf_real distance) {
  return pbf_real_max(distance / s->steepest, (pbf_real)0.25 * pbf_field_cell(s));
}

PBF_FN_NOINLINE int pbf_field_blocks(const pbf_surface *s, pbf_vec p, pbf_vec way) {
  const pbf_real length = pbf_real_sqrt(pbf_dot(way, way));
  pbf_real gone = 0;
  for (int steps = 0; steps < PBF_FIELD_STEPS; ++steps) {
    pbf_vec normal;
    const pbf_real part = gone < length ? gone / length : 1;
    const pbf_real away = pbf_field_distance(s, pbf_add_scaled(p, part, way), &normal);
    if (away < 0) return 1;
    if (!(gone < length)) return 0;
    gone += pbf_field_stride(s, away);
  }
  return 1;
}

namespace {

struct field_shape {
  enum { ID = PBF_COLLIDER_SHAPE, HAS_AXIS = 0, FACES = 0 };

  static PBF_IN double bound(const pbf_collider *c) { return c->scale * c->geometry->bound; }
  static PBF_IN double volume(const pbf_collider *c, double beyond) {
    const pbf_shape *f = c->geometry;
    const double area = PBF_DIM == 3 ? c->scale * c->scale : c->scale;
    return area * (c->scale * f->volume + f->area * beyond);
  }
  static PBF_IN double extent(const pbf_surface *s, int axis) {
    double extent = 0;
    for (int row = 0; row < PBF_DIM; ++row)
      extent += fmax(fabs(s->field->lower[row]), fabs(s->field->upper[row])) *
                fabs((double)s->frame[row].c[axis]);
    return (double)s->scale * extent;
  }

  /* Some part of it may be as thin as a cell, and how thin it is there nothing tells. */
  static PBF_IN double width(const pbf_surface *) { return 0; }

  static PBF_IN pbf_real distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
    return pbf_field_distance(s, p, normal);
  }
  static PBF_IN int blocks(const pbf_surface *s, pbf_vec p, pbf_vec way) {
    return pbf_field_blocks(s, p, way);
  }
};

}  // namespace

#endif
