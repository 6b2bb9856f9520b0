/* pbf_mpi: one scene on the ranks of an MPI communicator, which may be on many machines. A solver
 * that pbf_mpi_create has made is used by the calls of pbf.h, made by all ranks alike (ranks.h says
 * which), and gives the same bits on any number of ranks, one included.
 *
 * Link pbf_mpi and pbf; libpbf itself needs no MPI. MPI is the caller's to begin and end. Steps of
 * pbf_begin_step run in another thread, which wants MPI_THREAD_SERIALIZED at least.
 */
#ifndef PBF_MPI_H
#define PBF_MPI_H

#include <mpi.h>

#include <pbf/ranks.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pbf_mpi_options {
  uint32_t struct_size;
  uint32_t local_capacity; /* particles that a rank has room for, copies of its neighbours'
                              included; 0: a quarter more than an equal share of desc.capacity,
                              and what lies near the ends of it in a cube. On all ranks the same */
  double timeout;          /* seconds after which a rank that has not answered counts as gone; 60 */
  const double *shares;    /* as in pbf_ranks; null: by measured time */
  uint32_t host_staged;    /* as in pbf_ranks. What comes from here on may be missing: struct_size */
  uint32_t reserved;
} pbf_mpi_options;

/* Fills *options with the defaults. */
PBF_API pbf_status pbf_mpi_options_init(pbf_mpi_options *options, uint32_t struct_size);

/* pbf_create on all ranks of `comm`, each of which calls it with the same description and
 * parameters; `options` null: the defaults. A null desc->backend, or "auto", is "serial" here, and
 * one by name is strict. It succeeds on all ranks or fails on all, which are then told of the first
 * that could not, or in what ranks differ. The communicator is duplicated;
 * MPI_COMM_NULL, and one between two groups, are refused.
 *
 * When a rank is gone, or stands still, each call that needs it returns PBF_ERROR_UNAVAILABLE after
 * the timeout, with a sentence. MPI is then in no state to go on: MPI_Abort ends the program; a
 * saved state goes on with the same bits, on any number of ranks. */
PBF_API pbf_status pbf_mpi_create(MPI_Comm comm, const pbf_mpi_options *options,
                                  const pbf_desc *desc, const pbf_params *params,
                                  pbf_solver **solver);

/* The sentence for the last failure of pbf_mpi_create in this thread; never null. What other calls
 * say has pbf_last_error. */
PBF_API const char *pbf_mpi_last_error(void);

#ifdef __cplusplus
}
#endif

#endif
