/* pbf/backends.h: which backends there are, which could serve a solver, and why others can't.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_BACKENDS_H
#define PBF_BACKENDS_H

#include <pbf/desc.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Backends -------------------------------------------------------------------------------- */

/* A file or linked-in part that is a backend, or was to be one. */
typedef struct pbf_backend_info {
  uint32_t struct_size;
  uint32_t available;   /* 1: can serve the solver that was asked about */
  int32_t score;        /* "auto" takes the highest; 0: can't serve */
  uint32_t device_type; /* PBF_DEVICE_… */
  char name[PBF_NAME_SIZE];
  char device_name[96];
  char build_id[96];
  char path[256];
  char reason[256]; /* why it can't serve: the probe's or the dynamic loader's words */
} pbf_backend_info;

/* Number of entries: every backend found, and every candidate that failed to load. */
PBF_API pbf_status pbf_get_backend_count(uint32_t *count);

/* Entry `index`, judged for a solver like `desc` (null: the defaults). info->struct_size must be
 * set. */
PBF_API pbf_status pbf_get_backend_info(const pbf_desc *desc, uint32_t index,
                                        pbf_backend_info *info);

/* Loads a plugin from an absolute path, for the life of the process. The backends that come with
 * the library need no call: they are found when first wanted, in the folders of
 * PBF_BACKEND_PATH (absolute, with colons between them, on Windows semicolons; ignored under
 * elevated privileges), beside libpbf, in pbf/backends/ beside libpbf. Paths are UTF-8. A file that
 * is cut short, or for another machine, is refused, and so is, on Linux, one with a wrong bit in
 * its headers, or in its tables for the dynamic loader; what is in its code and data is trusted,
 * and must not be written to while it is loaded: a new one is put in its place by renaming. */
PBF_API pbf_status pbf_load_backend(const char *path);

#ifdef __cplusplus
}
#endif

#endif
