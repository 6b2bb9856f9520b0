/* The functions of pbf_ranks over an MPI communicator. */
#ifndef PBF_MPI_LINK_H
#define PBF_MPI_LINK_H

#include <pbf/mpi.h>

typedef struct pbf_mpi_link pbf_mpi_link;

/* Null when there is no memory, or the communicator can't be duplicated within the time; `why` gets
 * the reason. */
pbf_mpi_link *pbf_mpi_link_create(MPI_Comm comm, double timeout, char *why, size_t size);

/* Also what pbf_destroy calls. */
void pbf_mpi_link_free(void *link);

/* Everything but local_capacity and shares. */
pbf_ranks pbf_mpi_link_ranks(pbf_mpi_link *link);

#endif
