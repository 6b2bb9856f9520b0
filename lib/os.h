/* What the library wants of the system beside what backends do: os_posix.c, os_windows.c and
 * os_wasm.c have it, and no other file of the library asks on which system it is. Paths are UTF-8.
 */
#ifndef PBF_LIB_OS_H
#define PBF_LIB_OS_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include "common/system.h"

/* ---- Memory, time, numbers ------------------------------------------------------------------ */

/* `alignment` is a power of two. Null: there is none. */
void *pbf_os_allocate(size_t size, size_t alignment);
void pbf_os_release(void *memory);

/* Of a system that gives out more memory than it has, and ends processes when it is written to: the
 * bytes that are left, and those that this process has written to. Returns 0 where the system gives
 * no more than it has, or does not tell. */
int pbf_os_memory(uint64_t *left, uint64_t *written);

void pbf_os_sleep(uint32_t microseconds);

/* vsnprintf, with a point in numbers whatever the program's locale writes. */
void pbf_os_print_plain(char *text, size_t size, const char *format, va_list arguments);

/* ---- A thread that another one cancels ------------------------------------------------------ */

/* A call is not left halfway by pthread_cancel, which would take a lock or a solver with it: the
 * thread is cancelled after the call, at its next cancellation point. Returns what to give back at
 * the end. */
int pbf_uncancelled_begin(void);
void pbf_uncancelled_end(int before);

/* ---- Stacks --------------------------------------------------------------------------------- */

/* Has this thread's stack looked up, which allocates: not in a signal handler. */
void pbf_os_find_stack(void);

/* Has `ended` called by each thread that has had its stack looked up, when that thread ends. Where
 * ends are not told of, never. One function, for the life of the library. */
void pbf_os_watch_threads(void (*ended)(void));

/* Whether the place is on the stack that this thread was made with: coroutines and signal handlers
 * may have others. 0 where that is not known. */
int pbf_os_is_on_stack(const volatile void *place);

/* Whether code runs on a signal handler's own. */
int pbf_os_on_signal_stack(void);

/* ---- Paths ---------------------------------------------------------------------------------- */

/* Longest path, its end included. */
enum { PBF_OS_PATH_SIZE = 4096 };

/* Between the folders of a list in the environment. */
extern const char pbf_os_list_separator;

int pbf_os_is_absolute(const char *path);

/* The folder of this library's own file, links resolved. 0: it is not known. */
int pbf_os_own_folder(char *folder, size_t size);

/* Where the file's own name begins in an absolute path. */
const char *pbf_os_name_in(const char *path);

/* The file that a path names, links resolved. 0: there is none, or links are not looked at. */
int pbf_os_resolve(const char *path, char *file, size_t size);

/* 1 when the process has rights that its caller lacks. */
int pbf_os_is_elevated(void);

/* A variable's value as UTF-8, as pbf_environment says; valid until the next call. With the lock of
 * backends held. */
const char *pbf_os_path_variable(const char *name);

/* ---- Files ---------------------------------------------------------------------------------- */

/* 0 or an error of errno.h. A pipe or a device is no regular file. */
int pbf_os_look(const char *path, int *is_regular);

/* Opens it for reading. 0 or an error of errno.h. */
int pbf_os_open(const char *path, int *file, uint64_t *size);
void pbf_os_close(int file);

/* 1 when all was read; else errno says why, or is 0 at the file's end. */
int pbf_os_read(int file, void *bytes, size_t count, uint64_t offset);

/* Bytes of a page of memory. */
size_t pbf_os_page(void);

/* ---- Libraries ------------------------------------------------------------------------------ */

typedef void (*pbf_os_function)(void);

/* Whether an error is one of too few descriptors, or too little memory. */
int pbf_os_is_shortage(int error);

/* Whether the process can have one more key of thread-specific data. */
int pbf_os_has_thread_key(void);

/* Loads it for the life of the process, with what it depends on: threads of a backend's runtime
 * may outlive a library that is closed. Null with a reason on failure, and in *failed the error
 * where it is known. */
void *pbf_os_load(const char *path, char *reason, size_t size, int *failed);

/* Null: it exports no such function. */
pbf_os_function pbf_os_function_of(void *library, const char *name);

/* Where the loader has put this library's own file; null: not known. */
const void *pbf_os_own_image(void);

#endif
