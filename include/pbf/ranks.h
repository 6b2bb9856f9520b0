/* One scene on many ranks, whatever joins them: pbf/mpi.h has it for MPI.
 *
 * Ranks are solvers, in processes or threads of their own, that hold one scene together. Each holds
 * a share of the particles, and copies of those near its own. Each has a thread, or with the
 * backend "cuda" a device: desc.device may differ from rank to rank. Devices that reach each
 * other's memory write into it; what others exchange, as those of two hosts, goes through the
 * memory of their hosts and `exchange`. All make the same calls of pbf.h in the same order and with
 * the same arguments, as a program without ranks would make them, and get the same answers; a call
 * returns when it has been made on all. Bits are those of one solver, however many ranks there are
 * and wherever space is cut.
 *
 * Ranks that make other calls, or with other arguments, are told so by the next call that needs
 * them all, before it changes anything. What a rank only asks of itself needs no others:
 * pbf_get_count, pbf_get_info, pbf_get_plan, pbf_get_ids, pbf_get_collider, pbf_get_share and the
 * like.
 *
 * pbf_cancel, on one rank or on several, ends the call on all after the same step, and so does
 * pbf_destroy of begun steps.
 */
#ifndef PBF_RANKS_H
#define PBF_RANKS_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes to, or from, another rank. Those between two ranks arrive in the order of sending. */
typedef struct pbf_rank_message {
  uint32_t rank;
  uint32_t reserved;
  uint64_t bytes; /* not 0 */
  void *data;
} pbf_rank_message;

/* What a solver needs of the others. The three functions that communicate are called by all ranks
 * in the same order. What they return but PBF_OK, which should come within some time when another
 * rank is gone, is what the solver's call returns, with the sentence that `reason` gives; from then
 * on the solver only returns PBF_ERROR_STATE. */
typedef struct pbf_ranks {
  uint32_t struct_size;
  uint32_t rank;           /* this one, 0 … count - 1 */
  uint32_t count;          /* 1 … PBF_MAX_RANKS */
  uint32_t local_capacity; /* particles that this rank has room for, copies of others' included; 0:
                              pbf_desc.capacity. On all ranks the same */
  void *user;
  /* all[r] = *mine of rank r, `bytes` each. */
  pbf_status (*all_gather)(void *user, const void *mine, void *all, uint64_t bytes);
  /* values[k] = its sum over all ranks. */
  pbf_status (*sum)(void *user, uint32_t *values, uint64_t count);
  /* Returns when what is received has come, and what is sent may be overwritten. */
  pbf_status (*exchange)(void *user, uint32_t send_count, const pbf_rank_message *sends,
                         uint32_t receive_count, const pbf_rank_message *receives);
  const char *(*reason)(void *user); /* of the last failure */
  void (*release)(void *user);       /* by pbf_destroy, last; null: nothing is to be done */
  const double *shares; /* (count), above 0: what part of the particles each rank has; null: by the
                           time that each has needed so far. Copied by pbf_create_on_ranks */
  /* What `exchange` does, in two calls, between which the rank works at what it neither sends nor
   * receives. What `sends` and `receives` point to lasts until the second. Both or neither; null:
   * ranks do not work while they exchange. What comes from here on may be missing: struct_size */
  pbf_status (*begin_exchange)(void *user, uint32_t send_count, const pbf_rank_message *sends,
                               uint32_t receive_count, const pbf_rank_message *receives);
  pbf_status (*end_exchange)(void *user);
  /* With "cuda", 1: what this rank exchanges with others goes through hosts, also where devices
   * reach each other's memory. 0: where they do not. What comes from here on may be missing */
  uint32_t host_staged;
  uint32_t reserved;
} pbf_ranks;

/* Ranks of a solver. */
#define PBF_MAX_RANKS 4096u

/* pbf_create for one of some ranks: `ranks`, which is copied, joins it to the others. Refused, with
 * a sentence, are backends that can't, which are all but `serial` and `cuda`. Views (pbf_map,
 * pbf_export_dlpack) are of a copy of all particles, in the order of adding, on each rank. With
 * `cuda` there are up to 64, and pbf_get_pressures is refused, too. */
PBF_API pbf_status pbf_create_on_ranks(const pbf_desc *desc, const pbf_params *params,
                                       const pbf_ranks *ranks, pbf_solver **solver);

/* Particles of this rank's own share, of which each is in one: what a file for each rank holds. It
 * asks no other rank, and wants no memory for the others' particles. `count` gets how many there
 * are; with `ids`, which has `room` for so many, their ids, ascending, and with `values`, too,
 * their `field`, PBF_FIELD_POSITION or PBF_FIELD_VELOCITY, laid out as by pbf_get_positions. With
 * both null it only counts. Shares change with each step. A solver without ranks has all particles.
 */
PBF_API pbf_status pbf_get_share(pbf_solver *solver, uint32_t field, uint32_t room, uint32_t *count,
                                 uint32_t *ids, void *values);

#ifdef __cplusplus
}
#endif

#endif
