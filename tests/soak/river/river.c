#include "river.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double river_spacing = 0.05;

static const double pi = 3.14159265358979323846;

void river_must(pbf_status status, const char *what) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s: %s: %s\n", what, pbf_status_string(status), pbf_last_error());
  exit(2);
}

/* ---- Memory, counted ---- */

static void *count_out(void *user, uint64_t size, uint64_t alignment) {
  const uint64_t rounded = (size + alignment - 1) / alignment * alignment;
  ((river *)user)->bytes += (int64_t)size;
  return aligned_alloc(alignment, rounded);
}

static void count_in(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)alignment;
  ((river *)user)->bytes -= (int64_t)size;
  free(memory);
}

/* ---- Solids ---- */

/* A basin before a weir, behind which, at x = 1.6, the water falls off; in 3D between banks. */
static pbf_shape *make_bed(uint32_t dimension) {
  enum { along = 18, across = 8 };
  double heights[along * across];
  for (int k = 0; k < across; ++k)
    for (int i = 0; i < along; ++i) {
      const double bank = dimension == 3 ? fmax(fabs(0.1 * k - 0.35) - 0.15, 0) : 0;
      const double bed = i < 3 ? 0.3 : i < 15 ? 0.15 : 0.35;
      heights[along * k + i] = bed + bank + 0.01 * sin(1.7 * i);
    }
  const pbf_heights_desc desc = {.struct_size = sizeof desc,
                                 .dimension = dimension,
                                 .count = {along, across},
                                 .heights = heights,
                                 .spacing = 0.1,
                                 .base = 0.05,
                                 .cell = 0.5 * river_spacing};
  pbf_shape *shape = NULL;
  river_must(pbf_shape_from_heights(&desc, &shape), "the bed");
  return shape;
}

enum { PADDLES = 6, CORNERS = 4 * PADDLES };

/* The outline of a hub with paddles, the corners one after another. */
static void outline_of_wheel(double x[CORNERS][2]) {
  const double hub = 0.08, rim = 0.2, half = 0.03;
  for (int i = 0; i < CORNERS; ++i) {
    const double turn = 2 * pi * (i / 4) / PADDLES;
    const double out = i % 4 == 0 || i % 4 == 3 ? sqrt(hub * hub - half * half) : rim;
    const double side = i % 4 < 2 ? -half : half;
    x[i][0] = out * cos(turn) - side * sin(turn);
    x[i][1] = out * sin(turn) + side * cos(turn);
  }
}

static pbf_shape *make_wheel_2d(void) {
  double x[CORNERS][2];
  uint32_t faces[CORNERS][2];
  outline_of_wheel(x);
  for (uint32_t i = 0; i < CORNERS; ++i) faces[i][0] = i, faces[i][1] = (i + 1) % CORNERS;
  const pbf_mesh_desc desc = {.struct_size = sizeof desc,
                              .dimension = 2,
                              .vertex_count = CORNERS,
                              .face_count = CORNERS,
                              .vertices = x[0],
                              .faces = faces[0],
                              .cell = 0.25 * river_spacing};
  pbf_shape *shape = NULL;
  river_must(pbf_shape_from_mesh(&desc, &shape), "the wheel");
  return shape;
}

/* The same, 0.2 wide, with a fan on either side. */
static pbf_shape *make_wheel_3d(void) {
  enum { N = CORNERS };
  double outline[N][2], x[2 * N + 2][3] = {{0}};
  uint32_t faces[4 * N][3];
  outline_of_wheel(outline);
  for (int i = 0; i < 2 * N + 2; ++i) {
    const int side = i < 2 * N ? i / N : i - 2 * N;
    for (int k = 0; k < 2; ++k) x[i][k] = i < 2 * N ? outline[i % N][k] : 0;
    x[i][2] = side ? 0.1 : -0.1;
  }
  for (uint32_t i = 0; i < N; ++i) {
    const uint32_t j = (i + 1) % N;
    const uint32_t four[4][3] = {
        {i, j, N + j}, {i, N + j, N + i}, {2 * N, j, i}, {2 * N + 1, N + i, N + j}};
    memcpy(faces[4 * i], four, sizeof four);
  }
  const pbf_mesh_desc desc = {.struct_size = sizeof desc,
                              .dimension = 3,
                              .vertex_count = 2 * N + 2,
                              .face_count = 4 * N,
                              .vertices = x[0],
                              .faces = faces[0],
                              .cell = 0.25 * river_spacing};
  pbf_shape *shape = NULL;
  river_must(pbf_shape_from_mesh(&desc, &shape), "the wheel");
  return shape;
}

static void place_colliders(river *r) {
  pbf_collider c[RIVER_COLLIDERS];
  for (int i = 0; i < RIVER_COLLIDERS; ++i)
    river_must(pbf_collider_init(&c[i], sizeof c[i],
                                 i < RIVER_CRATES ? PBF_COLLIDER_SHAPE : PBF_COLLIDER_BOX),
               "a collider");
  c[RIVER_BED].geometry = r->bed;
  c[RIVER_BED].position[0] = c[RIVER_BED].position[2] = -0.1;
  c[RIVER_WHEEL].geometry = r->wheel;
  c[RIVER_WHEEL].position[0] = 0.8, c[RIVER_WHEEL].position[1] = 0.43;
  c[RIVER_WHEEL].position[2] = 0.25;
  c[RIVER_WHEEL].angular_velocity[2] = 2;
  for (int i = RIVER_CRATES; i < RIVER_COLLIDERS; ++i) {
    c[i].position[0] = 0.4 + 0.8 * (i - RIVER_CRATES), c[i].position[1] = 0.6;
    c[i].position[2] = 0.25;
    for (int k = 0; k < 3; ++k) c[i].half_extents[k] = 0.05;
  }
  river_must(pbf_set_colliders(r->solver, RIVER_COLLIDERS, c), "the colliders");
}

/* ---- Fluids, and what comes and goes ---- */

static void place_fluids(river *r) {
  pbf_phase phases[2];
  pbf_emitter emitters[2];
  pbf_volume plane;
  for (int i = 0; i < 2; ++i) {
    river_must(pbf_phase_init(&phases[i], sizeof phases[i]), "a phase");
    river_must(pbf_emitter_init(&emitters[i], sizeof emitters[i], PBF_EMITTER_RECTANGLE), "a tap");
    emitters[i].position[0] = 0.05;
    emitters[i].position[1] = i ? 0.6 : 0.4;
    emitters[i].position[2] = 0.25;
    emitters[i].velocity[0] = 0.6, emitters[i].velocity[1] = 0;
    emitters[i].across[0] = 0, emitters[i].across[2] = 1;
    emitters[i].half_width = r->dimension == 2 ? 0.05 : 0.1;
    emitters[i].half_height = 0.05;
    emitters[i].phase = (uint32_t)i;
  }
  phases[1].rest_density = 0.7;
  river_must(pbf_set_phases(r->solver, 2, phases), "the phases");
  river_must(pbf_set_emitters(r->solver, 2, emitters), "the taps");
  river_must(pbf_volume_init(&plane, sizeof plane, PBF_VOLUME_BOX), "the kill plane");
  plane.position[0] = 1, plane.position[1] = -0.4, plane.position[2] = 0.25;
  for (int k = 0; k < 3; ++k) plane.half_extents[k] = k == 1 ? 0.5 : 2; /* all below y = 0.1 */
  river_must(pbf_set_drains(r->solver, 1, &plane), "the kill plane");
}

void river_begin(river *r, const char *backend) {
  pbf_desc desc;
  pbf_params params;
  const pbf_allocator allocator = {sizeof allocator, 0, r, count_out, count_in};
  r->capacity = r->dimension == 2 ? RIVER_CAPACITY_2D : RIVER_CAPACITY_3D;
  river_must(pbf_desc_init(&desc, sizeof desc), "the description");
  river_must(pbf_params_init(&params, sizeof params), "the parameters");
  desc.dimension = r->dimension, desc.precision = r->precision, desc.capacity = r->capacity;
  desc.backend = backend, desc.strict = 1, desc.allocator = &allocator;
  desc.threads = 2; /* however few particles there are */
  params.domain_max[0] = 2, params.domain_max[1] = 1.2, params.domain_max[2] = 0.5;
  params.loads = 1;
  r->bed = make_bed(r->dimension);
  r->wheel = r->dimension == 2 ? make_wheel_2d() : make_wheel_3d();
  river_must(pbf_create(&desc, &params, &r->solver), "the solver");
  place_colliders(r);
  place_fluids(r);
}

void river_end(river *r) {
  pbf_destroy(r->solver);
  pbf_shape_info info = {.struct_size = sizeof info};
  for (int i = 0; i < 2; ++i) {
    pbf_shape *shape = i ? r->wheel : r->bed;
    river_must(pbf_get_shape_info(shape, &info), "a shape");
    if (info.references != 1 && !r->fault[0])
      snprintf(r->fault, sizeof r->fault, "shape %d has %u references at the end, not 1", i,
               info.references);
    pbf_release_shape(shape);
  }
  if (r->bytes != 0 && !r->fault[0])
    snprintf(r->fault, sizeof r->fault, "%lld bytes are out at the end", (long long)r->bytes);
}

void river_colliders(river *r, pbf_collider colliders[RIVER_COLLIDERS]) {
  for (uint32_t i = 0; i < RIVER_COLLIDERS; ++i) {
    colliders[i].struct_size = sizeof colliders[i];
    river_must(pbf_get_collider(r->solver, i, &colliders[i]), "a collider");
  }
}

/* ---- Crates ---- */

/* Half as heavy as water. What would leave the river's room turns back. */
static void push_crate(pbf_collider *crate, const pbf_collider_load *load, const pbf_params *params,
                       uint32_t dimension, double duration) {
  static const double low[3] = {0.3, 0.27, 0.15}, high[3] = {1.3, 1, 0.35};
  const double mass = 0.5 * (dimension == 3 ? 0.001 : 0.01);
  for (uint32_t k = 0; k < dimension; ++k) {
    double *v = &crate->velocity[k];
    *v += load->impulse_sum[k] / mass + params->gravity[k] * duration;
    *v = fmin(fmax(0.98 * *v, -1), 1);
    const double next = crate->position[k] + *v * duration;
    if (next < low[k] || next > high[k]) *v = next < low[k] ? fabs(0.2 * *v) : -fabs(0.2 * *v);
  }
  crate->duration = 0;
}

void river_float(river *r, uint32_t steps) {
  pbf_params params = {.struct_size = sizeof params};
  pbf_collider colliders[RIVER_COLLIDERS];
  pbf_collider_load loads[RIVER_COLLIDERS] = {{0}};
  for (int i = 0; i < RIVER_COLLIDERS; ++i) loads[i].struct_size = sizeof *loads;
  river_must(pbf_get_params(r->solver, &params), "the parameters");
  for (uint32_t done = 0; done < steps; ++done) {
    river_must(pbf_step(r->solver, 1), "a step");
    ++r->step;
    if (!params.loads || r->step % 4 != 0) continue;
    river_must(pbf_get_collider_loads(r->solver, RIVER_COLLIDERS, loads), "the loads");
    river_colliders(r, colliders);
    for (int i = RIVER_CRATES; i < RIVER_COLLIDERS; ++i)
      push_crate(&colliders[i], &loads[i], &params, r->dimension, 4 * params.time_step);
    river_must(pbf_set_colliders(r->solver, RIVER_COLLIDERS, colliders), "the crates");
  }
}
