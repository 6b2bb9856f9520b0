/* Part of boundary.h: the planes that surfaces are near a place, and the part of each that counts:
 * those of fields, faces, and edges as far as faces leave them. */
#ifndef PBF_PHYSICS_NEAR_PLANES_H
#define PBF_PHYSICS_NEAR_PLANES_H

#include "physics/facets.h"
#include "physics/near_faces.h"
#include "physics/seams.h"
#include "physics/surfaces/domain.h"
#include "physics/surfaces/surface.h"

template <class Surface>
PBF_FN pbf_near_face pbf_face_of_surface(const Surface *s, int solid, pbf_real distance,
                                         pbf_vec normal, int is_curved = 0) {
  return {normal, distance, pbf_surface_is_unbounded(s), solid, is_curved, 1};
}

/* What is nearest of a field, as a few planes: of a corner that fluid is in, each side. They are
 * put among the planes of others, with what others leave of each. */
template <class Each>
PBF_FN_NOINLINE void pbf_meet_field(pbf_real h, const pbf_surface *s, int solid, pbf_vec x,
                                    pbf_real reach, Each each, pbf_field_planes *planes) {
  pbf_facets facets;
  pbf_find_facets(s, reach, h, x, &facets);
  for (int k = 0; k < facets.count; ++k) {
    pbf_facet plane = facets.of[k];
    if (!(plane.distance < reach)) continue;
    const pbf_real part = pbf_part_beside_others(s, solid, x, reach, each, &plane);
    const pbf_near_face face = pbf_face_of_surface(s, solid, plane.distance, plane.normal);
    pbf_put_field_plane(&face, part, planes);
  }
  planes->fields += 1; /* here, so that no thread leaves early */
}

/* Puts the planes of a surface within reach among the others, but for edges, which are noted. */
template <class Surface, class Each>
PBF_FN void pbf_meet_surface(const pbf_constants *c, const Surface *s, int solid, pbf_vec x,
                             pbf_real reach, pbf_near_faces *faces, pbf_near_edges *edges,
                             pbf_field_planes *of_fields, Each each) {
  if (pbf_surface_is_beyond(s, x, reach)) return;
  if constexpr (may_be_field<Surface>::value)
    if (pbf_surface_is_field(s)) {
      if (pbf_may_be_within(s, x, reach))
        pbf_meet_field(c->h, s, solid, x, reach, each, of_fields);
      else
        of_fields->fields += 1;
      return;
    }
  const int planes = pbf_surface_planes(s);
  for (int plane = 0; plane < planes; ++plane) {
    pbf_vec normal;
    pbf_nearest_part nearest;
    const pbf_real distance = pbf_surface_plane_distance(s, plane, planes, x, &normal, &nearest);
    if (!(distance < reach)) continue;
    const pbf_near_face face =
        pbf_face_of_surface(s, solid, distance, normal, nearest == PBF_NEAREST_CURVED);
    if (nearest == PBF_NEAREST_EDGE)
      pbf_note_edge(&face, edges);
    else
      pbf_put_face(&face, faces);
  }
}

/* Visits a surface if an edge of it is nearest, with the part that all faces leave of it. */
template <class Surface, class Each, class Visit>
PBF_FN void pbf_visit_edge(const pbf_constants *c, const Surface *s, int solid, pbf_vec x,
                           pbf_real reach, const pbf_near_faces *faces,
                           const pbf_field_planes *planes, Each each, Visit visit) {
  if (pbf_surface_is_beyond(s, x, reach) || pbf_surface_is_field(s)) return;
  pbf_facet plane;
  pbf_nearest_part nearest;
  plane.distance = pbf_surface_nearest(s, x, &plane.normal, &nearest);
  if (nearest != PBF_NEAREST_EDGE || !(plane.distance < reach)) return;
  pbf_real part = pbf_part_before_faces(c, faces, plane.distance, plane.normal);
  if constexpr (may_be_field<Surface>::value)
    if (planes->fields > 0 && part > 0)
      part = pbf_real_min(part, pbf_part_beside_others(s, solid, x, reach, each, &plane));
  if (part > 0) visit(pbf_face_of_surface(s, solid, plane.distance, plane.normal), part);
}

/* The domain's walls, too, leave of edges what rises from them. */
PBF_FN_HOST_NOINLINE void pbf_put_domain(const pbf_constants *c, const pbf_domain *domain,
                                         pbf_vec x, pbf_near_faces *faces) {
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall) {
    pbf_near_face face = {{{0}}, pbf_wall_distance(domain, wall, x), 1, wall, 0, 1};
    face.normal.c[wall / 2] = wall % 2 ? (pbf_real)-1 : (pbf_real)1;
    if (face.distance < c->h) pbf_put_face(&face, faces);
  }
}

/* Visits the planes of fields, and drops faces behind them. */
template <class Visit>
PBF_FN_NOINLINE void pbf_visit_field_planes(pbf_real h, const pbf_field_planes *planes,
                                            pbf_near_faces *faces, Visit visit) {
  for (int k = 0; k < planes->count; ++k) {
    const pbf_near_face *face = &planes->of[k].face;
    const pbf_real part = planes->of[k].part * pbf_part_not_behind(h, face, planes, faces);
    if (part > 0) visit(*face, part);
  }
  const pbf_near_faces before = *faces;
  faces->count = 0;
  for (int k = 0; k < before.count; ++k)
    if (pbf_part_not_behind(h, &before.of[k], planes, &before) > (pbf_real)0.5)
      faces->of[faces->count++] = before.of[k];
}

/* The wall of the domain within reach that a flat face looks the same way as; -1: none. Such faces
 * are visited first: a plane that faces both, visited in between, would hide that they are one. */
PBF_FN_HOST_NOINLINE int pbf_wall_along(const pbf_domain *domain, pbf_vec x, pbf_real reach,
                                        const pbf_near_face *face) {
  if (face->is_curved) return -1;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int upper = face->normal.c[k] < 0, wall = 2 * k + upper;
    if ((upper ? -face->normal.c[k] : face->normal.c[k]) > (pbf_real)0.999)
      return pbf_wall_distance(domain, wall, x) < reach ? wall : -1;
  }
  return -1;
}

/* Calls visit(face, part) for the planes within reach of x by which surfaces contribute, and the
 * part of each that does; each(meet) calls meet(surface, number) for all surfaces, as often as is
 * asked. */
template <class Each, class Visit>
PBF_FN void pbf_each_near_plane(const pbf_constants *c, const pbf_domain *domain, pbf_vec x,
                                pbf_real reach, Each each, Visit visit) {
  pbf_near_faces faces;
  pbf_near_edges edges;
  pbf_field_planes planes;
  faces.count = edges.count = planes.fields = planes.count = 0;
  each([&](const auto &s, int solid) {
    pbf_meet_surface(c, &s, solid, x, reach, &faces, &edges, &planes, each);
  });
  if (planes.count > 0) pbf_visit_field_planes(c->h, &planes, &faces, visit);
  uint32_t first = 0;
  for (int k = 0; k < faces.count && faces.count > 1; ++k)
    if (pbf_wall_along(domain, x, reach, &faces.of[k]) >= 0) first |= UINT32_C(1) << k;
  pbf_find_parts(c, &faces);
  for (int k = 0; k < faces.count && first; ++k)
    if (first >> k & 1) visit(faces.of[k], faces.of[k].part);
  for (int k = 0; k < faces.count; ++k)
    if (!(first >> k & 1)) visit(faces.of[k], faces.of[k].part);
  if (edges.count == 0) return;
  pbf_put_domain(c, domain, x, &faces);
  if (PBF_KEEPS_EDGES && edges.count <= PBF_NEAR_EDGES && planes.fields == 0) {
    for (int k = 0; k < edges.count; ++k) {
      const pbf_near_face &edge = edges.of[k];
      const pbf_real part = pbf_part_before_faces(c, &faces, edge.distance, edge.normal);
      if (part > 0) visit(edge, part);
    }
    return;
  }
  each([&](const auto &s, int solid) {
    pbf_visit_edge(c, &s, solid, x, reach, &faces, &planes, each, visit);
  });
}

#endif
