#include "emitter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "opening.h"
#include "params.h"
#include "physics/spacing.h"
#include "solver/solver_time.h"
#include "structs.h"
#include "text.h"

#define COUNT(member, max, hint) \
  { #member, offsetof(pbf_emitter, member), 0, max, hint, 0 }
#define REAL(member, components, range) \
  { #member, offsetof(pbf_emitter, member), components, range, 0 }
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const pbf_count_rule counts[] = {
    COUNT(shape, PBF_EMITTER_DISC, " (PBF_EMITTER_…)"),
    COUNT(recycle, 1, ""),
    COUNT(reserved, 0, ""),
};

static const pbf_real_rule reals[] = {
    REAL(position, 3, PBF_ANY),           REAL(velocity, 3, PBF_ANY),
    REAL(rate, 1, PBF_AT_LEAST_ZERO),     REAL(jitter, 1, PBF_FRACTION),
    REAL(lifetime, 1, PBF_AT_LEAST_ZERO),
};

static const pbf_real_rule across_rule = REAL(across, 3, PBF_ANY);
static const pbf_real_rule radius_rule = REAL(radius, 1, PBF_ABOVE_ZERO);
static const pbf_real_rule side_rules[] = {
    {"half_width", offsetof(pbf_emitter, half_width), 1, PBF_ABOVE_ZERO, 0},
    {"half_height", offsetof(pbf_emitter, half_height), 1, PBF_ABOVE_ZERO, 0},
};

static pbf_status check_sizes(const pbf_emitter *emitter, const char *label, pbf_check_kind kind) {
  const size_t sides = kind.dimension == 3 ? 2 : 1;
  pbf_status status = emitter->shape == PBF_EMITTER_DISC
                          ? pbf_check_real(&radius_rule, label, emitter, kind)
                          : pbf_check_reals(side_rules, sides, label, emitter, kind);
  if (status == PBF_OK && kind.dimension == 3)
    status = pbf_check_real(&across_rule, label, emitter, kind);
  return status;
}

pbf_status pbf_emitter_check(const pbf_emitter *emitter, uint32_t index, pbf_check_kind kind) {
  char label[32], number[PBF_NUMBER_SIZE];
  double square = 0;
  snprintf(label, sizeof label, "emitters[%u]", index);
  pbf_status status = pbf_check_counts(counts, LENGTH(counts), label, emitter);
  if (status == PBF_OK) status = pbf_check_reals(reals, LENGTH(reals), label, emitter, kind);
  if (status == PBF_OK) status = check_sizes(emitter, label, kind);
  for (uint32_t k = 0; k < kind.dimension; ++k)
    square += emitter->velocity[k] * emitter->velocity[k];
  if (status == PBF_OK && !(square > 0 && isfinite(square)))
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s.velocity has the size %s; it must be above 0 and at most 1e150", label,
                      pbf_text_number(number, sqrt(square)));
  return status;
}

/* Of more columns than particles none could have one. */
static pbf_status check_columns(const pbf_opening *opening, uint32_t index,
                                const pbf_solver *solver) {
  const pbf_box box = pbf_params_box(&solver->params, opening->dimension, pbf_solver_time(solver));
  if (opening->columns > solver->capacity)
    return pbf_fail(PBF_ERROR_CAPACITY,
                    "emitters[%u] has %.9g columns of particles; desc.capacity is %u", index,
                    (double)opening->columns, solver->capacity);
  for (uint64_t column = 0; column < opening->columns; ++column) {
    double place[3];
    pbf_opening_place(opening, column, place);
    for (uint32_t k = 0; k < opening->dimension; ++k)
      if (!(place[k] >= box.lower[k] && place[k] <= box.upper[k]))
        return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                        "emitters[%u] reaches to %.9g along axis %u; it must be inside the domain, "
                        "%.9g … %.9g",
                        index, place[k], k, box.lower[k], box.upper[k]);
  }
  return PBF_OK;
}

/* By sizes alone, before columns are counted one by one. */
static pbf_status check_size(const pbf_emitter *emitter, uint32_t index, const pbf_solver *solver,
                             double spacing) {
  const double most = 2.0 * PBF_MAX_CAPACITY * spacing;
  const double a = emitter->shape == PBF_EMITTER_DISC ? emitter->radius : emitter->half_width;
  const double b = emitter->shape == PBF_EMITTER_DISC || solver->kind.dimension == 2
                       ? spacing
                       : emitter->half_height;
  const double widest = fmax(a, b), least = emitter->shape == PBF_EMITTER_DISC ? a * a : a * b;
  if (widest < most && least < 2.0 * solver->capacity * spacing * spacing + a * spacing)
    return PBF_OK;
  return pbf_fail(PBF_ERROR_CAPACITY,
                  "emitters[%u] is so large that it has more columns of particles than "
                  "desc.capacity, %u",
                  index, solver->capacity);
}

pbf_status pbf_emitter_check_place(const pbf_emitter *emitter, uint32_t index,
                                   const pbf_solver *solver) {
  const uint32_t n = solver->kind.dimension;
  const double d = pbf_derive_spacing(&solver->params);
  pbf_status status = check_size(emitter, index, solver, d);
  if (status != PBF_OK) return status;
  const pbf_opening opening = pbf_opening_of(emitter, n, d);
  status = check_columns(&opening, index, solver);
  if (status != PBF_OK) return status;
  const double most = (double)opening.columns * (n == 3 ? d * d : d) * opening.speed;
  if (opening.rate > most * (1 + 1e-9))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "emitters[%u].rate is %.9g; its %.0f columns carry at most %.9g at this "
                    "velocity",
                    index, opening.rate, (double)opening.columns, most);
  const double a_step = opening.rate * solver->params.time_step / (n == 3 ? d * d * d : d * d);
  if (a_step > solver->capacity)
    return pbf_fail(PBF_ERROR_CAPACITY,
                    "emitters[%u] would add %.9g particles in each step of params.time_step, %.3g; "
                    "desc.capacity is %u",
                    index, a_step, solver->params.time_step, solver->capacity);
  return PBF_OK;
}

static pbf_emitter initial_of(uint32_t shape) {
  return (pbf_emitter){.struct_size = sizeof(pbf_emitter),
                       .shape = shape,
                       .velocity = {0, -1, 0},
                       .across = {1, 0, 0},
                       .half_width = 1,
                       .half_height = 1,
                       .radius = 1};
}

void pbf_emitter_clean(pbf_emitter *emitter, uint32_t dimension) {
  const pbf_emitter initial = initial_of(emitter->shape);
  const int is_disc = emitter->shape == PBF_EMITTER_DISC;
  if (dimension == 2) {
    emitter->position[2] = emitter->velocity[2] = 0;
    memcpy(emitter->across, initial.across, sizeof initial.across);
  }
  if (is_disc) emitter->half_width = initial.half_width;
  if (is_disc || dimension == 2) emitter->half_height = initial.half_height;
  if (!is_disc) emitter->radius = initial.radius;
}

static int are_same(const double a[3], const double b[3], uint32_t dimension) {
  for (uint32_t k = 0; k < dimension; ++k)
    if (a[k] < b[k] || a[k] > b[k]) return 0;
  return 1;
}

int pbf_emitters_share(const pbf_emitter *one, const pbf_emitter *other, uint32_t dimension) {
  if (one->shape != other->shape || !are_same(one->position, other->position, dimension) ||
      !are_same(one->velocity, other->velocity, dimension))
    return 0;
  pbf_emitter a = *one, b = *other;
  pbf_emitter_clean(&a, dimension);
  pbf_emitter_clean(&b, dimension);
  const double sizes[2][3] = {{a.half_width, a.half_height, a.radius},
                              {b.half_width, b.half_height, b.radius}};
  return are_same(sizes[0], sizes[1], 3) && are_same(a.across, b.across, 3);
}

pbf_status pbf_emitter_init(pbf_emitter *emitter, uint32_t struct_size, uint32_t shape) {
  const pbf_emitter initial = initial_of(shape);
  if (!emitter) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "emitter is null");
  pbf_status status = pbf_struct_check_size(&pbf_kind_emitter, struct_size);
  if (status == PBF_OK) status = pbf_check_count(&counts[0], "emitter", &initial);
  if (status == PBF_OK) pbf_struct_out(&pbf_kind_emitter, &initial, emitter, struct_size);
  return status;
}
