/* What the other headers here begin with. */
#ifndef PBF_TEST_MSVC_C_H
#define PBF_TEST_MSVC_C_H
#include <stddef.h>
#ifdef __cplusplus
#define C_BEGIN extern "C" {
#define C_END }
#else
#define C_BEGIN
#define C_END
#endif
#endif
