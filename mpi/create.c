/* pbf_mpi_create: on all ranks or on none. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "given.h"
#include "link.h"
#include "sentence.h"

/* What a rank has room for where the caller does not say: a quarter more than its share, and two
 * layers of a cube of all particles, each 4 spacings thick. */
static uint32_t default_room(uint32_t capacity, uint32_t ranks) {
  const double all = capacity, room = 1.25 * all / ranks + 8 * pow(all, 2.0 / 3) + 1024;
  return room < all ? (uint32_t)room : capacity;
}

/* What ranks tell each other of their solvers. */
typedef struct created {
  pbf_status status;
  char why[PBF_MPI_SENTENCE_SIZE];
  char build_id[96];
  char variant[64];
  uint32_t capacity, local_capacity;
} created;

static created describe(pbf_solver *solver, pbf_status status, const char *why, uint32_t capacity,
                        uint32_t local_capacity) {
  created c = {.status = status, .capacity = capacity, .local_capacity = local_capacity};
  pbf_info info = {.struct_size = sizeof info};
  pbf_plan plan = {.struct_size = sizeof plan};
  if (status != PBF_OK) {
    snprintf(c.why, sizeof c.why, "%s", why);
    return c;
  }
  if (pbf_get_info(solver, &info) == PBF_OK) memcpy(c.build_id, info.build_id, sizeof c.build_id);
  if (pbf_get_plan(solver, &plan) == PBF_OK) memcpy(c.variant, plan.variant, sizeof c.variant);
  return c;
}

static pbf_status compare(const created *all, uint32_t count) {
  for (uint32_t r = 0; r < count; ++r)
    if (all[r].status != PBF_OK)
      return pbf_mpi_fail(all[r].status, "rank %u of %u: %s", r, count, all[r].why);
  for (uint32_t r = 1; r < count; ++r) {
    if (strcmp(all[0].build_id, all[r].build_id))
      return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "ranks 0 and %u have other builds, \"%s\" and \"%s\", which give other bits", r,
                  all[0].build_id, all[r].build_id);
    if (strcmp(all[0].variant, all[r].variant))
      return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "ranks 0 and %u run other loops, \"%s\" and \"%s\", which give other bits; "
                  "desc.isa can say which",
                  r, all[0].variant, all[r].variant);
    if (all[0].capacity != all[r].capacity || all[0].local_capacity != all[r].local_capacity)
      return pbf_mpi_fail(
          PBF_ERROR_INVALID_ARGUMENT,
          "ranks 0 and %u differ in desc.capacity (%u and %u) or local_capacity (%u and %u)", r,
          all[0].capacity, all[r].capacity, all[0].local_capacity, all[r].local_capacity);
  }
  return PBF_OK;
}

/* On all ranks alike. `link` is the solver's where there is one. */
static pbf_status agree(const pbf_ranks *ranks, const created *mine) {
  created *all = malloc(ranks->count * sizeof *all);
  if (!all) return pbf_mpi_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for the answers of the ranks");
  pbf_status status = ranks->all_gather(ranks->user, mine, all, sizeof *mine);
  if (status == PBF_OK)
    status = compare(all, ranks->count);
  else
    pbf_mpi_fail(status, "%s", ranks->reason(ranks->user));
  free(all);
  return status;
}

/* What is wrong on one rank is told to all, once they are joined. */
pbf_status pbf_mpi_create(MPI_Comm comm, const pbf_mpi_options *options, const pbf_desc *desc,
                          const pbf_params *params, pbf_solver **solver) {
  pbf_mpi_given given;
  pbf_solver *made = NULL;
  char why[PBF_MPI_SENTENCE_SIZE];
  pbf_status status = pbf_mpi_check_comm(comm);
  if (status != PBF_OK) return status;
  status = pbf_mpi_take(options, desc, solver, &given);
  const char *mistake = pbf_mpi_last_error();
  pbf_mpi_link *link = pbf_mpi_link_create(comm, given.options.timeout, why, sizeof why);
  if (!link) return status == PBF_OK ? pbf_mpi_fail(PBF_ERROR_UNAVAILABLE, "%s", why) : status;
  pbf_ranks ranks = pbf_mpi_link_ranks(link);
  ranks.local_capacity = given.options.local_capacity
                             ? given.options.local_capacity
                             : default_room(given.desc.capacity, ranks.count);
  ranks.shares = given.options.shares;
  ranks.host_staged = given.options.host_staged;
  if (status == PBF_OK) {
    status = pbf_create_on_ranks(&given.desc, params, &ranks, &made);
    mistake = pbf_last_error();
  }
  const created mine = describe(made, status, mistake, given.desc.capacity, ranks.local_capacity);
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
