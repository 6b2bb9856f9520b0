#include "given.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "sentence.h"

pbf_status pbf_mpi_check_comm(MPI_Comm comm) {
  int begun = 0, ended = 0, has_two_groups = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&ended);
  if (!begun || ended)
    return pbf_mpi_fail(PBF_ERROR_STATE, "MPI is not running; MPI_Init_thread comes first");
  if (comm == MPI_COMM_NULL)
    return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT,
                        "comm is MPI_COMM_NULL, which MPI_Comm_split gives to processes without a "
                        "color: those have no rank and make no solver");
  MPI_Comm_test_inter(comm, &has_two_groups);
  if (!has_two_groups) return PBF_OK;
  return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "comm is between two groups; MPI_Intercomm_merge makes one of both");
}

/* ---- Structs ------------------------------------------------------------------------------- */

/* Far above any struct to come: a larger size is uninitialised memory. */
enum { MAX_SIZE = 65536 };

typedef struct kind {
  const char *name;
  uint32_t first_size, size; /* of the first release, and of this one */
} kind;

/* Callers of the first know of no staging. */
static const kind options_kind = {"pbf_mpi_options", offsetof(pbf_mpi_options, host_staged),
                                  sizeof(pbf_mpi_options)};

/* What else is wrong with one libpbf tells. */
static const kind desc_kind = {"pbf_desc", sizeof(uint32_t), sizeof(pbf_desc)};

static pbf_status check_size(const kind *k, uint32_t size) {
  if (size >= k->first_size && size <= MAX_SIZE) return PBF_OK;
  return pbf_mpi_fail(PBF_ERROR_STRUCT_SIZE,
                      "%s.struct_size is %u; it must be sizeof(%s), here %u", k->name, size,
                      k->name, k->size);
}

/* A newer caller's may be larger; what is not known here has to be 0. */
static pbf_status copy_in(const kind *k, const void *theirs, void *ours) {
  const unsigned char *bytes = theirs;
  uint32_t size;
  memcpy(&size, theirs, sizeof size);
  const pbf_status status = check_size(k, size);
  if (status != PBF_OK) return status;
  for (uint32_t i = k->size; i < size; ++i)
    if (bytes[i])
      return pbf_mpi_fail(PBF_ERROR_STRUCT_SIZE,
                          "byte %u of a %s of %u bytes is %u; this library knows the first %u "
                          "bytes only, so the rest must be 0",
                          i, k->name, size, bytes[i], k->size);
  const uint32_t common = size < k->size ? size : k->size;
  memcpy(ours, theirs, common);
  memcpy(ours, &common, sizeof common);
  return PBF_OK;
}

/* ---- Options ------------------------------------------------------------------------------- */

static const pbf_mpi_options defaults = {.struct_size = sizeof defaults, .timeout = 60};

pbf_status pbf_mpi_options_init(pbf_mpi_options *options, uint32_t struct_size) {
  if (!options) return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT, "options is null");
  const pbf_status status = check_size(&options_kind, struct_size);
  if (status != PBF_OK) return status;
  memset(options, 0, struct_size);
  memcpy(options, &defaults, struct_size < sizeof defaults ? struct_size : sizeof defaults);
  options->struct_size = struct_size;
  return PBF_OK;
}

static pbf_status take_options(const pbf_mpi_options *theirs, pbf_mpi_options *options) {
  pbf_mpi_options taken = defaults;
  const pbf_status status = theirs ? copy_in(&options_kind, theirs, &taken) : PBF_OK;
  if (status != PBF_OK) return status;
  if (isnan(taken.timeout) || !(taken.timeout > 0 && isfinite(taken.timeout)))
    return isnan(taken.timeout)
               ? pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT,
                              "options->timeout is NaN; it must be above 0 and finite")
               : pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT,
                              "options->timeout is %.9g; it must be above 0 and finite",
                              taken.timeout);
  if (taken.reserved)
    return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT, "options->reserved is %u; it must be 0",
                        taken.reserved);
  *options = taken;
  return PBF_OK;
}

static pbf_status take_desc(const pbf_desc *theirs, pbf_desc *desc) {
  const pbf_status status = copy_in(&desc_kind, theirs, desc);
  if (!desc->backend || !strcmp(desc->backend, "auto")) desc->backend = "serial";
  desc->strict = 1;
  return status;
}

pbf_status pbf_mpi_take(const pbf_mpi_options *options, const pbf_desc *desc, pbf_solver **solver,
                        pbf_mpi_given *given) {
  memset(given, 0, sizeof *given);
  given->options = defaults;
  if (!desc || !solver)
    return pbf_mpi_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", desc ? "solver" : "desc");
  const pbf_status status = take_options(options, &given->options);
  return status == PBF_OK ? take_desc(desc, &given->desc) : status;
}
