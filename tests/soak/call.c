/* One call on two solvers, under faults. */
#include <errno.h>
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "actor.h"
#include "param_table.h"

_Thread_local actor *this_actor;

void check_status(actor *a, pbf_status status, const char *sentence) {
  if (status == PBF_OK) return;
  if (status > 0 || status < PBF_ERROR_CANCELLED)
    found(a->number, "%s: unknown status %d", a->function, (int)status);
  if (!sentence[0])
    found(a->number, "%s: %s without a sentence", a->function, pbf_status_string(status));
}

/* ---- What there is to see of a solver ------------------------------------------------------- */

typedef struct look {
  uint64_t hash, step;
  double time;
  uint32_t count, colliders;
  pbf_params params;
  pbf_collider first;
} look;

static int is_of_limits(const actor *a, pbf_status status) {
  return status == PBF_ERROR_OUT_OF_MEMORY && (a->with->limit_addresses || a->with->limit_threads);
}

/* Of a call that has to succeed. Where there is no memory for a look, there is nothing to see. */
static int is_free(actor *a, pbf_status status, const char *call) {
  if (status == PBF_OK) return 1;
  if (is_of_limits(a, status)) _exit(0);
  if (status != PBF_ERROR_BUSY || !a->with->intruders)
    found(a->number, "%s: then %s: %s: %s", a->function, call, pbf_status_string(status),
          pbf_last_error());
  sched_yield();
  return 0;
}

/* Others may be inside at the moment. */
#define UNTIL_FREE(a, call)              \
  while (!is_free((a), (call), #call)) { \
  }

static look look_at(actor *a, int twin) {
  pbf_solver *s = a->subject->twin[twin];
  pbf_info info = {.struct_size = sizeof info};
  look l;
  memset(&l, 0, sizeof l);
  UNTIL_FREE(a, pbf_hash(s, &l.hash));
  UNTIL_FREE(a, pbf_get_info(s, &info));
  UNTIL_FREE(a, pbf_get_count(s, &l.count));
  UNTIL_FREE(a, pbf_get_collider_count(s, &l.colliders));
  l.params.struct_size = sizeof l.params;
  UNTIL_FREE(a, pbf_get_params(s, &l.params));
  l.first.struct_size = sizeof l.first;
  if (l.colliders) UNTIL_FREE(a, pbf_get_collider(s, 0, &l.first));
  l.step = info.step;
  l.time = info.time;
  return l;
}

uint64_t step_of(actor *a, int twin) {
  pbf_info info = {.struct_size = sizeof info};
  UNTIL_FREE(a, pbf_get_info(a->subject->twin[twin], &info));
  return info.step;
}

static const char *difference(const look *one, const look *other) {
  if (one->step != other->step) return "steps";
  if (memcmp(&one->time, &other->time, sizeof one->time) != 0) return "times";
  if (one->count != other->count) return "counts";
  if (one->hash != other->hash) return "hashes";
  if (memcmp(&one->params, &other->params, sizeof one->params) != 0) return "parameters";
  if (one->colliders != other->colliders) return "numbers of colliders";
  return memcmp(&one->first, &other->first, sizeof one->first) != 0 ? "first colliders" : NULL;
}

void check_subject(actor *a) {
  subject *s = a->subject;
  const look one = look_at(a, 0), other = look_at(a, 1);
  const char *differ = difference(&one, &other);
  if (differ)
    found(a->number, "%s: %s of two solvers differ after the same calls (%s and %s)", a->function,
          differ, s->backend[0], s->backend[1]);
  if (one.count != s->model.count)
    found(a->number, "%s: %u particles, by the calls so far %u", a->function, one.count,
          s->model.count);
  uint32_t ids[MOST_PARTICLES];
  UNTIL_FREE(a, pbf_get_ids(s->twin[0], 0, one.count, ids));
  if (memcmp(ids, s->model.ids, one.count * sizeof *ids) != 0)
    found(a->number, "%s: the ids are not those of the calls so far", a->function);
}

/* ---- The floating-point environment of a caller ---------------------------------------------- */

#if defined(__x86_64__)

/* Any rounding mode, flushing, flags and unmasked exceptions. */
static unsigned draw_environment(actor *a, dice *d) {
  unsigned csr = 0x1f80;
  if (!a->with->environments || !dice_one_in(d, 3)) return csr;
  count_fault(FAULT_ENVIRONMENT);
  csr = (csr & ~0x6000u) | dice_below(d, 4) << 13;
  if (dice_one_in(d, 2)) csr ^= 0x8040; /* flush to zero, and denormals are zero */
  csr |= dice_below(d, 0x40);
  if (dice_one_in(d, 3)) csr &= ~(dice_below(d, 0x40) << 7); /* trap */
  return csr;
}

static void begin_environment(unsigned csr) { _mm_setcsr(csr); }

static void end_environment(actor *a, unsigned csr) {
  const unsigned now = _mm_getcsr();
  _mm_setcsr(0x1f80);
  if (now != csr)
    found(a->number, "%s: the caller's MXCSR was %#x and is %#x", a->function, csr, now);
}

#else

static unsigned draw_environment(actor *a, dice *d) {
  static const int modes[] = {FE_TONEAREST, FE_TONEAREST, FE_DOWNWARD, FE_TOWARDZERO};
  if (!a->with->environments) return FE_TONEAREST;
  return (unsigned)modes[dice_below(d, 4)];
}

static void begin_environment(unsigned mode) { fesetround((int)mode); }

static void end_environment(actor *a, unsigned mode) {
  const int now = fegetround();
  fesetround(FE_TONEAREST);
  if (now != (int)mode) found(a->number, "%s: the caller's rounding mode has changed", a->function);
}

#endif

/* ---- Faults ---------------------------------------------------------------------------------- */

static void arm(actor *a, heap *h, dice *d) {
  h->thread = pthread_self();
  h->failed = h->left = 0;
  if (a->with->memory && dice_one_in(d, 8)) h->failing_in = 1 + (int)dice_below(d, 9);
}

static void disarm(heap *h) {
  h->failing_in = h->leaving_in = 0;
  if (h->failed) count_fault(FAULT_MEMORY);
}

static pbf_status make_once(actor *a, int twin, action act, void *context, dice *d, int how) {
  heap *h = a->subject->heap[twin];
  const unsigned environment = draw_environment(a, d);
  if (!(how & CALL_PLAIN)) arm(a, h, d);
  begin_environment(environment);
  pbf_status status = act(a->subject->twin[twin], twin, context);
  end_environment(a, environment);
  const int failed = h->failed;
  disarm(h);
  snprintf(a->sentence[twin], sizeof a->sentence[twin], "%s", pbf_last_error());
  check_status(a, status, a->sentence[twin]);
  a->injected[twin] = (status == PBF_ERROR_OUT_OF_MEMORY && failed) || is_of_limits(a, status);
  return status;
}

pbf_status call_one(actor *a, int twin, action act, void *context, int how) {
  dice d = dice_of(a->seed, 1000 + a->number * 4 + (uint32_t)twin, dice_next(&a->dice));
  for (int tries = 0;; ++tries) {
    const int tells = !a->subject->begun[twin];
    look before = tells ? look_at(a, twin) : (look){0};
    pbf_status status = make_once(a, twin, act, context, &d, tries < 4 ? how : how | CALL_PLAIN);
    if (status == PBF_ERROR_BUSY && a->with->intruders && tells) {
      sched_yield();
      --tries;
      continue;
    }
    if (tells && !a->subject->begun[twin] && (status != PBF_OK || how & CALL_READS)) {
      look after = look_at(a, twin);
      const char *differ = difference(&before, &after);
      if (differ && status == PBF_ERROR_OUT_OF_MEMORY && before.params.max_substeps > 1)
        return status;
      if (differ)
        found(a->number, "%s: %s, and %s are not what they were before: %s", a->function,
              pbf_status_string(status), differ, status ? a->sentence[twin] : "");
    }
    if (!a->injected[twin] || tries > 20) return status;
  }
}

pbf_status call_both(actor *a, action act, void *context, int how) {
  const sig_atomic_t signals = a->signals;
  pbf_status status[TWINS];
  const uint64_t same = dice_next(&a->dice);
  for (int twin = 0; twin < TWINS; ++twin) {
    a->dice.state = same; /* what a call draws is the same for both */
    status[twin] = call_one(a, twin, act, context, how);
    if (how & CALL_WRONG && status[twin] == PBF_OK)
      found(a->number, "%s: wrong arguments are accepted", a->function);
    if (a->injected[twin] && twin > 0 && status[0] == PBF_OK) _exit(0); /* a limit parts them */
    if (a->injected[twin]) return status[twin];
  }
  if (how & CALL_LOOSE) return status[0] ? status[0] : status[1];
  if (status[0] != status[1])
    found(a->number, "%s: %s on %s (%s), %s on %s (%s)", a->function, pbf_status_string(status[0]),
          a->subject->backend[0], status[0] ? a->sentence[0] : "", pbf_status_string(status[1]),
          a->subject->backend[1], status[1] ? a->sentence[1] : "");
  if (status[0] != PBF_OK && signals == a->signals && strcmp(a->sentence[0], a->sentence[1]) != 0)
    found(a->number, "%s: two sentences: \"%s\" and \"%s\"", a->function, a->sentence[0],
          a->sentence[1]);
  return status[0];
}

/* Those of no particles take no time, and are none. */
void count_steps(const actor *a, uint64_t steps) {
  if (a->subject->model.count) atomic_fetch_add(&soak_record->steps, steps);
}

/* ---- Steps ------------------------------------------------------------------------------------
 */

static pbf_status step_on(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_step(solver, *(const uint32_t *)context);
}

/* Not by call_one: a step that fails leaves those before it. */
pbf_status advance(actor *a, int twin, uint64_t end) {
  dice d = dice_of(a->seed, 2000 + a->number * 4 + (uint32_t)twin, dice_next(&a->dice));
  for (int tries = 0;; ++tries) {
    const uint64_t now = step_of(a, twin);
    if (now >= end) return PBF_OK;
    uint32_t steps = (uint32_t)(end - now);
    pbf_status status = make_once(a, twin, step_on, &steps, &d, tries < 4 ? 0 : CALL_PLAIN);
    const int again = status == PBF_ERROR_CANCELLED || a->injected[twin] ||
                      (status == PBF_ERROR_BUSY && a->with->intruders);
    count_steps(a, step_of(a, twin) - now);
    if (status == PBF_ERROR_CANCELLED) count_fault(FAULT_CANCEL);
    if (status == PBF_OK && step_of(a, twin) != end)
      found(a->number, "%s: PBF_OK after %llu of %u steps", a->function,
            (unsigned long long)(step_of(a, twin) - now), steps);
    if (status != PBF_OK && !again) return status;
    if (a->injected[twin] && tries > 5) return status; /* a limit, that stays */
    if (status == PBF_ERROR_BUSY) sched_yield();
  }
}

/* An angle that is known to no part of a turn has none, by params.h. */
static double wall_at(const pbf_params *p, int wall, double time) {
  const double bound = wall % 2 ? p->domain_max[wall / 2] : p->domain_min[wall / 2];
  const double angle = p->wall_frequency[wall] * time + p->wall_phase[wall];
  return bound + p->wall_velocity[wall] * time +
         (fabs(angle) < 0x1p52 ? p->wall_amplitude[wall] * sin(angle) : 0);
}

/* Those parameters that are not the defaults, to repeat what was found by hand. */
static const char *describe(const pbf_params *params) {
  static _Thread_local char text[700];
  pbf_params usual;
  size_t at = 0;
  if (pbf_params_init(&usual, sizeof usual) != PBF_OK) return "";
  text[0] = 0;
  for (int k = 0; k < TABLE_PARAMS; ++k)
    for (uint32_t c = 0; c < table_params[k].components && at + 60 < sizeof text; ++c) {
      const size_t offset = table_params[k].offset + c * sizeof(double);
      double value, other;
      memcpy(&value, (const char *)params + offset, sizeof value);
      memcpy(&other, (const char *)&usual + offset, sizeof other);
      if (value == other) continue;
      at += (size_t)snprintf(text + at, sizeof text - at, " %s[%u]=%.9g", table_params[k].name, c,
                             value);
    }
  snprintf(text + at, sizeof text - at, " kernel=%u iterations=%u collide=%u solver=%u substeps=%u",
           params->kernel, params->iterations, params->collide, params->solver,
           params->max_substeps);
  return text;
}

void check_places(actor *a, int twin) {
  subject *s = a->subject;
  pbf_solver *solver = s->twin[twin];
  pbf_params p = {.struct_size = sizeof p};
  pbf_info info = {.struct_size = sizeof info};
  unsigned char *x = a->numbers[0], *v = a->numbers[1];
  UNTIL_FREE(a, pbf_get_params(solver, &p));
  UNTIL_FREE(a, pbf_get_info(solver, &info));
  UNTIL_FREE(a, pbf_get_positions(solver, 0, s->model.count, x));
  UNTIL_FREE(a, pbf_get_velocities(solver, 0, s->model.count, v));
  for (uint32_t i = 0; i < s->model.count * s->dimension; ++i) {
    const double at = value_at(s, x, i);
    const int axis = (int)(i % s->dimension);
    if (!isfinite(at) || !isfinite(value_at(s, v, i)))
      found(a->number, "%s: particle %u of %s is at %g with velocity %g of %u (%uD, %u bytes);%s",
            a->function, i / s->dimension, s->backend[twin], at, value_at(s, v, i), s->model.count,
            s->dimension, s->precision, describe(&p));
    const double low = wall_at(&p, 2 * axis, info.time),
                 high = wall_at(&p, 2 * axis + 1, info.time);
    if (!(p.collide & (PBF_COLLIDE_IN_ITERATION | PBF_COLLIDE_AFTER_SOLVE))) continue;
    /* Near 0 the steps of float32 are those of its subnormal numbers. */
    const double least = s->precision == 4 ? FLT_TRUE_MIN : 0;
    const double slack = 1e-5 * (fabs(low) + fabs(high) + (high - low)) + least;
    if (at < low - slack || at > high + slack)
      found(a->number, "%s: particle %u of %s is at %.9g, the walls at %.9g and %.9g;%s",
            a->function, i / s->dimension, s->backend[twin], at, low, high, describe(&p));
  }
}

/* While a view is mapped no step runs. */
static int is_mapped(const subject *s) {
  uint32_t mapped = s->tensor[0] != NULL;
  for (int field = 0; field < MOST_FIELDS; ++field) mapped += s->mapped[field];
  return mapped > 0;
}

void even_out(actor *a) {
  subject *s = a->subject;
  if (is_mapped(s)) return;
  static _Thread_local unsigned char state[STATE_BYTES];
  uint64_t size = sizeof state;
  UNTIL_FREE(a, pbf_save(s->twin[0], state, &size));
  for (int twin = 0; twin < TWINS; ++twin) UNTIL_FREE(a, pbf_load(s->twin[twin], state, size));
}
