#include "snapshot_memory.h"

#include <string.h>

#include "held_snapshots.h"
#include "lock.h"
#include "memory.h"

static uint64_t rounded(uint64_t bytes) { return (bytes + 63) / 64 * 64; }

static uint64_t field_bytes(const pbf_solver *solver) {
  return rounded(solver->capacity * pbf_point_bytes(solver));
}

static uint64_t id_bytes(const pbf_solver *solver) {
  return rounded((uint64_t)solver->capacity * sizeof(uint32_t));
}

static uint64_t spare_bytes(const pbf_solver *solver) {
  return solver->ranks.count ? field_bytes(solver) : 0;
}

static uint64_t bytes_for(const pbf_solver *solver, uint32_t count) {
  return rounded(sizeof(pbf_snapshots)) + count * (2 * field_bytes(solver) + id_bytes(solver)) +
         spare_bytes(solver);
}

uint64_t pbf_snapshots_bytes(const pbf_solver *solver, const pbf_snapshots *snapshots) {
  return bytes_for(solver, snapshots->count);
}

void pbf_snapshots_forget(const pbf_snapshots *snapshots) {
  if (!snapshots) return;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  for (uint32_t k = 0; k < snapshots->count; ++k) pbf_snapshot_forget(&snapshots->list[k]);
  pbf_lock_release(PBF_LOCK_SOLVERS);
}

void pbf_snapshots_free(const pbf_solver *solver, pbf_snapshots *snapshots) {
  if (!snapshots) return;
  pbf_snapshots_forget(snapshots);
  pbf_memory_free(&solver->allocator, snapshots, pbf_snapshots_bytes(solver, snapshots));
}

pbf_status pbf_snapshots_allocate(pbf_solver *solver, uint32_t count, pbf_snapshots **snapshots) {
  void *memory;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes_for(solver, count), "the snapshots", &memory);
  if (status != PBF_OK) return status;
  pbf_snapshots *all = *snapshots = memory;
  char *next = (char *)memory + rounded(sizeof *all);
  memset(all, 0, sizeof *all);
  all->count = count;
  for (uint32_t k = 0; k < count; ++k) {
    all->list[k].solver = solver;
    all->list[k].positions = next;
    all->list[k].velocities = next + field_bytes(solver);
    all->list[k].ids = (uint32_t *)(void *)(next + 2 * field_bytes(solver));
    next += 2 * field_bytes(solver) + id_bytes(solver);
  }
  all->spare = spare_bytes(solver) ? next : NULL;
  return PBF_OK;
}
