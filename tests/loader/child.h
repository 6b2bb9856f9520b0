/* Tests of what happens once a process: each runs in a process of its own. */
#ifndef PBF_TESTS_CHILD_H
#define PBF_TESTS_CHILD_H

#include <stddef.h>

#include "support.h"

/* Runs `body` in a child whose failed checks fail this test. */
void in_child(void (*body)(void));

/* In a child: notes a failure unless `condition` holds. */
void check_at(int condition, const char *text, const char *file, int line);
#define check(condition) check_at((condition) != 0, #condition, __FILE__, __LINE__)

/* In a child: the call gives `expected` with a sentence that holds `words`. */
void check_status_at(pbf_status status, pbf_status expected, const char *words, const char *call,
                     const char *file, int line);
#define check_fails(call, status, words) \
  check_status_at((call), (status), (words), #call, __FILE__, __LINE__)
#define check_ok(call) check_status_at((call), PBF_OK, "", #call, __FILE__, __LINE__)

/* A folder of the test's own, removed by drop_folder; readable by everyone. */
void make_folder(char *folder, size_t size);
void drop_folder(const char *folder);

/* Copies the stub (or any file, by its absolute path) into the folder under another name. */
void put_file(const char *folder, const char *name, const char *source);
void put_text(const char *folder, const char *name, const char *text);
void make_subfolder(const char *folder, const char *name);

/* The entry of that name, available or not, and of that path if not null; index or -1. */
int find_backend(const char *name, const char *path, pbf_backend_info *info);

#endif
