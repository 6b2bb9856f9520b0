#include "twins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The oracle, and what is held against it where no tasks are: `serial`, or on machines that have
 * one a device. */
static const char *name_of(int twin) {
  const char *asked = getenv("PBF_TEST_BACKEND");
  if (twin == 0) return "reference";
  return asked && *asked ? asked : "serial";
}

void *twins_enqueue(void *user, pbf_task_fn run, void *task, uint32_t items, uint32_t min_range) {
  (void)user;
  if (min_range > 1)
    run(task, 0, items);
  else
    for (uint32_t i = items; i-- > 0;) run(task, i, i + 1);
  return NULL;
}

/* Nothing is left to do. */
static void finish(void *user, void *handle) { (void)user, (void)handle; }

/* The one that is held against the oracle. */
static pbf_solver *make_other(kind k, int tasked, uint32_t determinism) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  insist(pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  desc.dimension = k.dimension;
  desc.precision = k.precision;
  desc.capacity = TWIN_CAPACITY;
  desc.backend = tasked ? "threads" : name_of(1);
  desc.strict = 1;
  desc.threads = tasked ? 3 : 1;
  desc.enqueue_task = tasked ? twins_enqueue : NULL;
  desc.finish_task = tasked ? finish : NULL;
  desc.determinism = determinism;
  insist(pbf_create(&desc, NULL, &solver) == PBF_OK);
  return solver;
}

twins twins_make(kind k, int tasked, uint32_t determinism) {
  twins t = {.k = k};
  t.solver[0] = make_solver(name_of(0), k, TWIN_CAPACITY);
  t.solver[1] = make_other(k, tasked && FUZZ_THREADS, determinism);
  return t;
}

void twins_destroy(twins *t) {
  for (int i = 0; i < TWINS; ++i) pbf_destroy(t->solver[i]);
}

/* All that a caller can see of a solver but the particles themselves. */
typedef struct books {
  uint32_t count, colliders;
  uint64_t step;
  double time;
  uint32_t ids[TWIN_CAPACITY];
  pbf_params params;
  pbf_collider collider[4];
} books;

static books books_of(pbf_solver *s) {
  books b;
  pbf_info info = {.struct_size = sizeof info};
  memset(&b, 0, sizeof b);
  insist(pbf_get_count(s, &b.count) == PBF_OK && b.count <= TWIN_CAPACITY);
  insist(pbf_get_ids(s, 0, b.count, b.ids) == PBF_OK);
  b.params.struct_size = sizeof b.params;
  insist(pbf_get_params(s, &b.params) == PBF_OK);
  insist(pbf_get_collider_count(s, &b.colliders) == PBF_OK);
  for (uint32_t i = 0; i < b.colliders && i < 4; ++i) {
    b.collider[i].struct_size = sizeof b.collider[i];
    insist(pbf_get_collider(s, i, &b.collider[i]) == PBF_OK);
  }
  insist(pbf_get_info(s, &info) == PBF_OK);
  b.step = info.step;
  b.time = info.time;
  return b;
}

static uint64_t hash_of(pbf_solver *s) {
  uint64_t hash = 0;
  insist(pbf_hash(s, &hash) == PBF_OK);
  return hash;
}

static void insist_unchanged(const books *before, uint64_t hash, pbf_solver *s) {
  books after = books_of(s);
  insist(memcmp(before, &after, sizeof after) == 0);
  insist(hash_of(s) == hash);
}

pbf_status twins_call(twins *t, twin_call call, void *context) {
  pbf_status status[TWINS];
  char sentence[TWINS][1024];
  for (int i = 0; i < TWINS; ++i) {
    books before = books_of(t->solver[i]);
    uint64_t hash = hash_of(t->solver[i]);
    status[i] = call(t->solver[i], context);
    snprintf(sentence[i], sizeof sentence[i], "%s", pbf_last_error());
    if (status[i] != PBF_OK) insist_unchanged(&before, hash, t->solver[i]);
  }
  if (status[0] != status[1] || (status[0] != PBF_OK && strcmp(sentence[0], sentence[1]) != 0)) {
    for (int i = 0; i < TWINS; ++i)
      fprintf(stderr, "%s: status %d, last sentence: %s\n", name_of(i), (int)status[i],
              sentence[i]);
    insist(!"one status and one sentence");
  }
  books a = books_of(t->solver[0]), b = books_of(t->solver[1]);
  insist(memcmp(&a, &b, sizeof a) == 0);
  return status[0];
}

typedef struct snapshot {
  _Alignas(8) unsigned char bytes[1 << 15];
  uint64_t size;
} snapshot;

static int load_from(pbf_solver *to, pbf_solver *from) {
  static snapshot s;
  s.size = sizeof s.bytes;
  insist(pbf_save(from, s.bytes, &s.size) == PBF_OK);
  return pbf_load(to, s.bytes, s.size) == PBF_OK;
}

pbf_status twins_call_apart(twins *t, twin_call call, void *context) {
  return load_from(t->solver[1], t->solver[0]) ? twins_call(t, call, context) : PBF_ERROR_STATE;
}

uint32_t twins_count(const twins *t) {
  uint32_t count = 0;
  insist(pbf_get_count(t->solver[0], &count) == PBF_OK);
  return count;
}

typedef struct particles {
  _Alignas(8) unsigned char x[TWIN_CAPACITY * 3 * 8], v[TWIN_CAPACITY * 3 * 8];
  uint32_t count;
} particles;

static void get_particles(pbf_solver *s, particles *p) {
  insist(pbf_get_count(s, &p->count) == PBF_OK);
  insist(pbf_get_positions(s, 0, p->count, p->x) == PBF_OK);
  insist(pbf_get_velocities(s, 0, p->count, p->v) == PBF_OK);
}

/* Gives the second twin the particles of the first: by overwriting them where they are, or by way
 * of a saved state, which is portable between backends and has what is left of an overlap, too.
 * Fails while a view is mapped. */
static int even_out(twins *t, int by_loading) {
  particles p;
  if (!by_loading && !t->overlapped) {
    get_particles(t->solver[0], &p);
    if (pbf_set_positions(t->solver[1], 0, p.count, p.x) == PBF_OK &&
        pbf_set_velocities(t->solver[1], 0, p.count, p.v) == PBF_OK)
      return 1;
  }
  return load_from(t->solver[1], t->solver[0]);
}

static pbf_status step_once(pbf_solver *solver, void *context) {
  (void)context;
  return pbf_step(solver, 1);
}

/* The farthest that two numbers of one array lie apart; infinite when one is not finite. */
static double distance(const twins *t, const void *a, const void *b, uint32_t count) {
  double farthest = 0;
  for (uint32_t i = 0; i < count; ++i) {
    double one = number_at(a, i, t->k.precision), other = number_at(b, i, t->k.precision);
    if (!isfinite(one) || !isfinite(other)) return INFINITY;
    farthest = fmax(farthest, fabs(one - other));
  }
  return farthest;
}

/* In units of h: what a sum in another order may do, and how far the oracle's own particles are
 * displaced to see what comes of it. */
static double rounding(const twins *t) { return t->k.precision == PBF_FLOAT64 ? 1e-9 : 1e-3; }
static double shake(const twins *t) { return t->k.precision == PBF_FLOAT64 ? 1e-9 : 1e-4; }

static pbf_params params_of(const twins *t) {
  pbf_params params = {.struct_size = sizeof params};
  insist(pbf_get_params(t->solver[0], &params) == PBF_OK);
  return params;
}

/* A third solver, the oracle from a state a little off: what a few particles crushed between walls
 * do depends on the last digit, and no distance to them can be stated but by this measure. Null
 * when a displaced particle would be outside the domain. */
static pbf_solver *shaken_oracle(const twins *t) {
  pbf_solver *s = make_solver(name_of(0), t->k, TWIN_CAPACITY);
  particles p;
  int ready = load_from(s, t->solver[0]);
  get_particles(s, &p);
  double by = shake(t) * params_of(t).smoothing_radius;
  for (uint32_t i = 0; i < p.count * t->k.dimension; ++i) {
    double x = number_at(p.x, i, t->k.precision), sign = i * 2654435761u >> 16 & 1 ? 1 : -1;
    if (fabs(x - 0.5) > 0.25) sign = x < 0.5 ? 1 : -1;
    put_number(p.x, i, t->k.precision, x + sign * by);
  }
  if (ready && pbf_set_positions(s, 0, p.count, p.x) == PBF_OK) return s;
  pbf_destroy(s);
  return NULL;
}

/* How far the solve and the obstacles took a particle from where it was predicted, in units of h.
 */
static double farthest_move(const twins *t, const particles *before, const particles *after) {
  pbf_params params = params_of(t);
  double farthest = 0, dt = params.time_step;
  for (uint32_t i = 0; i < after->count * t->k.dimension; ++i) {
    uint32_t axis = i % t->k.dimension;
    double x = number_at(before->x, i, t->k.precision), v = number_at(before->v, i, t->k.precision);
    double a = params.gravity[axis] - params.attraction * (x - params.attraction_center[axis]);
    double predicted = x + dt * (v + dt * a);
    farthest = fmax(farthest, fabs(number_at(after->x, i, t->k.precision) - predicted));
  }
  return farthest / params.smoothing_radius;
}

/* The mean error that ends a solve is the same to rounding alone: so is the number of iterations.
 */
static int took_as_long(pbf_solver *a, pbf_solver *b) {
  pbf_stats one = {.struct_size = sizeof one}, other = {.struct_size = sizeof other};
  insist(pbf_get_stats(a, &one) == PBF_OK && pbf_get_stats(b, &other) == PBF_OK);
  return one.iterations == other.iterations;
}

/* In one, what is h away from it is held by many times what its own move says; and colliders that
 * leave a particle no room move it, by whatever they are apart, as the last digit decides. */
static int has_a_crowd_or_no_room(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  insist(pbf_get_stats(s, &stats) == PBF_OK);
  return stats.density_error_max > 4 || stats.squeezed > 0;
}

static int is_coarse_or_short(const twins *t) {
  pbf_params p = params_of(t);
  double g =
      sqrt(p.gravity[0] * p.gravity[0] + p.gravity[1] * p.gravity[1] + p.gravity[2] * p.gravity[2]);
  int is_short = g > 0 && p.time_step < 0.02 * sqrt(p.smoothing_radius / g);
  return p.spacing > 0.7 * p.smoothing_radius || is_short;
}

/* Which pairs a step looks at follows from the predicted positions. One that comes within h during
 * the solve is seen by a search that looked farther than it had to and missed by another: an error
 * of the square of how far particles move in the solve, in units of h, and no bound where they move
 * by as much as h. Where h is hardly more than the spacing such a pair is all that pushes, and the
 * error as large as the move; so it is in steps that ask for the density at their start, too, where
 * pairs may have been within h that are looked at no more: very short ones, and those that look for
 * what overlaps. The farther move of the two solvers counts, since only one may have seen the pair.
 */
static void compare_particles(const twins *t, const particles *before, pbf_solver *shaken) {
  particles a, b, c;
  get_particles(t->solver[0], &a);
  get_particles(t->solver[1], &b);
  get_particles(shaken, &c);
  uint32_t numbers = a.count * t->k.dimension;
  double h = params_of(t).smoothing_radius, apart = distance(t, a.x, b.x, numbers) / h;
  double moved = fmax(farthest_move(t, before, &a), farthest_move(t, before, &b));
  double unseen = is_coarse_or_short(t) || t->placed ? 2 * moved : 2 * moved * moved;
  double limit = rounding(t) + unseen + 10 * distance(t, a.x, c.x, numbers) / h;
  insist(isfinite(distance(t, a.v, b.v, numbers)) && isfinite(apart));
  if (moved > 0.25 || apart <= limit || has_a_crowd_or_no_room(t->solver[0])) return;
  fprintf(stderr, "positions are %.3g h apart after a step; at most %.3g h\n", apart, limit);
  insist(apart <= limit);
}

/* A fluid's particles have to be numbers for ever; those of wild parameters may not. */
static int are_finite(pbf_solver *s, const twins *t) {
  particles p;
  get_particles(s, &p);
  uint32_t numbers = p.count * t->k.dimension;
  return isfinite(distance(t, p.x, p.x, numbers)) && isfinite(distance(t, p.v, p.v, numbers));
}

void twins_note_lost(twins *t) {
  for (int i = 0; i < TWINS; ++i) t->lost |= !are_finite(t->solver[i], t);
  insist(!t->lost || t->wild);
}

pbf_status twins_step(twins *t, int by_loading) {
  particles before;
  int even = even_out(t, by_loading);
  pbf_solver *shaken = even && !t->wild ? shaken_oracle(t) : NULL;
  get_particles(t->solver[0], &before);
  pbf_status status = twins_call(t, step_once, NULL);
  if (status == PBF_OK && shaken && pbf_step(shaken, 1) == PBF_OK &&
      took_as_long(t->solver[0], t->solver[1]))
    compare_particles(t, &before, shaken);
  pbf_destroy(shaken);
  t->overlapped |= t->placed;
  t->placed = 0;
  twins_note_lost(t);
  return status;
}

void twins_compare_reports(twins *t) {
  _Alignas(8) unsigned char rho[TWINS][TWIN_CAPACITY * 8];
  pbf_stats stats[TWINS];
  double limit = t->k.precision == PBF_FLOAT64 ? 1e-9 : 1e-3;
  uint32_t count = twins_count(t);
  int even = even_out(t, 0);
  for (int i = 0; i < TWINS; ++i) {
    stats[i] = (pbf_stats){.struct_size = sizeof stats[i]};
    insist(pbf_get_densities(t->solver[i], 0, count, rho[i]) == PBF_OK);
    insist(pbf_get_stats(t->solver[i], &stats[i]) == PBF_OK);
    insist(stats[i].count == count);
  }
  if (t->wild || !even) return;
  double largest = 1;
  for (uint32_t i = 0; i < count; ++i)
    largest = fmax(largest, number_at(rho[0], i, t->k.precision));
  insist(distance(t, rho[0], rho[1], count) <= limit * largest);
  insist(fabs(stats[0].density_mean - stats[1].density_mean) <= limit * largest);
  insist(fabs(stats[0].speed_max - stats[1].speed_max) <= limit * (1 + stats[0].speed_max));
}
