/* pbf/base.h: what the other headers are declared with: how functions are exported, status codes,
 * the handle of a solver, the numbers of devices and element types.
 *
 * All of these headers have the rules that stand at the head of pbf.h.
 */
#ifndef PBF_BASE_H
#define PBF_BASE_H

#include <stdint.h>

#if defined(_WIN32) && defined(PBF_STATIC_LIBRARY) /* part of the program */
#define PBF_API
#elif defined(_WIN32) && defined(PBF_BUILDS_LIBRARY)
#define PBF_API __declspec(dllexport)
#elif defined(_WIN32)
#define PBF_API __declspec(dllimport)
#else
#define PBF_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Status codes ---------------------------------------------------------------------------- */

/* What a call that can fail returns. */
typedef int32_t pbf_status;

enum {
  PBF_OK = 0,
  PBF_ERROR_INVALID_ARGUMENT = -1, /* a null pointer, a value out of range, NaN or infinity */
  PBF_ERROR_STRUCT_SIZE = -2,      /* struct_size is wrong, or unknown bytes are not zero */
  PBF_ERROR_OUT_OF_MEMORY = -3,    /* host or device */
  PBF_ERROR_CAPACITY = -4,         /* more particles than pbf_desc.capacity */
  PBF_ERROR_NOT_FOUND = -5,        /* no particle, backend or item of that name or number */
  PBF_ERROR_UNAVAILABLE = -6,      /* no backend can serve this solver; the sentence says why */
  PBF_ERROR_UNSUPPORTED = -7,      /* this build or backend does not have it */
  PBF_ERROR_BUSY = -8,             /* another call is inside this solver */
  PBF_ERROR_STATE = -9,            /* not now: a view is mapped, for example */
  PBF_ERROR_DEVICE = -10,          /* a device call failed; the sentence names the call */
  PBF_ERROR_PLUGIN = -11,          /* a backend broke the plugin rules */
  PBF_ERROR_DATA = -12,            /* a saved state is truncated, damaged or of another kind */
  PBF_ERROR_CANCELLED = -13        /* pbf_cancel has ended the call; what it has done stands */
};

/* The code's name, "PBF_ERROR_CAPACITY"; never null, static storage. */
PBF_API const char *pbf_status_string(pbf_status status);

/* The sentence for the last failure in this thread; never null, empty before the first one.
 * Valid until this thread's next call that fails. */
PBF_API const char *pbf_last_error(void);

/* ---- What the headers share ------------------------------------------------------------------ */

/* A fluid: its particles, parameters, colliders and time; pbf_create makes one. */
typedef struct pbf_solver pbf_solver;

/* Bytes of a name, its ending zero included. */
#define PBF_NAME_SIZE 32

/* Devices, by DLPack's numbers. */
enum { PBF_DEVICE_CPU = 1, PBF_DEVICE_CUDA = 2 };

/* Elements of arrays. */
enum { PBF_TYPE_FLOAT32 = 4, PBF_TYPE_FLOAT64 = 8, PBF_TYPE_UINT32 = 12 };

/* Fields of particles. */
enum {
  PBF_FIELD_POSITION = 1,
  PBF_FIELD_VELOCITY = 2,
  PBF_FIELD_ID = 3,
  PBF_FIELD_DENSITY = 4, /* can't be mapped: no backend keeps it */
  PBF_FIELD_PRESSURE = 5 /* as pbf_get_pressures; its memory is taken when it is first mapped */
};

#ifdef __cplusplus
}
#endif

#endif
