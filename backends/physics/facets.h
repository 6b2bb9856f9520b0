/* Part of boundary.h: the planes that a surface of interpolated distances (surfaces/field.h) is
 * near a place: one where it is flat or bulges out, and in a corner that the place is in one for
 * each side. Of these the distance tells the nearest alone, and within a cell of where several are
 * as near a mixture of them. So it is asked elsewhere: farther out from the planes found so far,
 * where those beside them are the nearest; and, where it is a mixture, some cells away to each
 * side. */
#ifndef PBF_PHYSICS_FACETS_H
#define PBF_PHYSICS_FACETS_H

#include "physics/surfaces/surface.h"

/* A plane that the surface touches. */
typedef struct pbf_facet {
  pbf_vec normal;
  pbf_real distance; /* of x, the place that planes are looked for around */
  int is_nearest;    /* 1: known to be the nearest to x of those with about this normal */
} pbf_facet;

typedef struct pbf_facets {
  int count;
  pbf_real nearest; /* the distance at x */
  pbf_facet of[PBF_DIM];
} pbf_facets;

/* Distance and normal at a place, and whether one plane alone is nearest there; of one that is
 * farther than `enough` only that it is. */
PBF_FN pbf_real pbf_look_within(const pbf_surface *s, pbf_vec x, pbf_real enough, pbf_vec *normal,
                                int *is_plane) {
  pbf_vec n;
  pbf_real steepness;
  if (s->sign < 0) enough = (pbf_real)INFINITY;
  const pbf_real distance = pbf_field_look(s, pbf_sub(x, s->center), enough, &n, &steepness);
  for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = s->sign * n.c[k];
  *is_plane = steepness > (pbf_real)0.95;
  return s->sign * distance;
}

/* The distance of any surface, where pbf_surface_distance has of a field what it is at least past
 * its grid; of one that is farther than `enough` only that it is. */
template <class Surface>
PBF_FN pbf_real pbf_nearest_distance(const Surface *s, pbf_vec x, pbf_real enough,
                                     pbf_vec *normal) {
  int is_plane;
  return pbf_surface_is_field(s) ? pbf_look_within(s, x, enough, normal, &is_plane)
                                 : pbf_surface_distance(s, x, normal);
}

PBF_FN pbf_real pbf_look_at_field(const pbf_surface *s, pbf_vec x, pbf_vec *normal, int *is_plane) {
  return pbf_look_within(s, x, (pbf_real)INFINITY, normal, is_plane);
}

/* The tangent plane nearest to x of what has such a normal at y, `distance` from there: seen from
 * its foot, as another point of what is curved has another normal. */
PBF_FN_NOINLINE pbf_facet pbf_facet_from(const pbf_surface *s, pbf_vec x, pbf_vec y,
                                         pbf_real distance, pbf_vec normal) {
  pbf_facet facet = {normal, distance - pbf_dot(pbf_sub(y, x), normal), 0};
  pbf_vec there;
  const pbf_vec foot = pbf_add_scaled(x, -facet.distance, normal);
  distance = pbf_look_at_field(s, foot, &there, &facet.is_nearest);
  if (!(pbf_dot(there, normal) > (pbf_real)0.8)) facet.is_nearest = 0;
  if (!facet.is_nearest) return facet;
  facet.normal = there;
  facet.distance = distance - pbf_dot(pbf_sub(foot, x), there);
  return facet;
}

/* What has been seen from two sides lies between. */
PBF_FN void pbf_join_facets(pbf_facet *facet, const pbf_facet *other) {
  if (facet->is_nearest) return;
  if (other->is_nearest) {
    *facet = *other;
    return;
  }
  pbf_vec sum = pbf_add_scaled(facet->normal, 1, other->normal);
  const pbf_real length = pbf_real_sqrt(pbf_dot(sum, sum));
  for (int k = 0; k < PBF_DIM; ++k) facet->normal.c[k] = sum.c[k] / length;
  facet->distance = pbf_real_min(facet->distance, other->distance);
}

/* Takes a plane, unless it is one that is known, or of a solid that bulges out towards x: behind
 * that plane then lies more than the solid. */
PBF_FN void pbf_take_facet(const pbf_surface *s, const pbf_facet *facet, pbf_facets *facets) {
  const pbf_real some = (pbf_real)0.1 * pbf_field_stride(s, 0);
  if (facet->distance < facets->nearest - some) return;
  for (int k = 0; k < facets->count; ++k) {
    if (!(pbf_dot(facets->of[k].normal, facet->normal) > (pbf_real)0.9)) continue;
    pbf_join_facets(&facets->of[k], facet);
    return;
  }
  if (facets->count < PBF_DIM) facets->of[facets->count++] = *facet;
}

/* Two unit vectors at right angles to a unit vector, and in 2D one. */
PBF_FN void pbf_directions_across(pbf_vec normal, pbf_vec across[PBF_DIM - 1]) {
  int least = 0;
  for (int k = 1; k < PBF_DIM; ++k)
    if (normal.c[k] * normal.c[k] < normal.c[least] * normal.c[least]) least = k;
  pbf_vec first = {{0}};
  first.c[least] = 1;
  first = pbf_add_scaled(first, -normal.c[least], normal);
  const pbf_real length = pbf_real_sqrt(pbf_dot(first, first));
  for (int k = 0; k < PBF_DIM; ++k) across[0].c[k] = first.c[k] / length;
  for (int k = 0; k < PBF_DIM && PBF_DIM == 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    across[PBF_DIM - 2].c[k] = normal.c[l % PBF_DIM] * across[0].c[m % PBF_DIM] -
                               normal.c[m % PBF_DIM] * across[0].c[l % PBF_DIM];
  }
}

/* The planes nearest to y, which is x itself or another place. */
PBF_FN_NOINLINE void pbf_take_facets_at(const pbf_surface *s, pbf_vec x, pbf_vec y,
                                        pbf_real distance, pbf_vec normal, int is_plane, int is_at,
                                        pbf_facets *facets) {
  if (is_plane) {
    const pbf_facet facet =
        is_at ? pbf_facet{normal, distance, 1} : pbf_facet_from(s, x, y, distance, normal);
    pbf_take_facet(s, &facet, facets);
    return;
  }
  pbf_vec across[PBF_DIM - 1];
  const pbf_real aside = 8 * pbf_field_stride(s, 0);
  pbf_directions_across(normal, across);
  for (int k = 0; k < 2 * (PBF_DIM - 1); ++k) {
    const pbf_vec z = pbf_add_scaled(y, k % 2 ? -aside : aside, across[k / 2]);
    distance = pbf_look_at_field(s, z, &normal, &is_plane);
    if (!is_plane) continue;
    const pbf_facet facet = pbf_facet_from(s, x, z, distance, normal);
    pbf_take_facet(s, &facet, facets);
  }
}

/* Those within `reach` of x; `out` is as far as others are looked for. */
PBF_FN_NOINLINE void pbf_find_facets(const pbf_surface *s, pbf_real reach, pbf_real out, pbf_vec x,
                                     pbf_facets *facets) {
  pbf_vec normal, at_x;
  int is_plane;
  facets->count = 0;
  facets->nearest = pbf_look_within(s, x, reach, &normal, &is_plane);
  if (facets->nearest > reach) return;
  at_x = normal;
  pbf_take_facets_at(s, x, x, facets->nearest, normal, is_plane, 1, facets);
  pbf_vec away = facets->count ? facets->of[0].normal : at_x;
  for (int k = 1; k < facets->count; ++k) away = pbf_add_scaled(away, 1, facets->of[k].normal);
  while (facets->count && facets->count < PBF_DIM) {
    const pbf_vec y = pbf_add_scaled(x, out, away);
    const int before = facets->count;
    const pbf_real none = facets->nearest + (pbf_real)0.9 * out;
    const pbf_real distance = pbf_look_within(s, y, none, &normal, &is_plane);
    if (!(distance < none)) break;
    pbf_take_facets_at(s, x, y, distance, normal, is_plane, 0, facets);
    if (facets->count == before) break;
    for (int k = before; k < facets->count; ++k)
      away = pbf_add_scaled(away, 1, facets->of[k].normal);
  }
  if (facets->count) return;
  facets->count = 1;
  facets->of[0] = {at_x, facets->nearest, 1};
}

#endif
