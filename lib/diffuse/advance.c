/* Spray, foam and bubbles after steps: they move, end and begin. */

#include "generate.h"
#include "memory.h"
#include "physics/elementary.h"
#include "solver/solver_time.h"
#include "solver/step_limit.h"

/* ---- Room ------------------------------------------------------------------------------------ */

static pbf_status reserve_normals(const pbf_solver *solver, pbf_diffuse *d) {
  const pbf_allocator *allocator = &solver->allocator;
  const uint32_t count = solver->count, more = count / 4 + 64;
  const uint32_t capacity = more < solver->capacity - count ? count + more : solver->capacity;
  void *memory;
  if (!(d->desc.wave_crest_rate > 0) || d->normal_capacity >= count) return PBF_OK;
  pbf_status status = pbf_memory_allocate(allocator, (uint64_t)capacity * sizeof *d->normals,
                                          "normals of the fluid", &memory);
  if (status != PBF_OK) return status;
  pbf_memory_free(allocator, d->normals, (uint64_t)d->normal_capacity * sizeof *d->normals);
  d->normals = memory;
  d->normal_capacity = capacity;
  return PBF_OK;
}

static pbf_status prepare(pbf_solver *solver, uint32_t *steps) {
  pbf_diffuse *d = solver->diffuse;
  const uint32_t due = d->desc.interval - (uint32_t)(solver->step % d->desc.interval);
  if (*steps > due) *steps = due;
  pbf_status status = reserve_normals(solver, d);
  if (status == PBF_OK) status = pbf_query_index_reserve(solver);
  return status;
}

/* ---- Motion ---------------------------------------------------------------------------------- */

/* The exact solution of dv/dt = a + drag (medium - v) over a time: so much of the way that v goes
 * by itself, and so much of time² a. */
typedef struct decay {
  double drag, time;
  double of_velocity;     /* (1 - exp(-z)) / z with z = drag time, which is 1 at 0 */
  double of_acceleration; /* (1 - of_velocity) / z, 1/2 at 0 */
} decay;

static decay decay_of(double drag, double time) {
  const double z = drag * time;
  decay d = {.drag = drag, .time = time};
  if (z < 0.01) { /* their series, where differences would round off */
    d.of_velocity = 1 - z * (1 / 2.0 - z * (1 / 6.0 - z * (1 / 24.0 - z / 120)));
    d.of_acceleration = 1 / 2.0 - z * (1 / 6.0 - z * (1 / 24.0 - z / 120));
  } else {
    d.of_velocity = (1 - pbf_exp(-z)) / z;
    d.of_acceleration = (1 - d.of_velocity) / z;
  }
  return d;
}

static void go(pbf_diffuse_particle *p, const double *a, const double *medium, const decay *d,
               uint32_t dimension) {
  for (uint32_t k = 0; k < dimension; ++k) {
    const double v = p->velocity[k], pull = a[k] + d->drag * medium[k];
    p->position[k] += d->time * (d->of_velocity * v + d->of_acceleration * d->time * pull);
    p->velocity[k] = v + d->time * d->of_velocity * (pull - d->drag * v);
  }
}

/* With the fluid, by its velocity half-way: turning it stays on its circle. */
static void go_along(pbf_diffuse_particle *p, const pbf_fluid_flow *flow, double time,
                     uint32_t dimension) {
  for (uint32_t k = 0; k < dimension; ++k) {
    double halfway = flow->velocity[k];
    for (uint32_t l = 0; l < dimension; ++l)
      halfway += 0.5 * time * flow->gradient[k][l] * flow->velocity[l];
    p->position[k] += time * halfway;
    p->velocity[k] = flow->velocity[k];
  }
}

/* What all that move at once have in common. */
typedef struct motion {
  const pbf_solver *solver;
  pbf_fluid *fluid;
  const pbf_diffuse_walls *walls;
  double elapsed;
  decay spray, bubble;
} motion;

static void move(const motion *m, pbf_diffuse_particle *p) {
  static const double air[3] = {0, 0, 0};
  const pbf_solver *solver = m->solver;
  const pbf_diffuse_desc *desc = &solver->diffuse->desc;
  const pbf_params *params = &solver->params;
  const uint32_t n = solver->kind.dimension;
  const pbf_fluid_flow flow = pbf_fluid_flow_at(m->fluid, p->position);
  double pull[3] = {0, 0, 0};
  p->kind = pbf_diffuse_kind(desc, flow.neighbors);
  if (p->kind == PBF_DIFFUSE_FOAM) {
    go_along(p, &flow, m->elapsed, n);
    return;
  }
  const int is_bubble = p->kind == PBF_DIFFUSE_BUBBLE;
  for (uint32_t k = 0; k < n; ++k) {
    const double away = p->position[k] - params->attraction_center[k];
    pull[k] = params->gravity[k] - params->attraction * away;
    if (is_bubble) pull[k] *= -desc->buoyancy;
  }
  go(p, pull, is_bubble ? flow.velocity : air, is_bubble ? &m->bubble : &m->spray, n);
}

/* Rounding of times does not let one live for a step more. */
static int has_ended(const pbf_diffuse_particle *p, double time, double elapsed) {
  return p->dies - time <= 1e-6 * elapsed;
}

static void move_all(const motion *m) {
  pbf_diffuse *d = m->solver->diffuse;
  uint32_t kept = 0;
  for (uint32_t n = 0; n < d->head.count; ++n) {
    pbf_diffuse_particle p = *pbf_diffuse_at(d, n);
    if (has_ended(&p, d->head.time, m->elapsed)) continue;
    move(m, &p);
    pbf_diffuse_keep_inside(m->solver, m->walls, &p);
    *pbf_diffuse_at(d, kept++) = p;
  }
  d->head.expired += d->head.count - kept;
  d->head.count = kept;
}

/* ---- After steps ----------------------------------------------------------------------------- */

/* Whether any particle of the fluid may be fast enough to make some. A backend that does not tell
 * at once is looked at. */
static pbf_status find_whether_fast(pbf_solver *solver, int *is_fast) {
  double speed = 0;
  *is_fast = solver->count > 0;
  if (solver->count == 0 || !solver->api.max_speed) return PBF_OK;
  pbf_status status = pbf_max_speed(solver, &speed);
  *is_fast = 0.5 * speed * speed * (1 + 1e-5) > solver->diffuse->desc.energy_min;
  return status;
}

static void advance_by(pbf_solver *solver, const pbf_query_index *index, double elapsed) {
  const double time = pbf_solver_time(solver);
  const pbf_diffuse_walls walls = pbf_diffuse_walls_at(solver, time, elapsed);
  pbf_fluid fluid = pbf_fluid_of(solver, index);
  const pbf_diffuse_desc *desc = &solver->diffuse->desc;
  const motion m = {.solver = solver,
                    .fluid = &fluid,
                    .walls = &walls,
                    .elapsed = elapsed,
                    .spray = decay_of(desc->spray_drag, elapsed),
                    .bubble = decay_of(desc->bubble_drag, elapsed)};
  solver->diffuse->head.time = time;
  move_all(&m);
  pbf_diffuse_generate(solver, &fluid, &walls, elapsed);
  pbf_diffuse_push_out(solver, time);
}

static pbf_status advance(pbf_solver *solver) {
  pbf_diffuse *d = solver->diffuse;
  const pbf_query_index *index;
  int is_fast = 0;
  if (solver->step % d->desc.interval != 0) return PBF_OK;
  const double time = pbf_solver_time(solver), elapsed = time - d->head.time;
  if (!(elapsed > 0)) return PBF_OK;
  pbf_status status = find_whether_fast(solver, &is_fast);
  if (status == PBF_OK && !is_fast && d->head.count == 0) {
    d->head.time = time;
    return PBF_OK;
  }
  if (status == PBF_OK) status = pbf_query_index_get(solver, PBF_QUERY_VELOCITIES, &index);
  if (status == PBF_OK) advance_by(solver, index, elapsed);
  return status;
}

const pbf_diffuse_work pbf_diffuse_in_steps = {prepare, advance};
