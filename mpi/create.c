/* pbf_mpi_create: on all ranks or on none. */
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "link.h"

static _Thread_local char last_error[512];

const char *pbf_mpi_last_error(void) { return last_error; }

__attribute__((format(printf, 2, 3))) static pbf_status fail(pbf_status status, const char *format,
                                                             ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(last_error, sizeof last_error, format, arguments);
  va_end(arguments);
  return status;
}

/* Of callers that know of no staging. */
static const uint32_t size_without_staging = offsetof(pbf_mpi_options, host_staged);

static pbf_status check_size(const char *name, uint32_t struct_size) {
  if (struct_size == sizeof(pbf_mpi_options) || struct_size == size_without_staging) return PBF_OK;
  return fail(PBF_ERROR_STRUCT_SIZE, "%sstruct_size is %u; it must be %u", name, struct_size,
              (uint32_t)sizeof(pbf_mpi_options));
}

pbf_status pbf_mpi_options_init(pbf_mpi_options *options, uint32_t struct_size) {
  const pbf_mpi_options defaults = {.struct_size = struct_size, .timeout = 60};
  if (!options) return fail(PBF_ERROR_INVALID_ARGUMENT, "options is null");
  const pbf_status status = check_size("", struct_size);
  if (status == PBF_OK) memcpy(options, &defaults, struct_size);
  return status;
}

/* What the caller says, or the defaults. */
static pbf_status take_options(const pbf_mpi_options *theirs, pbf_mpi_options *options) {
  pbf_mpi_options_init(options, sizeof *options);
  if (!theirs) return PBF_OK;
  const pbf_status status = check_size("options->", theirs->struct_size);
  if (status == PBF_OK) memcpy(options, theirs, theirs->struct_size);
  return status;
}

static pbf_status check(const pbf_mpi_options *options, const pbf_desc *desc, pbf_solver **solver) {
  int begun = 0, ended = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&ended);
  if (!begun || ended)
    return fail(PBF_ERROR_STATE, "MPI is not running; MPI_Init_thread comes first");
  if (!desc || !solver)
    return fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", desc ? "solver" : "desc");
  if (!(options->timeout > 0 && isfinite(options->timeout)))
    return fail(PBF_ERROR_INVALID_ARGUMENT, "options->timeout is %g; it must be above 0 and finite",
                options->timeout);
  return PBF_OK;
}

/* What a rank has room for where the caller does not say: a quarter more than its share, and two
 * layers of a cube of all particles, each 4 spacings thick. */
static uint32_t default_room(uint32_t capacity, uint32_t ranks) {
  const double all = capacity, room = 1.25 * all / ranks + 8 * pow(all, 2.0 / 3) + 1024;
  return room < all ? (uint32_t)room : capacity;
}

/* What ranks tell each other of their solvers. */
typedef struct created {
  pbf_status status;
  char why[256];
  char build_id[96];
  char variant[64];
  uint32_t capacity, local_capacity;
} created;

static created describe(pbf_solver *solver, pbf_status status, uint32_t capacity,
                        uint32_t local_capacity) {
  created c = {.status = status, .capacity = capacity, .local_capacity = local_capacity};
  pbf_info info = {.struct_size = sizeof info};
  pbf_plan plan = {.struct_size = sizeof plan};
  if (status != PBF_OK) {
    snprintf(c.why, sizeof c.why, "%s", pbf_last_error());
    return c;
  }
  if (pbf_get_info(solver, &info) == PBF_OK) memcpy(c.build_id, info.build_id, sizeof c.build_id);
  if (pbf_get_plan(solver, &plan) == PBF_OK) memcpy(c.variant, plan.variant, sizeof c.variant);
  return c;
}

static pbf_status compare(const created *all, uint32_t count) {
  for (uint32_t r = 0; r < count; ++r)
    if (all[r].status != PBF_OK)
      return fail(all[r].status, "rank %u of %u: %s", r, count, all[r].why);
  for (uint32_t r = 1; r < count; ++r) {
    if (strcmp(all[0].build_id, all[r].build_id))
      return fail(PBF_ERROR_INVALID_ARGUMENT,
                  "ranks 0 and %u have other builds, \"%s\" and \"%s\", which give other bits", r,
                  all[0].build_id, all[r].build_id);
    if (strcmp(all[0].variant, all[r].variant))
      return fail(PBF_ERROR_INVALID_ARGUMENT,
                  "ranks 0 and %u run other loops, \"%s\" and \"%s\", which give other bits; "
                  "desc.isa can say which",
                  r, all[0].variant, all[r].variant);
    if (all[0].capacity != all[r].capacity || all[0].local_capacity != all[r].local_capacity)
      return fail(
          PBF_ERROR_INVALID_ARGUMENT,
          "ranks 0 and %u differ in desc.capacity (%u and %u) or local_capacity (%u and %u)", r,
          all[0].capacity, all[r].capacity, all[0].local_capacity, all[r].local_capacity);
  }
  return PBF_OK;
}

/* On all ranks alike. `link` is the solver's where there is one. */
static pbf_status agree(const pbf_ranks *ranks, const created *mine) {
  created *all = malloc(ranks->count * sizeof *all);
  if (!all) return fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for the answers of the ranks");
  pbf_status status = ranks->all_gather(ranks->user, mine, all, sizeof *mine);
  if (status == PBF_OK)
    status = compare(all, ranks->count);
  else
    fail(status, "%s", ranks->reason(ranks->user));
  free(all);
  return status;
}

static pbf_desc for_a_rank(const pbf_desc *theirs) {
  pbf_desc desc;
  memset(&desc, 0, sizeof desc);
  memcpy(&desc, theirs, theirs->struct_size < sizeof desc ? theirs->struct_size : sizeof desc);
  if (!desc.backend || !strcmp(desc.backend, "auto")) desc.backend = "serial";
  desc.strict = 1;
  return desc;
}

pbf_status pbf_mpi_create(MPI_Comm comm, const pbf_mpi_options *theirs, const pbf_desc *desc,
                          const pbf_params *params, pbf_solver **solver) {
  pbf_mpi_options options;
  pbf_solver *made = NULL;
  char why[200];
  pbf_status status = take_options(theirs, &options);
  if (status == PBF_OK) status = check(&options, desc, solver);
  if (status != PBF_OK) return status;
  pbf_mpi_link *link = pbf_mpi_link_create(comm, options.timeout, why, sizeof why);
  if (!link) return fail(PBF_ERROR_UNAVAILABLE, "%s", why);
  pbf_ranks ranks = pbf_mpi_link_ranks(link);
  const pbf_desc its = for_a_rank(desc);
  ranks.local_capacity =
      options.local_capacity ? options.local_capacity : default_room(its.capacity, ranks.count);
  ranks.shares = options.shares;
  ranks.host_staged = options.host_staged;
  status = pbf_create_on_ranks(&its, params, &ranks, &made);
  const created mine = describe(made, status, its.capacity, ranks.local_capacity);
  status = agree(&ranks, &mine);
  if (status == PBF_OK) {
    *solver = made;
  } else if (made) {
    pbf_destroy(made);
  } else {
    pbf_mpi_link_free(link);
  }
  return status;
}
