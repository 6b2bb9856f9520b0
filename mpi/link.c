#include "link.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>

#include "sentence.h"

struct pbf_mpi_link {
  MPI_Comm comm;
  int rank, count;
  double timeout;
  int lost; /* 1: an operation has not ended; none may be begun after it */
  MPI_Request *requests;
  int request_count, request_room;
  char reason[200 + MPI_MAX_ERROR_STRING];
};

/* A message of MPI has an int of bytes: larger ones go in parts. */
static const uint64_t largest_part = UINT64_C(1) << 30;

enum { TAG = 1, TRIES_BEFORE_YIELD = 200 };

static pbf_status fail(pbf_mpi_link *link, const char *call, int code) {
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  link->lost = 1;
  MPI_Error_string(code, text, &length);
  snprintf(link->reason, sizeof link->reason, "%s failed: %.*s", call, length, text);
  return PBF_ERROR_UNAVAILABLE;
}

/* Until all requests have ended, or there is no time left. A processor that others want is
 * theirs. */
static pbf_status wait_for(pbf_mpi_link *link, int count, MPI_Request *requests) {
  const double end = MPI_Wtime() + link->timeout;
  for (int tries = 0, done = 0; !done; ++tries) {
    int code = MPI_Testall(count, requests, &done, MPI_STATUSES_IGNORE);
    if (code != MPI_SUCCESS) return fail(link, "MPI_Testall", code);
    if (done) break;
    if (tries < TRIES_BEFORE_YIELD) continue;
    sched_yield();
    if (MPI_Wtime() < end) continue;
    link->lost = 1;
    pbf_mpi_write(link->reason, sizeof link->reason,
             "another rank has not answered for %g s: it is gone, stands still, or makes other "
             "calls than rank %d",
             link->timeout, link->rank);
    return PBF_ERROR_UNAVAILABLE;
  }
  return PBF_OK;
}

static pbf_status check(pbf_mpi_link *link) {
  int level, is_main, ended = 0;
  if (link->lost) return PBF_ERROR_UNAVAILABLE;
  MPI_Finalized(&ended);
  if (ended) {
    link->lost = 1;
    snprintf(link->reason, sizeof link->reason,
             "MPI has ended; what solvers on ranks are to do comes before MPI_Finalize");
    return PBF_ERROR_UNAVAILABLE;
  }
  MPI_Query_thread(&level);
  MPI_Is_thread_main(&is_main);
  if (is_main || level >= MPI_THREAD_SERIALIZED) return PBF_OK;
  link->lost = 1;
  snprintf(link->reason, sizeof link->reason,
           "a thread other than that of MPI_Init needs MPI_Init_thread with MPI_THREAD_SERIALIZED");
  return PBF_ERROR_UNAVAILABLE;
}

static pbf_status all_gather(void *user, const void *mine, void *all, uint64_t bytes) {
  pbf_mpi_link *link = user;
  MPI_Request request;
  pbf_status status = check(link);
  if (status != PBF_OK) return status;
  int code =
      MPI_Iallgather(mine, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE, link->comm, &request);
  return code == MPI_SUCCESS ? wait_for(link, 1, &request) : fail(link, "MPI_Iallgather", code);
}

static pbf_status sum(void *user, uint32_t *values, uint64_t count) {
  pbf_mpi_link *link = user;
  MPI_Request request;
  pbf_status status = check(link);
  if (status != PBF_OK) return status;
  int code =
      MPI_Iallreduce(MPI_IN_PLACE, values, (int)count, MPI_UINT32_T, MPI_SUM, link->comm, &request);
  return code == MPI_SUCCESS ? wait_for(link, 1, &request) : fail(link, "MPI_Iallreduce", code);
}

static int parts_of(uint32_t count, const pbf_rank_message *messages) {
  uint64_t parts = 0;
  for (uint32_t k = 0; k < count; ++k) parts += (messages[k].bytes - 1) / largest_part + 1;
  return (int)parts;
}

static int keep_room(pbf_mpi_link *link, int count) {
  if (count <= link->request_room) return 1;
  MPI_Request *more = realloc(link->requests, (size_t)count * sizeof *more);
  if (!more) return 0;
  link->requests = more;
  link->request_room = count;
  return 1;
}

static int begin(pbf_mpi_link *link, const pbf_rank_message *message, int sends) {
  char *data = message->data;
  int code = MPI_SUCCESS, rank = (int)message->rank;
  for (uint64_t left = message->bytes; left > 0 && code == MPI_SUCCESS;) {
    const uint64_t part = left < largest_part ? left : largest_part;
    MPI_Request *request = &link->requests[link->request_count++];
    code = sends ? MPI_Isend(data, (int)part, MPI_BYTE, rank, TAG, link->comm, request)
                 : MPI_Irecv(data, (int)part, MPI_BYTE, rank, TAG, link->comm, request);
    data += part;
    left -= part;
  }
  return code;
}

static pbf_status begin_exchange(void *user, uint32_t send_count, const pbf_rank_message *sends,
                                 uint32_t receive_count, const pbf_rank_message *receives) {
  pbf_mpi_link *link = user;
  pbf_status status = check(link);
  if (status != PBF_OK) return status;
  if (!keep_room(link, parts_of(send_count, sends) + parts_of(receive_count, receives))) {
    link->lost = 1;
    snprintf(link->reason, sizeof link->reason, "no memory for the requests of messages");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  int code = MPI_SUCCESS;
  link->request_count = 0;
  for (uint32_t k = 0; k < receive_count && code == MPI_SUCCESS; ++k)
    code = begin(link, &receives[k], 0);
  for (uint32_t k = 0; k < send_count && code == MPI_SUCCESS; ++k) code = begin(link, &sends[k], 1);
  return code == MPI_SUCCESS ? PBF_OK : fail(link, "a message of MPI", code);
}

static pbf_status end_exchange(void *user) {
  pbf_mpi_link *link = user;
  pbf_status status = check(link);
  return status == PBF_OK ? wait_for(link, link->request_count, link->requests) : status;
}

static pbf_status exchange(void *user, uint32_t send_count, const pbf_rank_message *sends,
                           uint32_t receive_count, const pbf_rank_message *receives) {
  pbf_status status = begin_exchange(user, send_count, sends, receive_count, receives);
  return status == PBF_OK ? end_exchange(user) : status;
}

static const char *reason(void *user) { return ((pbf_mpi_link *)user)->reason; }

/* What fails is told, and not what the caller's communicator does with errors, which is to end the
 * program unless it was given a handler of them. */
static int duplicate(MPI_Comm comm, MPI_Comm *copy, MPI_Request *request) {
  MPI_Errhandler theirs;
  int code = MPI_Comm_get_errhandler(comm, &theirs);
  if (code != MPI_SUCCESS) return code;
  MPI_Comm_set_errhandler(comm, MPI_ERRORS_RETURN);
  code = MPI_Comm_idup(comm, copy, request);
  MPI_Comm_set_errhandler(comm, theirs);
  MPI_Errhandler_free(&theirs);
  return code;
}

pbf_mpi_link *pbf_mpi_link_create(MPI_Comm comm, double timeout, char *why, size_t size) {
  pbf_mpi_link *link = calloc(1, sizeof *link);
  MPI_Request request;
  if (!link) {
    snprintf(why, size, "no memory for what joins the ranks");
    return NULL;
  }
  link->timeout = timeout;
  MPI_Comm_rank(comm, &link->rank);
  MPI_Comm_size(comm, &link->count);
  int code = duplicate(comm, &link->comm, &request);
  pbf_status status =
      code == MPI_SUCCESS ? wait_for(link, 1, &request) : fail(link, "MPI_Comm_idup", code);
  if (status != PBF_OK) {
    snprintf(why, size, "%s", link->reason);
    free(link);
    return NULL;
  }
  MPI_Comm_set_errhandler(link->comm, MPI_ERRORS_RETURN);
  return link;
}

/* A communicator in which something is still on its way is left to MPI_Abort. */
void pbf_mpi_link_free(void *user) {
  pbf_mpi_link *link = user;
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (!link->lost && !finalized) MPI_Comm_free(&link->comm);
  if (!link->lost) free(link->requests);
  free(link);
}

pbf_ranks pbf_mpi_link_ranks(pbf_mpi_link *link) {
  return (pbf_ranks){.struct_size = sizeof(pbf_ranks),
                     .rank = (uint32_t)link->rank,
                     .count = (uint32_t)link->count,
                     .user = link,
                     .all_gather = all_gather,
                     .sum = sum,
                     .exchange = exchange,
                     .reason = reason,
                     .release = pbf_mpi_link_free,
                     .begin_exchange = begin_exchange,
                     .end_exchange = end_exchange};
}
