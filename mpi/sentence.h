/* The sentence for the last failure of pbf_mpi_create, of each thread. */
#ifndef PBF_MPI_SENTENCE_H
#define PBF_MPI_SENTENCE_H

#include <stddef.h>

#include <pbf/base.h>

/* Of a sentence, its end included; as long as libpbf's own may be. */
enum { PBF_MPI_SENTENCE_SIZE = 2048 };

/* Writes it, with a point in its numbers whatever the program's locale writes, and returns the
 * status. */
__attribute__((format(printf, 2, 3))) pbf_status pbf_mpi_fail(pbf_status status, const char *format,
                                                              ...);

/* The same of a text; what has no room ends with a whole character. */
__attribute__((format(printf, 3, 4))) void pbf_mpi_write(char *text, size_t size,
                                                         const char *format, ...);

#endif
