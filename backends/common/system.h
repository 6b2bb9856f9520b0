/* What backends, and the library's threads, want of the system: system_posix.c, system_windows.c
 * and system_wasm.c have it. No other file of backends/ but the teams' own asks on which system it
 * is. */
#ifndef PBF_COMMON_SYSTEM_H
#define PBF_COMMON_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)

/* Types of <windows.h> by what they are: its macros would be everywhere. */
typedef struct pbf_thread {
  void *handle;
  uintptr_t number;
  void *(*run)(void *user);
  void *user;
} pbf_thread;

typedef struct pbf_mutex {
  void *lock; /* SRWLOCK */
} pbf_mutex;

typedef struct pbf_condition {
  void *variable; /* CONDITION_VARIABLE */
} pbf_condition;

typedef struct pbf_per_thread {
  uint32_t index; /* of fiber-local storage */
  int is_there;
  size_t bytes;
} pbf_per_thread;

#define PBF_MUTEX_INITIALIZER \
  { 0 }
#define PBF_CONDITION_INITIALIZER \
  { 0 }

#elif defined(__wasm_atomics__)

typedef struct pbf_thread {
  uint32_t worker; /* that runs it */
} pbf_thread;

typedef struct pbf_per_thread {
  uint32_t kind;
  size_t bytes;
} pbf_per_thread;

/* Waits while the word has this value, where the calling thread may: that of a page may not. May
 * return for no reason. */
void pbf_wasm_wait(uint32_t *word, uint32_t value);

#else

#include <pthread.h>

typedef struct pbf_thread {
  pthread_t thread;
  void *module; /* that it holds while it runs */
} pbf_thread;

typedef struct pbf_per_thread {
  pthread_key_t key;
  int is_there;
  size_t bytes;
} pbf_per_thread;

#if !defined(__linux__)

typedef struct pbf_mutex {
  pthread_mutex_t mutex;
} pbf_mutex;

typedef struct pbf_condition {
  pthread_cond_t condition;
} pbf_condition;

#define PBF_MUTEX_INITIALIZER \
  { PTHREAD_MUTEX_INITIALIZER }
#define PBF_CONDITION_INITIALIZER \
  { PTHREAD_COND_INITIALIZER }

#endif
#endif

#if defined(__linux__) || defined(__wasm_atomics__)

/* waits.c. */
typedef struct pbf_mutex {
  uint32_t state;
} pbf_mutex;

typedef struct pbf_condition {
  uint32_t signals, waiting;
} pbf_condition;

#define PBF_MUTEX_INITIALIZER \
  { 0 }
#define PBF_CONDITION_INITIALIZER \
  { 0, 0 }

#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A variable's value; null when it is unset, or when the process has rights that what has set it
 * may lack. */
const char *pbf_environment(const char *name);

/* Seconds by a clock that only goes forward. */
double pbf_seconds(void);

/* Seconds that a processor has worked for the calling thread. */
double pbf_thread_seconds(void);

/* CPUs that this process may use, at least 1. */
uint32_t pbf_processors(void);

/* ---- Processes ------------------------------------------------------------------------------ */

/* The calling process, never 0: another number than in all that it comes of by forks, be it that
 * the system has the same for both, does not call what is to be called around a fork, or does not
 * tell. */
uint32_t pbf_process(void);

/* 0 where a sandbox does not tell the calling process's number. */
int pbf_process_is_told(void);

/* Has them called around each fork; each may be null. 1 for success. Where processes do not fork,
 * never. */
int pbf_at_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void));

/* ---- Threads -------------------------------------------------------------------------------- */

/* The calling thread: never 0, and safe in a signal handler. */
uintptr_t pbf_this_thread(void);

/* Lets others run. */
void pbf_yield(void);

/* Whether functions of the program run in a thread. */
typedef enum pbf_thread_kind { PBF_THREAD_OWN, PBF_THREAD_OF_CALLBACKS } pbf_thread_kind;

/* A thread that takes no signals but what faults in it raise, and, where callbacks run in it, those
 * by which runtimes of other languages stop a thread: these as the calling thread takes them. 1
 * once it runs. `stack_bytes` 0: the program's default, and 256 KiB at least. The struct stays
 * where it is until the thread has begun. */
int pbf_thread_start(pbf_thread *thread, pbf_thread_kind kind, size_t stack_bytes,
                     void *(*run)(void *), void *user);
void pbf_thread_join(pbf_thread *thread);

/* In place of the join, also in the thread itself. */
void pbf_thread_detach(pbf_thread *thread);

/* What pbf_this_thread gives in it. */
uintptr_t pbf_thread_of(const pbf_thread *thread);

/* 0: a sandbox forbids that threads wait for each other in the kernel. Those below then do it by
 * turns of other threads; runtimes of others end the process, or never return. */
int pbf_can_wait(void);

void pbf_mutex_init(pbf_mutex *mutex);
void pbf_mutex_destroy(pbf_mutex *mutex);
void pbf_mutex_lock(pbf_mutex *mutex);
void pbf_mutex_unlock(pbf_mutex *mutex);

/* 0: another holds it, or this thread does. */
int pbf_mutex_try(pbf_mutex *mutex);

/* A wait may end without a signal. */
void pbf_condition_init(pbf_condition *condition);
void pbf_condition_destroy(pbf_condition *condition);
void pbf_condition_wait(pbf_condition *condition, pbf_mutex *mutex);
void pbf_condition_signal(pbf_condition *condition);
void pbf_condition_broadcast(pbf_condition *condition);

/* ---- Memory of each thread's own ------------------------------------------------------------- */

/* In place of thread-local variables: of a library that is loaded at run time their memory is taken
 * when a thread first looks at one, and where there is none the C library prints so and ends the
 * process. Static; begins when the library is loaded and ends when it is unloaded. */
void pbf_per_thread_begin(pbf_per_thread *memory, size_t bytes);
void pbf_per_thread_end(pbf_per_thread *memory);

/* The calling thread's, all zero at first, until it ends. Null: there is no memory. Takes it by a
 * call of the system alone, which a signal handler may make, too. */
void *pbf_per_thread_take(const pbf_per_thread *memory);

/* The same without taking any: null where the thread has none yet. */
void *pbf_per_thread_look(const pbf_per_thread *memory);

#ifdef __cplusplus
}
#endif

#endif
