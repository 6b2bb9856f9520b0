/* Creation of a solver, with the best backend that works. */
#include "create.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "backend_call.h"
#include "callbacks.h"
#include "error.h"
#include "handles.h"
#include "lock.h"
#include "memory.h"
#include "params.h"
#include "plugin/select.h"
#include "structs.h"
#include "text.h"
#include "os.h"

/* Without a valid table nothing can free what a faulty plugin may have created. */
static pbf_status check_created(const pbf_plugin *plugin, const pbf_backend_api *table,
                                pbf_solver *solver, char *why, size_t size) {
  char reason[256] = "it gave no solver";
  pbf_status status = PBF_ERROR_PLUGIN;
  if (solver->backend) status = pbf_plugin_copy_table(table, &solver->api, reason, sizeof reason);
  solver->plugin = plugin;
  if (status != PBF_OK) {
    snprintf(why, size, "the backend \"%s\" says that it has created a solver, yet %s",
             plugin->name, reason);
  }
  return status;
}

/* Of a thread, or of a GPU, which is some three hundred times as fast. */
static void find_work_at_once(pbf_solver *solver) {
  const double one_thread = 4e5, gpu = 300;
  pbf_backend_state state = {.struct_size = sizeof state, .threads = 1};
  const pbf_status status = solver->api.describe(solver->backend, &state);
  solver->on_device = status == PBF_OK && state.device_type == PBF_DEVICE_CUDA;
  solver->work_at_once = one_thread;
  if (status != PBF_OK) return;
  solver->work_at_once *= solver->on_device ? gpu : state.threads > 1 ? state.threads : 1;
}

static int works_on_ranks(const pbf_plugin *plugin) {
  return plugin->api.get_extension && plugin->api.get_extension(PBF_BACKEND_RANKS);
}

static pbf_status create_with(const pbf_plugin *plugin, pbf_solver *solver,
                              const pbf_checked_desc *checked, char *why, size_t size) {
  const pbf_desc *desc = &checked->desc;
  if (solver->ranks.count && !works_on_ranks(plugin)) {
    snprintf(why, size, "the backend \"%s\" does not work on ranks; \"serial\" and \"cuda\" do",
             plugin->name);
    return PBF_ERROR_UNSUPPORTED;
  }
  const pbf_backend_desc backend_desc = {
      .struct_size = sizeof backend_desc,
      .dimension = desc->dimension,
      .precision = desc->precision,
      .capacity = desc->capacity,
      .device = desc->device,
      .threads = desc->threads,
      .stream = desc->stream,
      .allocator = solver->allocator,
      .log = solver->log,
      .log_user = solver->log_user,
      .host = &pbf_plugin_host,
      .isa = pbf_desc_isa(checked, plugin->name),
      .enqueue_task = desc->enqueue_task,
      .finish_task = desc->finish_task,
      .task_user = desc->task_user,
      .worlds = checked->worlds,
      .determinism = desc->determinism,
      .ranks = solver->ranks.count ? &solver->ranks : NULL,
  };
  pbf_params params = pbf_params_for_backend(&solver->params, desc->dimension);
  const pbf_backend_api *table = NULL;
  solver->backend = NULL;
  solver->device = desc->device;
  pbf_plugin_message_clear();
  pbf_status status = plugin->api.create(&backend_desc, &params, &solver->backend, &table);
  if (status != PBF_OK) return pbf_backend_check_status(plugin, status, "create", why, size);
  status = check_created(plugin, table, solver, why, size);
  if (status == PBF_OK) find_work_at_once(solver);
  return status;
}

static void note_fallback(pbf_solver *solver, const pbf_candidates *candidates, const char *asked) {
  const char *reason = candidates->reason;
  if (!reason[0]) return;
  solver->fell_back = candidates->named && strcmp(solver->plugin->name, asked) != 0;
  pbf_text_append(solver->fallback_reason, sizeof solver->fallback_reason, reason);
}

/* A call of its own, in which the caller's function may destroy the solver, or never return. */
static void warn_of_fallback(pbf_solver *solver) {
  char message[PBF_MESSAGE_SIZE];
  if (!solver->fallback_reason[0] || pbf_enter(solver) != PBF_OK) return;
  pbf_text_write(message, sizeof message, "the backend \"%s\" serves instead of another: %s",
                 solver->plugin->name, solver->fallback_reason);
  solver->log(solver->log_user, PBF_LOG_WARNING, message);
  pbf_leave(solver, PBF_OK);
}

/* Creates the best one that works; fails with the message of the first when none does. */
static pbf_status create_backend(pbf_solver *solver, const pbf_checked_desc *checked) {
  pbf_candidates candidates;
  pbf_status status = pbf_select(checked, &candidates);
  if (status != PBF_OK) return status;
  char first_why[PBF_MESSAGE_SIZE] = "";
  pbf_status first = PBF_OK;
  for (uint32_t i = 0; i < candidates.count; ++i) {
    const pbf_plugin *plugin = candidates.plugins[i];
    char why[PBF_MESSAGE_SIZE] = "";
    const pbf_checked_desc its = pbf_desc_for(checked, plugin);
    status = create_with(plugin, solver, &its, why, sizeof why);
    if (status == PBF_OK) {
      note_fallback(solver, &candidates, checked->backend);
      return PBF_OK;
    }
    pbf_candidates_add_reason(&candidates, plugin->name, why);
    if (first == PBF_OK) {
      first = status;
      memcpy(first_why, why, sizeof why);
    }
  }
  return pbf_fail(first, "%s", first_why);
}

static pbf_status fill(pbf_solver *solver, const pbf_checked_desc *checked,
                       const pbf_params *params, const pbf_ranks *ranks) {
  const pbf_desc *desc = &checked->desc;
  memset(solver, 0, sizeof *solver);
  solver->ranks = *ranks;
  pbf_callbacks_wrap(solver, &checked->allocator, desc->log, desc->log_user);
  solver->kind = (pbf_check_kind){desc->dimension, desc->precision};
  solver->capacity = desc->capacity;
  solver->params = *params;
  solver->time_step_there = params->time_step;
  const pbf_status status = create_backend(solver, checked);
  solver->ranks.shares = NULL;
  return status;
}

static pbf_status check_params(const pbf_params *theirs, const pbf_checked_desc *checked,
                               pbf_params *params) {
  pbf_status status =
      theirs ? pbf_params_in(theirs, params) : pbf_params_init(params, sizeof *params);
  if (status != PBF_OK) return status;
  pbf_check_kind kind = {checked->desc.dimension, checked->desc.precision};
  return pbf_params_check(params, kind, 0);
}

/* Checks all members; the sentence is about the first that is wrong. */
static pbf_status check_ranks(const pbf_ranks *ranks) {
  char number[PBF_NUMBER_SIZE];
  if (ranks->count < 1 || ranks->count > PBF_MAX_RANKS)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "ranks->count is %u; it must be 1 … %u",
                    ranks->count, PBF_MAX_RANKS);
  if (ranks->rank >= ranks->count)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "ranks->rank is %u; it must be below ranks->count, %u", ranks->rank,
                    ranks->count);
  if (ranks->local_capacity > PBF_MAX_CAPACITY)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "ranks->local_capacity is %u; it must be 0 … %u",
                    ranks->local_capacity, PBF_MAX_CAPACITY);
  if (!ranks->all_gather || !ranks->sum || !ranks->exchange || !ranks->reason ||
      !ranks->begin_exchange != !ranks->end_exchange)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "a function of ranks is null; all are needed but release and, both or "
                    "neither, begin_exchange and end_exchange");
  if (ranks->host_staged > 1 || ranks->reserved)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "ranks->%s is %u; it must be 0%s",
                    ranks->reserved ? "reserved" : "host_staged",
                    ranks->reserved ? ranks->reserved : ranks->host_staged,
                    ranks->reserved ? "" : " or 1");
  for (uint32_t k = 0; k < ranks->count && ranks->shares; ++k)
    if (!(ranks->shares[k] > 0 && isfinite(ranks->shares[k])))
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "ranks->shares[%u] is %s; it must be above 0 and finite", k,
                      pbf_text_number(number, ranks->shares[k]));
  return PBF_OK;
}

/* Null: there are none. */
static pbf_status take_ranks(const pbf_ranks *theirs, pbf_ranks *ranks) {
  memset(ranks, 0, sizeof *ranks);
  const pbf_status status = theirs ? pbf_struct_in(&pbf_kind_ranks, theirs, ranks) : PBF_OK;
  return status == PBF_OK && theirs ? check_ranks(ranks) : status;
}

static pbf_status create(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                         const pbf_ranks *their_ranks, pbf_solver **solver) {
  pbf_checked_desc checked;
  pbf_params ours;
  pbf_ranks ranks;
  void *memory;
  pbf_status status = take_ranks(their_ranks, &ranks);
  if (status == PBF_OK) status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_desc_check(desc, &checked);
  checked.worlds = worlds;
  if (status == PBF_OK) status = check_params(params, &checked, &ours);
  if (status == PBF_OK)
    status = pbf_memory_allocate(&checked.allocator, sizeof(pbf_solver), "a solver", &memory);
  if (status != PBF_OK) return status;
  status = fill(memory, &checked, &ours, &ranks);
  if (status != PBF_OK) {
    pbf_memory_free(&checked.allocator, memory, sizeof(pbf_solver));
    return status;
  }
  pbf_solver_publish(memory);
  *solver = memory;
  warn_of_fallback(memory);
  return PBF_OK;
}

static pbf_status create_checked(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                                 const pbf_ranks *ranks, pbf_solver **solver) {
  if (!desc) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "desc is null; pbf_desc_init fills one");
  if (!solver)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "solver is null; it receives the new one");
  const int cancellation = pbf_uncancelled_begin();
  pbf_fp_environment callers = pbf_fp_begin();
  pbf_status status = create(desc, params, worlds, ranks, solver);
  pbf_fp_end(callers);
  pbf_uncancelled_end(cancellation);
  return status;
}

pbf_status pbf_create(const pbf_desc *desc, const pbf_params *params, pbf_solver **solver) {
  return create_checked(desc, params, 0, NULL, solver);
}

pbf_status pbf_create_world(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                            pbf_solver **solver) {
  return create_checked(desc, params, worlds, NULL, solver);
}

pbf_status pbf_create_on_ranks(const pbf_desc *desc, const pbf_params *params,
                               const pbf_ranks *ranks, pbf_solver **solver) {
  if (!ranks)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "ranks is null; pbf_create makes one alone");
  return create_checked(desc, params, 0, ranks, solver);
}
