/* What a caller of pbf_mpi_create gives: copied, and checked as far as libpbf does not. */
#ifndef PBF_MPI_GIVEN_H
#define PBF_MPI_GIVEN_H

#include <pbf/mpi.h>

typedef struct pbf_mpi_given {
  pbf_mpi_options options; /* the defaults where they are wrong */
  pbf_desc desc;
} pbf_mpi_given;

/* Whether ranks can be joined at all: without, there are none to tell what is wrong. */
pbf_status pbf_mpi_check_comm(MPI_Comm comm);

pbf_status pbf_mpi_take(const pbf_mpi_options *options, const pbf_desc *desc, pbf_solver **solver,
                        pbf_mpi_given *given);

#endif
