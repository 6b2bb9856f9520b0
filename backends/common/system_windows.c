/* Windows, from 7 on. */
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include "common/system.h"

_Static_assert(sizeof(SRWLOCK) == sizeof(pbf_mutex), "pbf_mutex is an SRWLOCK");
_Static_assert(sizeof(CONDITION_VARIABLE) == sizeof(pbf_condition), "and the other a condition");

static SRWLOCK *lock_of(pbf_mutex *mutex) { return (SRWLOCK *)(void *)mutex; }

static CONDITION_VARIABLE *variable_of(pbf_condition *condition) {
  return (CONDITION_VARIABLE *)(void *)condition;
}

/* The system's, of which each C library in a process has a copy of its own. A process that was
 * given more rights has its own user's environment. */
const char *pbf_environment(const char *name) {
  static _Thread_local char value[256];
  const DWORD length = GetEnvironmentVariableA(name, value, sizeof value);
  return length > 0 && length < sizeof value ? value : NULL;
}

double pbf_seconds(void) {
  LARGE_INTEGER count, frequency;
  QueryPerformanceCounter(&count);
  QueryPerformanceFrequency(&frequency);
  return (double)count.QuadPart / (double)frequency.QuadPart;
}

/* In units of 100 ns. */
static double seconds_of(FILETIME time) {
  return 429.4967296 * (double)time.dwHighDateTime + 1e-7 * (double)time.dwLowDateTime;
}

double pbf_thread_seconds(void) {
  FILETIME begun, ended, in_system, in_program;
  if (!GetThreadTimes(GetCurrentThread(), &begun, &ended, &in_system, &in_program)) return 0;
  return seconds_of(in_system) + seconds_of(in_program);
}

uint32_t pbf_processors(void) {
  DWORD_PTR process = 0, system = 0;
  uint32_t count = 0;
  if (!GetProcessAffinityMask(GetCurrentProcess(), &process, &system)) return 1;
  for (; process; process &= process - 1) ++count;
  return count ? count : 1;
}

/* ---- Processes ------------------------------------------------------------------------------ */

uint32_t pbf_process(void) { return GetCurrentProcessId(); }

int pbf_process_is_told(void) { return 1; }

int pbf_at_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void)) {
  (void)before, (void)in_parent, (void)in_child;
  return 1;
}

/* ---- Threads -------------------------------------------------------------------------------- */

uintptr_t pbf_this_thread(void) { return GetCurrentThreadId(); }

void pbf_yield(void) { SwitchToThread(); }

static DWORD WINAPI run_thread(void *user) {
  pbf_thread *own = user;
  own->run(own->user);
  return 0;
}

int pbf_thread_start(pbf_thread *thread, pbf_thread_kind kind, size_t stack_bytes,
                     void *(*run)(void *), void *user) {
  DWORD number = 0;
  (void)kind;
  thread->run = run;
  thread->user = user;
  thread->handle = CreateThread(NULL, stack_bytes, run_thread, thread,
                                stack_bytes ? STACK_SIZE_PARAM_IS_A_RESERVATION : 0, &number);
  thread->number = number;
  return thread->handle != NULL;
}

void pbf_thread_join(pbf_thread *thread) {
  WaitForSingleObject(thread->handle, INFINITE);
  CloseHandle(thread->handle);
}

void pbf_thread_detach(pbf_thread *thread) { CloseHandle(thread->handle); }

uintptr_t pbf_thread_of(const pbf_thread *thread) { return thread->number; }

int pbf_can_wait(void) { return 1; }

void pbf_mutex_init(pbf_mutex *mutex) { InitializeSRWLock(lock_of(mutex)); }
void pbf_mutex_destroy(pbf_mutex *mutex) { (void)mutex; }
void pbf_mutex_lock(pbf_mutex *mutex) { AcquireSRWLockExclusive(lock_of(mutex)); }
void pbf_mutex_unlock(pbf_mutex *mutex) { ReleaseSRWLockExclusive(lock_of(mutex)); }
int pbf_mutex_try(pbf_mutex *mutex) { return TryAcquireSRWLockExclusive(lock_of(mutex)) != 0; }

void pbf_condition_init(pbf_condition *condition) {
  InitializeConditionVariable(variable_of(condition));
}

void pbf_condition_destroy(pbf_condition *condition) { (void)condition; }

void pbf_condition_wait(pbf_condition *condition, pbf_mutex *mutex) {
  SleepConditionVariableSRW(variable_of(condition), lock_of(mutex), INFINITE, 0);
}

void pbf_condition_signal(pbf_condition *condition) {
  WakeConditionVariable(variable_of(condition));
}

void pbf_condition_broadcast(pbf_condition *condition) {
  WakeAllConditionVariable(variable_of(condition));
}

/* ---- Memory of each thread's own ------------------------------------------------------------- */

static void WINAPI free_per_thread(void *own) {
  if (own) VirtualFree(own, 0, MEM_RELEASE);
}

void pbf_per_thread_begin(pbf_per_thread *memory, size_t bytes) {
  memory->bytes = bytes;
  memory->index = FlsAlloc(free_per_thread);
  memory->is_there = memory->index != FLS_OUT_OF_INDEXES;
}

void pbf_per_thread_end(pbf_per_thread *memory) {
  if (memory->is_there) FlsFree(memory->index);
  memory->is_there = 0;
}

void *pbf_per_thread_look(const pbf_per_thread *memory) {
  return memory->is_there ? FlsGetValue(memory->index) : NULL;
}

void *pbf_per_thread_take(const pbf_per_thread *memory) {
  void *there = pbf_per_thread_look(memory);
  if (there || !memory->is_there) return there;
  there = VirtualAlloc(NULL, memory->bytes, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
  if (!there || FlsSetValue(memory->index, there)) return there;
  VirtualFree(there, 0, MEM_RELEASE);
  return NULL;
}
