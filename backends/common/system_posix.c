/* Linux, and what else has threads by POSIX. */
#define _GNU_SOURCE /* secure_getenv, sched_getaffinity, syscall */
#include "common/system.h"

#include "common/at_load.h"
#include "common/module.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#if defined(__linux__)
#include <sys/syscall.h>
#endif

const char *pbf_environment(const char *name) {
#if defined(__linux__)
  return secure_getenv(name);
#elif defined(__APPLE__)
  return issetugid() ? NULL : getenv(name);
#else
  return getenv(name);
#endif
}

static double seconds_of(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double pbf_seconds(void) { return seconds_of(CLOCK_MONOTONIC); }
double pbf_thread_seconds(void) { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

uint32_t pbf_processors(void) {
#if defined(__linux__)
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
    return (uint32_t)CPU_COUNT(&set);
#endif
  const long online = sysconf(_SC_NPROCESSORS_ONLN);
  return online < 1 ? 1 : (uint32_t)online;
}

/* ---- Processes ------------------------------------------------------------------------------ */

/* Two processes may have the same number: in namespaces of their own, or once it is free again. So
 * those that are seen to come of each other are counted. */
static uint32_t process_last_told, processes;

/* One thread notes what the others see, too. */
static void note_process(uint32_t told, uint32_t now) {
  if (__atomic_compare_exchange_n(&process_last_told, &told, now, 0, __ATOMIC_RELAXED,
                                  __ATOMIC_RELAXED))
    __atomic_fetch_add(&processes, 1, __ATOMIC_RELAXED);
}

int pbf_process_is_told(void) {
  const pid_t now = getpid();
  const uint32_t told = __atomic_load_n(&process_last_told, __ATOMIC_RELAXED);
  if (now > 0 && (uint32_t)now != told) note_process(told, (uint32_t)now);
  return now > 0;
}

static void become_another(void) {
  __atomic_fetch_add(&processes, 1, __ATOMIC_RELAXED);
  pbf_process_is_told();
}

/* What begins earlier may have asked already. */
PBF_CONSTRUCTOR static void begin_to_ask(void) {
  if (!pbf_process_is_told() && processes == 0) processes = 1;
  pthread_atfork(NULL, NULL, become_another);
}

uint32_t pbf_process(void) {
  pbf_process_is_told();
  return __atomic_load_n(&processes, __ATOMIC_RELAXED);
}

int pbf_at_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void)) {
  return pthread_atfork(before, in_parent, in_child) == 0;
}

/* ---- Threads -------------------------------------------------------------------------------- */

uintptr_t pbf_this_thread(void) { return (uintptr_t)pthread_self(); }

void pbf_yield(void) { sched_yield(); }

/* A program may have made it small, for threads that do little. */
static size_t usual_stack(const pthread_attr_t *attributes) {
  enum { LEAST = 1 << 18 };
  size_t usual = 0;
  return pthread_attr_getstacksize(attributes, &usual) == 0 && usual > LEAST ? usual : LEAST;
}

/* Since its version 2.35 glibc has each thread ask for restartable sequences, and ends the process
 * where the first one got them and a later one does not: in a sandbox that has denied the call
 * since. */
#if defined(__GLIBC__) && defined(SYS_rseq)
#define ASKS_FOR_SEQUENCES __GLIBC_PREREQ(2, 35)
#else
#define ASKS_FOR_SEQUENCES 0
#endif

#if ASKS_FOR_SEQUENCES

/* 1 where the kernel has them and this process may ask for them: what is asked for here is invalid.
 */
static int has_sequences(void) {
  const int before = errno;
  const int has = syscall(SYS_rseq, NULL, 0, 0, 0) != 0 && errno == EINVAL;
  errno = before;
  return has;
}

static int had_sequences; /* when this was loaded */
PBF_CONSTRUCTOR static void see_sequences(void) { had_sequences = has_sequences(); }
static int threads_would_begin(void) { return !had_sequences || has_sequences(); }

#else

static int threads_would_begin(void) { return 1; }

#endif

static void leave_as_before(sigset_t *blocked, const sigset_t *before, int signal) {
  if (!sigismember(before, signal)) sigdelset(blocked, signal);
}

/* Where the signal of a fault is blocked, the fault ends the process, past the handler by which a
 * runtime raises an exception, or a program writes a report. */
static void leave_faults(sigset_t *blocked, const sigset_t *before) {
  static const int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS};
  for (size_t k = 0; k < sizeof faults / sizeof faults[0]; ++k)
    leave_as_before(blocked, before, faults[k]);
}

/* Collectors of garbage stop each thread that has run their language, and wait until it has
 * stopped: Mono's by real-time signals, Boehm's by SIGPWR and SIGXCPU. */
static void leave_stops(sigset_t *blocked, const sigset_t *before) {
#ifdef SIGPWR
  leave_as_before(blocked, before, SIGPWR);
#endif
  leave_as_before(blocked, before, SIGXCPU);
#ifdef SIGRTMIN
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal)
    leave_as_before(blocked, before, signal);
#endif
}

int pbf_thread_start(pbf_thread *thread, pbf_thread_kind kind, size_t stack_bytes,
                     void *(*run)(void *), void *user) {
  sigset_t blocked, before;
  pthread_attr_t attributes;
  if (!threads_would_begin() || pthread_attr_init(&attributes) != 0) return 0;
  if (!stack_bytes) stack_bytes = usual_stack(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  sigfillset(&blocked);
  pthread_sigmask(SIG_SETMASK, NULL, &before);
  leave_faults(&blocked, &before);
  if (kind == PBF_THREAD_OF_CALLBACKS) leave_stops(&blocked, &before);
  pthread_sigmask(SIG_SETMASK, &blocked, NULL); /* which a thread has from the one that starts it */
  thread->module = pbf_module_hold();
  const int failed = pthread_create(&thread->thread, &attributes, run, user);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  pthread_attr_destroy(&attributes);
  if (failed) pbf_module_release(thread->module);
  return !failed;
}

#if defined(__linux__)

/* The C library ends the process where it can't wait. */
static void wait_for_end(pthread_t thread) {
  if (pbf_can_wait()) {
    pthread_join(thread, NULL);
    return;
  }
  while (pthread_tryjoin_np(thread, NULL) == EBUSY) sched_yield();
}

#else

static void wait_for_end(pthread_t thread) { pthread_join(thread, NULL); }

#endif

void pbf_thread_join(pbf_thread *thread) {
  void *module = thread->module;
  wait_for_end(thread->thread);
  pbf_module_release(module);
}

/* It holds its module for ever: nothing tells of its end. */
void pbf_thread_detach(pbf_thread *thread) { pthread_detach(thread->thread); }

uintptr_t pbf_thread_of(const pbf_thread *thread) { return (uintptr_t)thread->thread; }

#if !defined(__linux__)

int pbf_can_wait(void) { return 1; }

void pbf_mutex_init(pbf_mutex *mutex) { pthread_mutex_init(&mutex->mutex, NULL); }
void pbf_mutex_destroy(pbf_mutex *mutex) { pthread_mutex_destroy(&mutex->mutex); }
void pbf_mutex_lock(pbf_mutex *mutex) { pthread_mutex_lock(&mutex->mutex); }
void pbf_mutex_unlock(pbf_mutex *mutex) { pthread_mutex_unlock(&mutex->mutex); }
int pbf_mutex_try(pbf_mutex *mutex) { return pthread_mutex_trylock(&mutex->mutex) == 0; }

void pbf_condition_init(pbf_condition *condition) {
  pthread_cond_init(&condition->condition, NULL);
}

void pbf_condition_destroy(pbf_condition *condition) {
  pthread_cond_destroy(&condition->condition);
}

void pbf_condition_wait(pbf_condition *condition, pbf_mutex *mutex) {
  pthread_cond_wait(&condition->condition, &mutex->mutex);
}

void pbf_condition_signal(pbf_condition *condition) { pthread_cond_signal(&condition->condition); }

void pbf_condition_broadcast(pbf_condition *condition) {
  pthread_cond_broadcast(&condition->condition);
}

#endif

/* ---- Memory of each thread's own ------------------------------------------------------------- */

/* Before what the thread has. */
typedef union per_thread_block {
  size_t bytes;
  max_align_t aligned;
} per_thread_block;

static void free_per_thread(void *own) {
  per_thread_block *whole = (per_thread_block *)own - 1;
  munmap(whole, whole->bytes);
}

void pbf_per_thread_begin(pbf_per_thread *memory, size_t bytes) {
  memory->bytes = sizeof(per_thread_block) + bytes;
  memory->is_there = pthread_key_create(&memory->key, free_per_thread) == 0;
}

void pbf_per_thread_end(pbf_per_thread *memory) {
  if (memory->is_there) pthread_key_delete(memory->key);
  memory->is_there = 0;
}

void *pbf_per_thread_look(const pbf_per_thread *memory) {
  return memory->is_there ? pthread_getspecific(memory->key) : NULL;
}

void *pbf_per_thread_take(const pbf_per_thread *memory) {
  void *there = pbf_per_thread_look(memory);
  if (there || !memory->is_there) return there;
  per_thread_block *whole =
      mmap(NULL, memory->bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (whole == MAP_FAILED) return NULL;
  whole->bytes = memory->bytes;
  if (pthread_setspecific(memory->key, whole + 1) == 0) return whole + 1;
  munmap(whole, memory->bytes);
  return NULL;
}
