/* What a plugin's file, or a part's, exports. In a static libpbf nothing is. */
#ifndef PBF_COMMON_EXPORTED_H
#define PBF_COMMON_EXPORTED_H

#if defined(PBF_LINKED)
#define PBF_EXPORTED __attribute__((visibility("hidden")))
#elif defined(_WIN32)
#define PBF_EXPORTED __declspec(dllexport)
#else
#define PBF_EXPORTED __attribute__((visibility("default")))
#endif

#endif
