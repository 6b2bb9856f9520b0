/* Part of near_planes.h: what other surfaces leave of a plane where fields lie flush.
 *
 * Beside the end of a field its nearest point is on an edge, as beside the end of a box, but of a
 * field nothing tells that. So it is looked at from a cell before that point, and so is every other
 * surface there. One that is nearer to that place, and has the point on it, covers the edge.
 * Straight before the seam none is nearer, and both have an edge that is rounded off. Then both are
 * looked at some way in from the seam, and if that is one plane, it counts: exactly, and of the
 * surface alone that x is before. */
#ifndef PBF_PHYSICS_SEAMS_H
#define PBF_PHYSICS_SEAMS_H

#include "physics/facets.h"
#include "physics/near_faces.h"

PBF_FN_NOINLINE pbf_real pbf_look_at_surface(const pbf_surface *s, pbf_vec y, pbf_vec *normal) {
  return pbf_nearest_distance(s, y, (pbf_real)INFINITY, normal);
}

PBF_FN pbf_real pbf_cell_of(const pbf_surface *s) {
  return pbf_surface_is_field(s) ? pbf_field_cell(s) : 0;
}

/* The plane that touches a surface where it is nearest to y. */
PBF_FN pbf_facet pbf_tangent_at(const pbf_surface *s, pbf_vec x, pbf_vec y) {
  pbf_facet tangent = {{{0}}, 0, 0};
  const pbf_real distance = pbf_look_at_surface(s, y, &tangent.normal);
  tangent.distance = distance - pbf_dot(pbf_sub(y, x), tangent.normal);
  return tangent;
}

/* Two surfaces as they are a cell before a place that may be on the seam between them. */
typedef struct pbf_seam {
  const pbf_surface *of, *other;
  int number, other_number;
  pbf_real cell; /* the larger one of both */
  pbf_vec before;
  pbf_real distance, other_distance;
  pbf_vec normal, other_normal;
} pbf_seam;

PBF_FN pbf_real pbf_clamped(pbf_real part) { return pbf_real_min(pbf_real_max(part, 0), 1); }

/* Whether both have one plane some way in from the seam. Edges that are rounded off lean over to
 * it. */
PBF_FN_NOINLINE int pbf_find_common_plane(const pbf_seam *seam, pbf_vec x, pbf_facet *common) {
  pbf_vec over = pbf_sub(seam->normal, seam->other_normal);
  const pbf_real lean = pbf_real_sqrt(pbf_dot(over, over));
  /* At a crossing of two seams a cell from each. */
  const pbf_real way = PBF_DIM == 3 ? (pbf_real)1.41 * seam->cell : seam->cell;
  const pbf_real in = lean > (pbf_real)0x1p-10 ? way / lean : 0;
  *common = pbf_tangent_at(seam->of, x, pbf_add_scaled(seam->before, -in, over));
  const pbf_facet other = pbf_tangent_at(seam->other, x, pbf_add_scaled(seam->before, in, over));
  const pbf_real step = common->distance - other.distance;
  return pbf_dot(common->normal, other.normal) > (pbf_real)0.999 &&
         step * step < (pbf_real)0.01 * seam->cell * seam->cell;
}

/* Whether the other one is before x where both have one plane: exactly one of them is. A box is if
 * x is before a face of it, and of fields the nearer one. */
PBF_FN_NOINLINE int pbf_is_other_before(const pbf_seam *seam, pbf_vec x) {
  if (!pbf_surface_is_field(seam->of)) return 1;
  pbf_vec normal;
  if (!pbf_surface_is_field(seam->other)) {
    pbf_nearest_part part;
    pbf_surface_nearest(seam->other, x, &normal, &part);
    return part != PBF_NEAREST_EDGE;
  }
  const pbf_real distance = pbf_look_at_surface(seam->of, x, &normal);
  const pbf_real other_distance = pbf_look_at_surface(seam->other, x, &normal);
  if (other_distance < distance || distance < other_distance) return other_distance < distance;
  return seam->other_number < seam->number;
}

/* Whether something of a surface may be within reach of y. */
PBF_FN int pbf_may_be_within(const pbf_surface *s, pbf_vec y, pbf_real reach) {
  if (pbf_surface_is_beyond(s, y, reach)) return 0;
  return !(pbf_surface_is_field(s) && pbf_field_is_beyond(s, pbf_sub(y, s->center), reach));
}

/* Whether the other one may be near the place that a plane is looked at from: a cell before its
 * nearest point, or x. */
PBF_FN int pbf_may_be_beside(const pbf_seam *seam, pbf_vec x, const pbf_facet *seen) {
  const pbf_real back = pbf_real_min(seam->cell - seen->distance, 0);
  const pbf_real reach = (back < 0 ? (pbf_real)1.25 : (pbf_real)2.25) * seam->cell;
  return pbf_may_be_within(seam->other, pbf_add_scaled(x, back, seen->normal), reach);
}

/* Sets that place. So near to a seam both lean over to each other, and the way out is between. 0:
 * the other one is not near. */
PBF_FN_NOINLINE int pbf_place_seam(pbf_seam *seam, pbf_vec x, pbf_real reach,
                                   const pbf_facet *seen) {
  /* Whether others are asked that are near something else must not show. */
  if (!(pbf_look_at_surface(seam->other, x, &seam->other_normal) < reach)) return 0;
  pbf_vec out = seen->normal;
  pbf_real length = 1;
  if (seen->distance < seam->cell) {
    out = pbf_add_scaled(out, 1, seam->other_normal);
    length = pbf_real_sqrt(pbf_dot(out, out));
  }
  if (!(length > (pbf_real)0.5)) return 0;
  seam->before = pbf_add_scaled(x, (seam->cell - seen->distance) / length, out);
  return 1;
}

/* Where the way from x is inside the other one. */
PBF_FN pbf_real pbf_part_out_of_other(const pbf_seam *seam, const pbf_facet *seen) {
  if (seen->distance < seam->cell) return 1;
  return pbf_clamped(1 + 4 * seam->other_distance / seam->cell);
}

/* How far a plane goes on out of the other surface, as the floor of a corner does from the wall: an
 * edge that lies flush is seen there at half of the angle. */
PBF_FN_NOINLINE pbf_real pbf_part_going_on(const pbf_seam *seam, pbf_real facing) {
  pbf_vec normal;
  const pbf_vec y = pbf_add_scaled(seam->before, seam->cell, seam->other_normal);
  pbf_look_at_surface(seam->of, y, &normal);
  const pbf_real of_edge = pbf_real_sqrt((1 + facing) / 2);
  const pbf_real less = of_edge - pbf_dot(normal, seam->other_normal);
  return pbf_clamped(3 * less / (of_edge - facing) - 1);
}

/* The part of a plane that the other surface leaves, if that is within reach of x; *plane becomes
 * the one that both have. */
PBF_FN_NOINLINE pbf_real pbf_part_beside(pbf_seam *seam, pbf_vec x, pbf_real reach,
                                         const pbf_facet *seen, pbf_facet *plane) {
  if (!pbf_place_seam(seam, x, reach, seen)) return 1;
  seam->distance = pbf_look_at_surface(seam->of, seam->before, &seam->normal);
  seam->other_distance = pbf_look_at_surface(seam->other, seam->before, &seam->other_normal);
  const pbf_real facing = pbf_dot(seam->normal, seam->other_normal);
  if (!(facing > (pbf_real)-0.3)) return pbf_part_out_of_other(seam, seen);
  if (seam->other_distance > (pbf_real)1.25 * seam->distance) return 1;
  const pbf_real rise = seam->other_distance - facing * seam->distance;
  pbf_facet common;
  if (facing > (pbf_real)0.7 && rise < seam->cell / 2 && rise > -seam->cell / 2 &&
      pbf_find_common_plane(seam, x, &common)) {
    if (common.distance < plane->distance) *plane = common;
    return pbf_is_other_before(seam, x) ? 0 : 1;
  }
  const pbf_real flush = pbf_clamped((pbf_real)1.25 - 2 * rise / seam->cell);
  const pbf_real nearer =
      pbf_clamped(10 * (1 - seam->other_distance / seam->distance) - (pbf_real)0.5);
  if (!(flush * nearer > 0)) return 1;
  const pbf_real going_on = facing < (pbf_real)0.8 ? pbf_part_going_on(seam, facing) : 0;
  return pbf_real_max(1 - flush * nearer, going_on);
}

/* A plane of a surface, seen from x, and the part that others leave of it. */
typedef struct pbf_beside {
  pbf_seam seam;
  pbf_vec x;
  pbf_real reach, cell, part;
  pbf_facet seen, plane;
} pbf_beside;

/* No thread leaves it early. */
PBF_FN_NOINLINE void pbf_look_beside(pbf_beside *b, const pbf_surface *other, int number) {
  pbf_real part = b->part;
  if (number != b->seam.number && part > 0) {
    b->seam.other = other, b->seam.other_number = number;
    b->seam.cell = pbf_real_max(b->cell, pbf_cell_of(other));
    if (pbf_may_be_beside(&b->seam, b->x, &b->seen))
      part = pbf_real_min(part, pbf_part_beside(&b->seam, b->x, b->reach, &b->seen, &b->plane));
  }
  b->part = part;
}

/* The part that all others leave of a plane; each(visit) calls visit(surface, number) for all. */
template <class Each>
PBF_FN pbf_real pbf_part_beside_others(const pbf_surface *of, int number, pbf_vec x, pbf_real reach,
                                       Each each, pbf_facet *plane) {
  pbf_beside b;
  b.seam.of = of, b.seam.number = number;
  b.x = x, b.reach = reach, b.cell = pbf_cell_of(of), b.part = 1;
  b.seen = b.plane = *plane;
  each([&](const auto &other, int k) {
    if (pbf_surface_is_field(of) || pbf_surface_is_field(&other)) pbf_look_beside(&b, &other, k);
  });
  *plane = b.plane;
  return b.part;
}

/* ---- Planes of all fields ------------------------------------------------------------------- */

/* As many as are kept of a place, of more the nearest: more than corners of several solids have. */
enum { PBF_FIELD_PLANES = 16 };

typedef struct pbf_field_plane {
  pbf_near_face face;
  pbf_real part; /* that others leave of it */
} pbf_field_plane;

typedef struct pbf_field_planes {
  int fields; /* that are near */
  int count;
  pbf_field_plane of[PBF_FIELD_PLANES];
} pbf_field_planes;

PBF_FN_NOINLINE void pbf_put_field_plane(const pbf_near_face *face, pbf_real part,
                                         pbf_field_planes *planes) {
  if (!(part > 0)) return;
  int at = planes->count;
  if (at < PBF_FIELD_PLANES) {
    ++planes->count;
  } else {
    at = 0;
    for (int k = 1; k < PBF_FIELD_PLANES; ++k)
      if (planes->of[k].face.distance > planes->of[at].face.distance) at = k;
    if (!(face->distance < planes->of[at].face.distance)) return;
  }
  planes->of[at] = {*face, part};
}

/* Whether it faces about as another plane does that is some way nearer: inside of solids that lie
 * upon each other. */
PBF_FN int pbf_is_plane_inside(pbf_real h, const pbf_near_face *plane,
                               const pbf_near_face *nearer) {
  return plane->distance > nearer->distance + h / 8 &&
         pbf_dot(plane->normal, nearer->normal) > (pbf_real)0.95;
}

/* The part of a plane that is not inside. */
PBF_FN_NOINLINE pbf_real pbf_part_not_behind(pbf_real h, const pbf_near_face *plane,
                                             const pbf_field_planes *planes,
                                             const pbf_near_faces *faces) {
  pbf_real part = 1;
  for (int k = 0; k < planes->count; ++k)
    if (pbf_is_plane_inside(h, plane, &planes->of[k].face))
      part = pbf_real_min(part, 1 - planes->of[k].part);
  for (int k = 0; k < faces->count; ++k)
    if (pbf_is_plane_inside(h, plane, &faces->of[k])) part = 0;
  return part;
}

#endif
