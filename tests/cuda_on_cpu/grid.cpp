/* Runs the threads of a grid: fibers, of which one runs until it waits for others. Without a seed
 * they take turns in their order. */
#include "grid.h"

#include <sched.h>

#include <atomic>
#include <deque>
#include <memory>
#include <vector>

#include "cuda_runtime_api.h"
#include "fiber.h"
#include "settings.h"

__thread uint3 gridDim, blockDim;

namespace emulated {

__thread thread *current;

struct warp {
  thread *lanes;
  uint32_t present; /* lanes that have not ended */
  uint32_t able;    /* lanes that wait for nothing, … */
  uint32_t came;    /* … for others of their warp, … */
  uint32_t asks;    /* … or to know which are active */
};

struct block {
  uint3 index;
  uint32_t rank, present, arrived, votes;
  const char *barrier;
  char *shared;
  std::vector<thread> threads;
  std::vector<warp> warps;
};

namespace {

enum : uint32_t { VARIABLES_BYTES = 64 * 1024, POISON = 0xff };
std::atomic<int> shared_variables;
std::atomic<bool> lost;

struct release {
  void operator()(char *memory) const { free(memory); }
};
typedef std::unique_ptr<char, release> shared_memory;

struct machine {
  const launch_shape *shape;
  thread_function run;
  void *arguments;
  std::deque<block> blocks; /* at the same time; those before `count` */
  uint32_t count;
  std::vector<uint32_t> order; /* of all blocks; those from `next` on have not begun */
  size_t next;
  std::deque<thread *> ready;
  std::vector<thread *> starts; /* those not started yet, the next one last */
  uint32_t remaining, cluster_arrived;
  uint64_t looks; /* since something last happened */
  uint32_t variables_end;
  std::vector<int> variable_places;
  std::vector<shared_memory> shared;
  const char *failure;
  std::vector<fiber *> fibers; /* of this launch's threads */
};
thread_local machine *m;

void fail(const char *why) {
  if (!m->failure) m->failure = why;
}

/* ---- Ready threads ------------------------------------------------------------------------- */

void push_ready(thread *t) { m->ready.push_back(t); }

thread *pop_ready() {
  if (seed()) std::swap(m->ready.front(), m->ready[random_below((uint32_t)m->ready.size())]);
  thread *t = m->ready.front();
  m->ready.pop_front();
  return t;
}

uint32_t bit(const thread *t) { return 1u << t->lane; }

/* It no longer waits. */
void wake(thread *t) {
  m->looks = 0;
  t->waits = WAITS_NOT;
  t->warp->able |= bit(t);
  if (t != current) push_ready(t);
}

/* The lanes of a warp that ask which of them are active, once none of them can come yet. */
void tell_active(warp *w) {
  const uint32_t active = w->asks;
  if (w->able || !active) return;
  w->asks = 0;
  for (uint32_t k = 0; k < 32; ++k)
    if (active >> k & 1) {
      w->lanes[k].mask = active;
      wake(&w->lanes[k]);
    }
}

void wait_as(wait_kind kind, const char *at) {
  current->waits = kind;
  current->at = at;
  current->warp->able &= ~bit(current);
}

/* Until `current` has been woken, unless it has been already. */
void wait() {
  tell_active(current->warp);
  if (current->waits == WAITS_NOT) return;
  switch_to(nullptr);
}

/* ---- Barriers ------------------------------------------------------------------------------ */

void try_block(block *b) {
  if (!b->arrived || b->arrived < b->present) return;
  const int votes = (int)b->votes, all = (int)b->arrived;
  b->arrived = b->votes = 0;
  for (thread &t : b->threads)
    if (t.waits == AT_BLOCK_BARRIER) {
      t.votes = votes;
      t.all = all;
      wake(&t);
    }
}

void try_cluster() {
  if (!m->cluster_arrived || m->cluster_arrived < m->remaining) return;
  m->cluster_arrived = 0;
  for (uint32_t k = 0; k < m->count; ++k)
    for (thread &t : m->blocks[k].threads)
      if (t.waits == AT_CLUSTER_BARRIER) wake(&t);
}

/* Lets the lanes of `mask` go on once all have come to the same. */
void try_lanes(warp *w, uint32_t mask, warp_operation operation) {
  const uint32_t asked = mask & w->present;
  if ((w->came & asked) != asked) return;
  for (uint32_t k = 0; k < 32; ++k) {
    const thread &t = w->lanes[k];
    if (asked >> k & 1 && (t.mask != mask || t.operation != operation)) return;
  }
  w->came &= ~asked;
  gathered all;
  all.lanes = asked;
  for (uint32_t k = 0; k < 32; ++k)
    all.values[k] = asked >> k & 1 ? w->lanes[k].value : ~0ull; /* which nothing may use */
  for (uint32_t k = 0; k < 32; ++k)
    if (asked >> k & 1) {
      if (operation == SYNC_WARP)
        w->lanes[k].result->lanes = asked;
      else
        *w->lanes[k].result = all;
      wake(&w->lanes[k]);
    }
}

/* Those that wait for it alone go on. */
void end_thread(thread *t) {
  warp *w = t->warp;
  m->looks = 0;
  --m->remaining;
  --t->block->present;
  w->present &= ~bit(t);
  w->able &= ~bit(t);
  t->fiber = nullptr;
  current = nullptr;
  for (uint32_t k = 0; w->came && k < 32; ++k)
    if (w->came >> k & 1 && w->lanes[k].mask & bit(t))
      try_lanes(w, w->lanes[k].mask, w->lanes[k].operation);
  tell_active(w);
  try_block(t->block);
  try_cluster();
}

/* ---- Running ------------------------------------------------------------------------------- */

/* Runs threads that have not started, one after another, until one of them waits. */
void run_threads(void *) {
  for (;;) {
    if (m->starts.empty() || m->failure) {
      current = nullptr;
      switch_to(nullptr);
      continue;
    }
    thread *t = m->starts.back();
    m->starts.pop_back();
    current = t;
    t->fiber = present_fiber();
    m->run(m->shape->kernel, m->arguments);
    if (m->shape->early && !t->awaited) fail("a thread of an early launch awaits none before");
    end_thread(t);
    if (seed()) switch_to(nullptr);
  }
}

void begin_block(block *b, uint3 index, uint32_t rank) {
  const dim3 size = m->shape->block;
  const uint32_t threads = size.x * size.y * size.z;
  b->index = index;
  b->rank = rank;
  b->present = threads;
  b->arrived = b->votes = 0;
  b->threads.assign(threads, thread());
  b->warps.resize((threads + 31) / 32);
  for (uint32_t k = 0; k < threads; ++k) {
    thread &t = b->threads[k];
    t.index = {k % size.x, k / size.x % size.y, k / size.x / size.y};
    t.block = b;
    t.warp = &b->warps[k / 32];
    t.linear = k;
    t.lane = k % 32;
  }
  for (uint32_t k = 0; k < b->warps.size(); ++k) {
    const uint32_t lanes = threads - 32 * k;
    b->warps[k] = {&b->threads[32 * k], lanes < 32 ? (1u << lanes) - 1 : ~0u,
                   lanes < 32 ? (1u << lanes) - 1 : ~0u, 0, 0};
  }
  shared_memory &s = m->shared[rank];
  const size_t bytes = VARIABLES_BYTES + SHARED_MOST;
  if (!s) s.reset(static_cast<char *>(aligned_alloc(1024, (bytes + 1023) / 1024 * 1024)));
  b->shared = s.get();
  memset(b->shared, POISON, m->variables_end);
  memset(b->shared + VARIABLES_BYTES, POISON, m->shape->shared);
}

/* One more block beside those that run. */
void add_block() {
  const uint32_t number = m->order[m->next++], rank = m->count++;
  const dim3 grid = m->shape->grid;
  if (m->blocks.size() < m->count) m->blocks.resize(m->count);
  if (m->shared.size() < m->count) m->shared.resize(m->count);
  block *b = &m->blocks[rank];
  begin_block(b, {number % grid.x, number / grid.x % grid.y, number / grid.x / grid.y}, rank);
  m->remaining += b->present;
  m->looks = 0;
  for (uint32_t i = (uint32_t)b->threads.size(); i-- > 0;) m->starts.push_back(&b->threads[i]);
  if (!seed()) return;
  for (size_t k = m->starts.size(); k > 1; --k)
    std::swap(m->starts[k - 1], m->starts[random_below((uint32_t)k)]);
}

void report() {
  fprintf(stderr, "cuda on a CPU: %s: %s\n", m->shape->name, m->failure);
  int told = 0;
  for (uint32_t b = 0; b < m->count; ++b)
    for (const thread &t : m->blocks[b].threads)
      if (t.fiber && told < 20) {
        const char *const kinds[] = {"runs", "waits for its block", "waits for its cluster",
                                     "waits for its warp", "asks which lanes are active"};
        fprintf(stderr, "  block %u, thread %u: %s ", m->blocks[b].rank, t.linear, kinds[t.waits]);
        fprintf(stderr, t.waits == IN_WARP ? "(mask %08x, %s)\n" : "%.0x%s\n",
                t.waits == IN_WARP ? t.mask : 0, t.at && t.waits ? t.at : "");
        ++told;
      }
}

/* A minute without anything but looks: a loop waits for what never comes. */
void look_at_clock(time_t *since) {
  if (m->looks == 0) *since = 0;
  if (++m->looks % 65536) return;
  sched_yield();
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (!*since) *since = now.tv_sec;
  if (now.tv_sec - *since > 90) fail("its threads look for what never comes");
}

void run_present_blocks() {
  std::vector<fiber *> idle;
  time_t since = 0;
  m->ready.clear();
  m->cluster_arrived = 0;
  while (m->remaining && !m->failure) {
    /* Those that run may wait for another device, or for what a block does that has not begun. */
    if (m->starts.empty() && m->looks > 4 * m->ready.size()) {
      if (m->next < m->order.size())
        add_block();
      else if (m->looks % (m->ready.size() + 1) == 0)
        sched_yield();
    }
    const bool starts = !m->starts.empty() && (!seed() || m->ready.empty() || random_below(2));
    if (starts) {
      if (idle.empty()) {
        idle.push_back(new_fiber(run_threads, nullptr));
        m->fibers.push_back(idle.back());
      }
      switch_to(idle.back());
      if (current) idle.pop_back(); /* it waits on that stack */
    } else if (!m->ready.empty()) {
      thread *t = pop_ready();
      fiber *of = static_cast<fiber *>(t->fiber);
      current = t;
      look_at_clock(&since);
      switch_to(of);
      if (!current) idle.push_back(of);
    } else {
      fail("its threads wait for each other for ever");
    }
  }
}

}  // namespace

bool device_is_lost() { return lost; }

uint3 block_index(const block *b) { return b->index; }

void yield() {
  push_ready(current);
  switch_to(nullptr);
}

int block_barrier(const char *name, bool yes, int *all) {
  block *b = current->block;
  if (b->arrived && strcmp(b->barrier, name) != 0)
    fail("threads of a block are at different barriers");
  b->barrier = name;
  ++b->arrived;
  b->votes += yes;
  wait_as(AT_BLOCK_BARRIER, name);
  try_block(b);
  wait();
  if (all) *all = current->all;
  return current->votes;
}

void cluster_barrier() {
  ++m->cluster_arrived;
  wait_as(AT_CLUSTER_BARRIER, "cluster");
  try_cluster();
  wait();
}

void in_warp(warp_operation operation, uint32_t mask, uint64_t value, gathered *result) {
  static const char *const names[] = {"syncwarp", "shuffle", "vote", "match", "reduce"};
  thread *t = current;
  if (!(mask & bit(t))) fail("a lane is not in the mask that it names");
  t->operation = operation;
  t->mask = mask;
  t->value = value;
  t->result = result;
  wait_as(IN_WARP, names[operation]);
  t->warp->came |= bit(t);
  try_lanes(t->warp, mask, operation);
  wait();
}

uint32_t active_mask() {
  wait_as(AT_ACTIVE_MASK, "activemask");
  current->warp->asks |= bit(current);
  wait();
  return current->mask;
}

/* ---- Shared memory ------------------------------------------------------------------------- */

int new_shared_variable() { return shared_variables++; }

/* All blocks of a launch have a variable at the same place. */
void *shared_variable_at(int variable, size_t bytes, size_t align) {
  if ((size_t)variable >= m->variable_places.size()) m->variable_places.resize(variable + 1, -1);
  int &place = m->variable_places[variable];
  if (place < 0) {
    place = (int)((m->variables_end + align - 1) / align * align);
    m->variables_end = place + (uint32_t)bytes;
    if (m->variables_end > SHARED_UNASKED) {
      fprintf(stderr, "cuda on a CPU: %s has too many shared variables\n", m->shape->name);
      abort();
    }
    for (uint32_t k = 0; k < m->count; ++k) memset(m->blocks[k].shared + place, POISON, bytes);
  }
  return current->block->shared + place;
}

void *dynamic_shared() { return current->block->shared + VARIABLES_BYTES; }

uint32_t shared_offset(const void *at) {
  return (uint32_t)(static_cast<const char *>(at) - current->block->shared);
}

void *shared_at(uint32_t offset) { return current->block->shared + offset; }

void *shared_of_block(void *at, uint32_t rank) {
  if (rank >= m->count) {
    fail("a block is asked for that the cluster does not have");
    return at;
  }
  return m->blocks[rank].shared + shared_offset(at);
}

/* ---- A grid -------------------------------------------------------------------------------- */

void run_grid(const launch_shape &shape, thread_function run, void *arguments) {
  static thread_local machine of_this_thread;
  if (lost) return;
  m = &of_this_thread;
  m->shape = &shape;
  m->run = run;
  m->arguments = arguments;
  m->failure = nullptr;
  m->variables_end = 0;
  m->variable_places.assign(m->variable_places.size(), -1);
  gridDim = {shape.grid.x, shape.grid.y, shape.grid.z};
  blockDim = {shape.block.x, shape.block.y, shape.block.z};
  const uint32_t all = shape.grid.x * shape.grid.y * shape.grid.z;
  m->order.resize(all);
  for (uint32_t k = 0; k < all; ++k) m->order[k] = k;
  if (seed() && !shape.together)
    for (uint32_t k = all; k > 1; --k) std::swap(m->order[k - 1], m->order[random_below(k)]);
  m->next = 0;
  while (m->next < all && !m->failure) {
    const uint32_t at_once = shape.together ? all : seed() ? 1 + random_below(4) : 1;
    m->count = m->remaining = 0;
    m->starts.clear();
    while (m->count < at_once && m->next < all) add_block();
    run_present_blocks();
    if (m->failure) report();
    for (fiber *f : m->fibers) free_fiber(f);
    m->fibers.clear();
  }
  current = nullptr;
  if (m->failure) lost = true;
}

}  // namespace emulated
