/* Part of boundary.h: what solids contribute to the particles of a group, a particle in each lane:
 * as pbf_boundary_at does to the bit. How far each solid is from all particles of the group is
 * found in lanes. Most particles near solids are near one alone and no wall; what that one
 * contributes is found in lanes, too. Of a field that is one plane; particles for which it is more,
 * or which others are near, too, are left. */
#ifndef PBF_CPU_BOUNDARY_SOLIDS_H
#define PBF_CPU_BOUNDARY_SOLIDS_H

namespace {

/* The nearest plane of a solid to each particle of a group. */
struct lane_planes {
  int solid; /* of those of loads */
  bool is_unbounded, is_field;
  alignas(64) pbf_real near[WIDTH];                   /* 1: it is within reach; 0 */
  alignas(64) pbf_real distance[WIDTH], sides[WIDTH]; /* those of pbf_shape_distance, of what is
                                                         curved -1 */
  lane_values normal;
};

/* Those that are within reach of some, and which lanes are left. */
enum { MET_PLANES = 6 };
struct met_solids {
  uint32_t count;
  lane_planes of[MET_PLANES];
  alignas(64) pbf_real left[WIDTH];
};

template <class Shape>
static __attribute__((noinline)) void find_planes(Shape shape, const pbf_surface *surface,
                                                  const lane_values *x, pbf_real reach,
                                                  lane_planes *restrict planes) {
  const bool is_flat = (int)Shape::ID == PBF_COLLIDER_BOX || (int)Shape::ID == PBF_COLLIDER_PLANE;
  const pbf_surface s = *surface;
  const pbf_real far = s.bound + reach;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec normal;
    int sides;
    const pbf_vec p = pbf_sub(lane_value(x, l), s.center);
    const pbf_real distance = s.sign * pbf_shape_distance(shape, &s, p, &normal, &sides);
    const pbf_real in_ball = pbf_dot(p, p) > far * far ? 0 : 1; /* pbf_surface_is_beyond */
    planes->near[l] = distance < reach ? in_ball : 0;
    planes->distance[l] = distance;
    planes->sides[l] = (pbf_real)(is_flat ? sides : -1);
    for (int k = 0; k < PBF_DIM; ++k) planes->normal.c[k][l] = s.sign * normal.c[k];
  }
}

/* The same of a face of a box that fluid is inside of. */
static inline __attribute__((noinline)) void find_face(const pbf_surface *surface, int face,
                                                       const lane_values *x, pbf_real reach,
                                                       lane_planes *restrict planes) {
  const pbf_surface s = *surface;
  memset(planes->sides, 0, sizeof planes->sides);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec normal;
    const pbf_real distance =
        box_shape::face(&s, face, pbf_sub(lane_value(x, l), s.center), &normal);
    planes->near[l] = distance < reach ? 1 : 0;
    planes->distance[l] = distance;
    for (int k = 0; k < PBF_DIM; ++k) planes->normal.c[k][l] = normal.c[k];
  }
}

/* Whether the ball around a surface may be near some: the group's ball is near more of them. */
static inline __attribute__((noinline)) bool is_near_any(const pbf_surface *s, const lane_values *x,
                                                         pbf_real reach) {
  alignas(64) pbf_real in_ball[WIDTH];
  const pbf_vec center = s->center;
  const pbf_real far = s->bound + reach;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_vec p = pbf_sub(lane_value(x, l), center);
    in_ball[l] = pbf_dot(p, p) > far * far ? 0 : 1;
  }
  return lane_any_below(ops<lane>::set(0), lane_load(in_ball));
}

/* Finds a plane of a surface in the next place, and keeps it if some are near it; 0: there is none,
 * or the surface has no closed form. */
PBF_FN bool meet_plane(const pbf_surface *s, int plane, int planes, const lane_values *x,
                       pbf_real reach, met_solids *met) {
  if (!is_near_any(s, x, reach)) return true;
  if (met->count == MET_PLANES) return false;
  lane_planes *to = &met->of[met->count];
  to->is_unbounded = pbf_surface_is_unbounded(s);
  to->is_field = false;
  if (planes > 1)
    find_face(s, plane, x, reach, to);
  else if (!ask_closed(s, [&](auto shape) { find_planes(shape, s, x, reach, to); }))
    return false;
  met->count += (uint32_t)lane_any_below(ops<lane>::set(0), lane_load(to->near));
  return true;
}

/* Lanes that are asked, and that a field may be near: pbf_may_be_within. */
static inline __attribute__((noinline)) void find_lanes_around(const pbf_surface *surface,
                                                               const lane_values *x, pbf_real reach,
                                                               const pbf_real asked[WIDTH],
                                                               pbf_real *restrict wanted) {
  const pbf_shape f = *surface->field;
  pbf_surface s = *surface;
  s.field = &f;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_vec place = lane_value(x, l);
    const pbf_real in_ball = pbf_surface_is_beyond(&s, place, reach) ? 0 : asked[l];
    wanted[l] = pbf_field_box_is_beyond(&s, pbf_sub(place, s.center), reach) ? 0 : in_ball;
  }
}

/* Of lanes near a plane of a field leaves those that another surface may be beside:
 * pbf_may_be_beside, by balls alone. */
static inline __attribute__((noinline)) void leave_beside(const lane_planes *planes,
                                                          const pbf_surface *surface, pbf_real cell,
                                                          const lane_values *x,
                                                          pbf_real *restrict left) {
  const pbf_surface s = *surface;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real back = pbf_real_min(cell - planes->distance[l], 0);
    const pbf_real reach = (back < 0 ? (pbf_real)1.25 : (pbf_real)2.25) * cell;
    const pbf_vec place = pbf_add_scaled(lane_value(x, l), back, lane_value(&planes->normal, l));
    const pbf_real beside = pbf_surface_is_beyond(&s, place, reach) ? 0 : planes->near[l];
    left[l] = beside > 0 ? 1 : left[l];
  }
}

/* Of those that are within reach of it the planes of a field, and lanes of which more than one
 * plane may be near: as pbf_find_facets looks. */
static inline __attribute__((noinline)) void find_field_planes(
    const pbf_constants *c, const pbf_surface *s, const lane_values *x,
    const pbf_real wanted[WIDTH], lane_planes *restrict planes, pbf_real *restrict left) {
  const pbf_real reach = pbf_boundary_reach(c), out = c->h;
  alignas(64) pbf_real enough[WIDTH], farther[WIDTH];
  lane_looks here, there;
  lane_values y;
  for (uint32_t l = 0; l < WIDTH; ++l) enough[l] = reach;
  find_looks(s, x, enough, wanted, &here);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real within = here.distance[l] > reach ? 0 : wanted[l];
    planes->distance[l] = here.distance[l];
    planes->near[l] = here.distance[l] < reach ? within : 0;
    planes->sides[l] = -1;
    farther[l] = here.steepness[l] > (pbf_real)0.95 ? within : 0;
    left[l] = within > farther[l] ? 1 : left[l];
    enough[l] = here.distance[l] + (pbf_real)0.9 * out;
    for (int k = 0; k < PBF_DIM; ++k) {
      planes->normal.c[k][l] = here.normal.c[k][l];
      y.c[k][l] = x->c[k][l] + out * here.normal.c[k][l];
    }
  }
  if (!lane_any_below(ops<lane>::set(0), lane_load(farther))) return;
  find_looks(s, &y, enough, farther, &there);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real more = there.distance[l] < enough[l] ? farther[l] : 0;
    left[l] = more > 0 ? 1 : left[l];
  }
}

/* The plane of a field near `number` of some surfaces; false: there is no room, or fluid is inside.
 */
static inline __attribute__((noinline)) bool meet_field(const pbf_constants *c,
                                                        const pbf_obstacles *near, int number,
                                                        const lane_values *x,
                                                        const pbf_real asked[WIDTH],
                                                        met_solids *met) {
  const pbf_surface *s = &near->surfaces[number];
  alignas(64) pbf_real wanted[WIDTH];
  if (met->count == MET_PLANES || s->sign < 0 || !fits_lanes(s->field)) return false;
  lane_planes *to = &met->of[met->count];
  to->is_unbounded = false;
  to->is_field = true;
  find_lanes_around(s, x, pbf_boundary_reach(c), asked, wanted);
  if (!lane_any_below(ops<lane>::set(0), lane_load(wanted))) return true;
  find_field_planes(c, s, x, wanted, to, met->left);
  if (!lane_any_below(ops<lane>::set(0), lane_load(to->near))) return true;
  for (int k = 0; k < near->count; ++k)
    if (k != number)
      leave_beside(to, &near->surfaces[k],
                   pbf_real_max(pbf_field_cell(s), pbf_cell_of(&near->surfaces[k])), x, met->left);
  met->count += 1;
  return true;
}

/* Beside the plane of a field others may be parts, or none: lanes that several are near, a field
 * among them, are left. */
static inline __attribute__((noinline)) void leave_several(met_solids *met) {
  alignas(64) pbf_real planes[WIDTH] = {0}, of_fields[WIDTH] = {0};
  for (uint32_t k = 0; k < met->count; ++k) {
    const pbf_real is_field = met->of[k].is_field ? 1 : 0;
    for (uint32_t l = 0; l < WIDTH; ++l) planes[l] += met->of[k].near[l];
    for (uint32_t l = 0; l < WIDTH; ++l) of_fields[l] += is_field * met->of[k].near[l];
  }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real several = planes[l] > 1 ? of_fields[l] : 0;
    met->left[l] = several > 0 ? 1 : met->left[l];
  }
}

/* Of lanes that are asked, 1, or all of what has a closed form; false: there are more planes than
 * there is room for, or a field that fluid is inside of. */
static inline __attribute__((noinline)) bool meet_solids(const pbf_constants *c,
                                                         const pbf_obstacles *near,
                                                         const lane_values *x,
                                                         const pbf_real asked[WIDTH],
                                                         met_solids *met) {
  bool any_field = false;
  met->count = 0;
  memset(met->left, 0, sizeof met->left);
  for (int k = 0; k < near->count; ++k) {
    const pbf_surface *s = &near->surfaces[k];
    if (pbf_surface_is_field(s)) {
      any_field = true;
      if (!meet_field(c, near, k, x, asked, met)) return false;
      continue;
    }
    const int planes = pbf_surface_planes(s);
    for (int plane = 0; plane < planes; ++plane)
      if (!meet_plane(s, plane, planes, x, pbf_boundary_reach(c), met)) return false;
  }
  if (any_field) leave_several(met);
  return true;
}

/* One of a particle, in place of its surface, for pbf_each_near_plane. */
struct met_plane {
  const lane_planes *of;
  uint32_t lane;
};
PBF_FN int pbf_surface_is_beyond(const met_plane *s, pbf_vec, pbf_real) {
  return !(s->of->near[s->lane] > 0);
}
PBF_FN int pbf_surface_is_field(const met_plane *) { return 0; }
PBF_FN int pbf_surface_is_unbounded(const met_plane *s) { return s->of->is_unbounded; }
PBF_FN int pbf_surface_planes(const met_plane *) { return 1; }
PBF_FN pbf_real pbf_surface_nearest(const met_plane *s, pbf_vec, pbf_vec *normal,
                                    pbf_nearest_part *part) {
  *normal = lane_value(&s->of->normal, s->lane);
  *part = s->of->sides[s->lane] > 1    ? PBF_NEAREST_EDGE
          : s->of->sides[s->lane] >= 0 ? PBF_NEAREST_FACE
                                       : PBF_NEAREST_CURVED;
  return s->of->distance[s->lane];
}
PBF_FN pbf_real pbf_surface_plane_distance(const met_plane *s, int, int, pbf_vec x, pbf_vec *normal,
                                           pbf_nearest_part *part) {
  return pbf_surface_nearest(s, x, normal, part);
}

/* Which particles one solid alone is near, and no wall, and its plane. A wall within h has a say in
 * what an edge does. */
struct planes_alone {
  alignas(64) pbf_real is[WIDTH], has_slope[WIDTH]; /* 0: pbf_face_density's is 0 */
  lane_planes of;
};

/* Takes a plane over in the lanes that it is near. A function of its own: around such a loop the
 * compiler keeps the lanes one by one. */
static inline __attribute__((noinline)) void take_plane(const lane_planes *planes, pbf_real deepest,
                                                        planes_alone *restrict alone) {
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real near = planes->near[l], distance = planes->distance[l];
    const pbf_real sides = planes->sides[l], sloped = distance < deepest ? 0 : 1;
    const pbf_vec normal = lane_value(&planes->normal, l);
    const pbf_vec before = lane_value(&alone->of.normal, l);
    const pbf_real before_sides = alone->of.sides[l], before_distance = alone->of.distance[l];
    const pbf_real before_sloped = alone->has_slope[l];
    alone->of.near[l] += near;
    alone->has_slope[l] = near > 0 ? sloped : before_sloped;
    alone->of.distance[l] = near > 0 ? distance : before_distance;
    alone->of.sides[l] = near > 0 ? sides : before_sides;
    for (int a = 0; a < PBF_DIM; ++a)
      alone->of.normal.c[a][l] = near > 0 ? normal.c[a] : before.c[a];
  }
}

static inline __attribute__((noinline)) void find_alone(const pbf_constants *c,
                                                        const met_solids *met,
                                                        const pbf_real to_wall[WIDTH],
                                                        planes_alone *restrict alone) {
  const pbf_real h = c->h, reach = contribution_reach(c);
  memset(alone, 0, sizeof *alone);
  for (uint32_t k = 0; k < met->count; ++k) {
    const lane_planes *planes = &met->of[k];
    const pbf_real deepest = planes->is_unbounded ? -(pbf_real)INFINITY : -c->wall_offset;
    take_plane(planes, deepest, alone);
  }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real clear = alone->of.sides[l] > 1 ? h : reach;
    const pbf_real single = alone->of.near[l] == 1 ? 1 : 0;
    alone->is[l] = to_wall[l] >= clear ? single : 0;
    alone->of.distance[l] = alone->is[l] > 0 ? alone->of.distance[l] : h; /* out of reach */
  }
}

static inline __attribute__((noinline)) void add_planes_alone(const pbf_constants *constants,
                                                              const planes_alone *alone,
                                                              lane_boundary *restrict boundary) {
  const pbf_constants c = *constants;
  lane_walls face = {{0}, {0}};
  add_wall_lanes(constants, alone->of.distance, 1, &face);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_boundary by_plane = {0, 0, 0, {{0}}, {{0}}};
    pbf_real density = 0;
    pbf_vec gradient = {{0}};
    const pbf_real slope = alone->has_slope[l] > 0 ? face.slope[l] : 0;
    const pbf_vec normal = lane_value(&alone->of.normal, l);
    pbf_accumulate_plane(&c, face.value[l], slope, normal, &by_plane);
    pbf_add_boundary(&by_plane, &density, &gradient);
    boundary->density[l] = alone->is[l] > 0 ? density : boundary->density[l];
    boundary->rest[l] = alone->is[l] > 0 ? by_plane.rest : boundary->rest[l];
    for (int k = 0; k < PBF_DIM; ++k)
      boundary->gradient.c[k][l] = alone->is[l] > 0 ? gradient.c[k] : boundary->gradient.c[k][l];
  }
}

/* Of a particle that several are near, or a wall. */
static inline __attribute__((noinline)) void add_planes_of(const pbf_constants *c,
                                                           const pbf_domain *domain,
                                                           const lane_values *x, pbf_real to_wall,
                                                           const met_solids *met, uint32_t l,
                                                           lane_boundary *boundary) {
  const pbf_vec place = lane_value(x, l);
  pbf_boundary by_all = {0, 0, 0, {{0}}, {{0}}};
  pbf_vec gradient = {{0}};
  const auto all = [&](auto visit) {
    for (uint32_t k = 0; k < met->count; ++k) visit(met_plane{&met->of[k], l}, (int)k);
  };
  if (to_wall < contribution_reach(c)) by_all = pbf_boundary_of_domain(c, domain, place);
  pbf_accumulate_surfaces(c, domain, place, all, &by_all);
  boundary->density[l] = 0;
  pbf_add_boundary(&by_all, &boundary->density[l], &gradient);
  boundary->rest[l] = by_all.rest;
  set_lane(&boundary->gradient, l, gradient);
}

/* In place of what the domain contributes to those that solids are near. */
static inline __attribute__((noinline)) void boundary_of_solids(
    const pbf_constants *c, const pbf_domain *domain, const lane_values *x,
    const pbf_real to_wall[WIDTH], const met_solids *met, lane_boundary *boundary) {
  planes_alone alone;
  if (met->count == 0) return;
  find_alone(c, met, to_wall, &alone);
  add_planes_alone(c, &alone, boundary);
  for (uint32_t l = 0; l < WIDTH; ++l)
    if (alone.of.near[l] > alone.is[l]) add_planes_of(c, domain, x, to_wall[l], met, l, boundary);
}

}  // namespace

#endif
