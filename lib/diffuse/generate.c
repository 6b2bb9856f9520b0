#include "generate.h"

#include <math.h>
#include <string.h>

#include "physics/motion.h"
#include "physics/spacing.h"

static const double pi = 3.14159265358979323846;

/* Crests go ahead: their normal and velocity are no farther apart than by this cosine. */
static const double min_ahead = 0.6;

typedef struct maker {
  const pbf_solver *solver;
  pbf_diffuse *diffuse;
  pbf_fluid *fluid;
  pbf_fluid others; /* of the neighbours of what `fluid` is at */
  const pbf_diffuse_walls *walls;
  double elapsed, radius; /* of a particle's cylinder */
  uint32_t room;          /* so many may still be made */
} maker;

uint32_t pbf_diffuse_kind(const pbf_diffuse_desc *desc, uint32_t neighbors) {
  if (neighbors < desc->foam_neighbors) return PBF_DIFFUSE_SPRAY;
  return neighbors > desc->bubble_neighbors ? PBF_DIFFUSE_BUBBLE : PBF_DIFFUSE_FOAM;
}

/* ---- How many -------------------------------------------------------------------------------- */

static double share_of(double value, double min, double max) {
  return (fmin(value, max) - fmin(value, min)) / (max - min);
}

static void keep_normal(maker *m, uint32_t particle, const double normal[3]) {
  pbf_fluid_normal *kept = &m->diffuse->normals[particle];
  for (int k = 0; k < 3; ++k) kept->direction[k] = (float)normal[k];
  kept->is_known = 1;
}

static const float *normal_of(maker *m, uint32_t particle) {
  const pbf_fluid_normal *kept = &m->diffuse->normals[particle];
  if (!kept->is_known) keep_normal(m, particle, pbf_fluid_sums_around(&m->others, particle).normal);
  return kept->direction;
}

typedef struct crest {
  maker *maker;
  const double *normal;
  double sum;
} crest;

static void add_to_crest(void *context, uint32_t other, const double way[3], double weight) {
  crest *c = context;
  const uint32_t n = c->maker->solver->kind.dimension;
  double behind = 0, cosine = 0, square = 0;
  for (uint32_t k = 0; k < n; ++k) behind -= way[k] * c->normal[k];
  if (!(behind > 0)) return;
  const float *normal = normal_of(c->maker, other);
  for (uint32_t k = 0; k < n; ++k) {
    cosine += (double)normal[k] * c->normal[k];
    square += (double)normal[k] * (double)normal[k];
  }
  if (square > 0) c->sum += (1 - cosine) * weight;
}

static double crest_of(maker *m, uint32_t particle, const double *position, const double *velocity,
                       double speed, const double normal[3]) {
  crest c = {.maker = m, .normal = normal};
  double ahead = 0;
  for (uint32_t k = 0; k < m->solver->kind.dimension; ++k) ahead += velocity[k] * normal[k];
  if (!(ahead >= min_ahead * speed)) return 0;
  if (pbf_diffuse_faces_wall(m->solver, m->walls, position, normal, m->fluid->radius)) return 0;
  pbf_fluid_each_near(m->fluid, particle, add_to_crest, &c);
  return c.sum / m->fluid->rest_weight;
}

/* How many a particle makes, and how long they live, 0 … 1. */
static double number_of(maker *m, uint32_t particle, const double *position, const double *velocity,
                        double *lasting) {
  const pbf_diffuse_desc *desc = &m->diffuse->desc;
  double square = 0, trapped = 0, crests = 0;
  for (uint32_t k = 0; k < m->solver->kind.dimension; ++k) square += velocity[k] * velocity[k];
  const double energy = share_of(0.5 * square, desc->energy_min, desc->energy_max);
  if (!(energy > 0)) return 0;
  const pbf_fluid_sums sums = pbf_fluid_sums_around(m->fluid, particle);
  if (desc->trapped_air_rate > 0)
    trapped = share_of(sums.closing, desc->trapped_air_min, desc->trapped_air_max);
  if (desc->wave_crest_rate > 0) {
    keep_normal(m, particle, sums.normal);
    crests = share_of(crest_of(m, particle, position, velocity, sqrt(square), sums.normal),
                      desc->wave_crest_min, desc->wave_crest_max);
  }
  *lasting = energy * fmax(trapped, crests);
  return energy * (desc->trapped_air_rate * trapped + desc->wave_crest_rate * crests) * m->elapsed;
}

/* ---- Where ----------------------------------------------------------------------------------- */

/* Numbers that follow from others alone: bits mixed by multiplications and shifts, as in Steele,
 * Lea & Flood, Fast splittable pseudorandom number generators, OOPSLA 2014. */
static uint64_t mixed(uint64_t bits) {
  bits += UINT64_C(0x9e3779b97f4a7c15);
  bits = (bits ^ bits >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  bits = (bits ^ bits >> 27) * UINT64_C(0x94d049bb133111eb);
  return bits ^ bits >> 31;
}

/* The number-th of a particle, 0 … 1. */
static double random_of(const maker *m, uint64_t id, uint32_t number) {
  const uint64_t bits = mixed(mixed(mixed(m->diffuse->desc.seed) ^ id) ^ number);
  return (double)(bits >> 11) * 0x1p-53;
}

/* Unit vectors across one. */
static void across_of(const double along[3], uint32_t dimension, double first[3],
                      double second[3]) {
  uint32_t least = 0;
  double length2 = 0;
  for (uint32_t k = 1; k < 3; ++k) least = fabs(along[k]) < fabs(along[least]) ? k : least;
  if (dimension == 2) least = 2;
  for (uint32_t k = 0; k < 3; ++k) {
    second[k] = (k == least) - along[least] * along[k];
    length2 += second[k] * second[k];
  }
  for (uint32_t k = 0; k < 3; ++k) second[k] /= sqrt(length2);
  for (uint32_t a = 0; a < 3; ++a) {
    const uint32_t b = (a + 1) % 3, c = (a + 2) % 3;
    first[a] = second[b] * along[c] - second[c] * along[b];
  }
}

/* From the cylinder's axis, in its radius. */
static void place_across(const maker *m, uint64_t id, const double along[3], double off[3]) {
  double first[3], second[3];
  const double a = random_of(m, id, 1), b = random_of(m, id, 2);
  across_of(along, m->solver->kind.dimension, first, second);
  const int flat = m->solver->kind.dimension == 2;
  const double u = flat ? 2 * a - 1 : sqrt(a) * pbf_cos(2 * pi * b);
  const double v = flat ? 0 : sqrt(a) * pbf_sin(2 * pi * b);
  for (int k = 0; k < 3; ++k) off[k] = u * first[k] + v * second[k];
}

static void make_one(maker *m, const double *position, const double *velocity, double lasting) {
  const pbf_diffuse_desc *desc = &m->diffuse->desc;
  const double speed = pbf_motion_length(velocity), time = m->diffuse->head.time;
  double along[3], off[3];
  for (int k = 0; k < 3; ++k) along[k] = velocity[k] / speed;
  pbf_diffuse_particle *p = pbf_diffuse_push(m->diffuse);
  place_across(m, p->id, along, off);
  const double way = random_of(m, p->id, 0) * m->elapsed;
  for (uint32_t k = 0; k < m->solver->kind.dimension; ++k) {
    p->position[k] = position[k] + way * velocity[k] + m->radius * off[k];
    p->velocity[k] = velocity[k] + desc->scatter * speed * off[k];
  }
  p->born = time;
  p->dies = pbf_diffuse_end(
      time, desc->lifetime_min + (desc->lifetime_max - desc->lifetime_min) * lasting);
  pbf_diffuse_keep_inside(m->solver, m->walls, p);
  p->kind = pbf_diffuse_kind(desc, pbf_fluid_flow_at(&m->others, p->position).neighbors);
  ++m->diffuse->head.generated;
}

/* What is left of a number goes to those after it: over all particles and steps not one is lost. */
static void make_some(maker *m, uint32_t particle) {
  pbf_diffuse_head *head = &m->diffuse->head;
  double position[3], velocity[3], lasting = 0;
  pbf_fluid_particle(m->fluid, particle, position, velocity);
  head->due += fmin(number_of(m, particle, position, velocity, &lasting), (double)PBF_MAX_DIFFUSE);
  const double whole = floor(head->due);
  head->due -= whole;
  for (double made = 0; made < whole && m->room > 0; ++made, --m->room)
    make_one(m, position, velocity, lasting);
}

void pbf_diffuse_generate(const pbf_solver *solver, pbf_fluid *fluid,
                          const pbf_diffuse_walls *walls, double elapsed) {
  pbf_diffuse *d = solver->diffuse;
  const uint32_t count = fluid->place.index->count;
  maker m = {.solver = solver,
             .diffuse = d,
             .fluid = fluid,
             .others = *fluid,
             .walls = walls,
             .elapsed = elapsed,
             .radius = 0.5 * pbf_derive_spacing(&solver->params),
             .room = d->desc.capacity};
  if (!(d->desc.trapped_air_rate > 0) && !(d->desc.wave_crest_rate > 0)) return;
  if (count == 0) return;
  if (d->desc.wave_crest_rate > 0) memset(d->normals, 0, count * sizeof *d->normals);
  for (uint32_t particle = 0; particle < count; ++particle) make_some(&m, particle);
}
