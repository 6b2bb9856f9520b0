/* river [--backend B] [--dimension 2|3] [--precision 32|64] [--steps N] [--every K] [--seed S]
 *
 * Runs the river, changes it every 7 to 40 steps, and looks at it every K. Prints what it has seen;
 * the exit code is 1 where something does not hold. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "river.h"

typedef struct options {
  const char *backend;
  uint64_t dimension, precision, steps, every, seed;
} options;

static int read_options(int count, char **words, options *o) {
  const char *own = getenv("PBF_TEST_BACKEND");
  *o = (options){own ? own : "serial", 3, 32, 1000, 100, 1};
  for (int i = 1; i < count; i += 2) {
    const struct {
      const char *name;
      uint64_t *number;
    } numbers[] = {{"--dimension", &o->dimension},
                   {"--precision", &o->precision},
                   {"--steps", &o->steps},
                   {"--every", &o->every},
                   {"--seed", &o->seed}};
    int known = 0;
    if (i + 1 >= count) return 0;
    if (strcmp(words[i], "--backend") == 0) o->backend = words[i + 1], known = 1;
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; ++k)
      if (strcmp(words[i], numbers[k].name) == 0)
        *numbers[k].number = strtoull(words[i + 1], NULL, 10), known = 1;
    if (!known) return 0;
  }
  return (o->dimension == 2 || o->dimension == 3) && (o->precision == 32 || o->precision == 64) &&
         o->every > 0;
}

static int serves(const options *o) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  river_must(pbf_desc_init(&desc, sizeof desc), "the description");
  desc.backend = o->backend, desc.strict = 1, desc.capacity = 1;
  desc.dimension = (uint32_t)o->dimension, desc.precision = (uint32_t)o->precision / 8;
  const pbf_status status = pbf_create(&desc, NULL, &solver);
  pbf_destroy(solver);
  return status == PBF_OK;
}

/* Up to the end, or to what does not hold. */
static void run(river *r, const options *o) {
  uint64_t next_change = 0;
  while (r->step < o->steps && !r->fault[0]) {
    if (r->step >= next_change) {
      river_change(r);
      dice d = dice_of(r->seed, 1, r->change);
      next_change = r->step + 7 + dice_below(&d, 34);
    }
    uint64_t until = r->step + o->every - r->step % o->every;
    until = until < next_change ? until : next_change;
    until = until < o->steps ? until : o->steps;
    river_float(r, (uint32_t)(until - r->step));
    if (r->step % o->every == 0 || r->step == o->steps) river_check(r);
  }
}

int main(int count, char **words) {
  options o;
  if (!read_options(count, words, &o)) {
    fprintf(stderr,
            "usage: river [--backend B] [--dimension 2|3] [--precision 32|64] [--steps N] "
            "[--every K] [--seed S]\n");
    return 2;
  }
  if (!serves(&o)) {
    printf("SKIPPED: %s\n", pbf_last_error());
    return 77;
  }
  river r = {
      .dimension = (uint32_t)o.dimension, .precision = (uint32_t)o.precision / 8, .seed = o.seed};
  uint64_t hash = 0;
  uint32_t held = 0;
  river_begin(&r, o.backend);
  run(&r, &o);
  river_must(pbf_hash(r.solver, &hash), "the hash");
  river_must(pbf_get_count(r.solver, &held), "the count");
  pbf_in_out io = {.struct_size = sizeof io};
  river_must(pbf_get_in_out(r.solver, &io), "what came and went");
  river_end(&r);
  printf("river --backend %s --dimension %u --precision %u --seed %" PRIu64 ": %" PRIu64
         " steps, %" PRIu64 " changes; %" PRIu64 " particles emitted, %" PRIu64 " put, %" PRIu64
         " drained, %" PRIu64 " expired, %" PRIu64 " recycled, %" PRIu64 " taken, %" PRIu64
         " refused, %u held; seen: %" PRIu64 " squeezed, %" PRIu64
         " in a solid, %.2f spacings in the bed at most, fastest %.3g; state %016" PRIx64 "\n",
         o.backend, r.dimension, 8 * r.precision, r.seed, r.step, r.change, io.emitted, r.put,
         io.drained, io.expired, io.recycled, r.taken, io.refused, held, r.squeezed, r.in_solid,
         r.deepest, r.fastest, hash);
  if (r.fault[0])
    printf("at step %" PRIu64 ", after change %" PRIu64 ": %s\n", r.step, r.change, r.fault);
  return r.fault[0] ? 1 : 0;
}
