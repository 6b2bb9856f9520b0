/* A part of plugins, of a build that no plugin is of. */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT const void *pbf_backend_part(void);

EXPORT const void *pbf_backend_part(void) {
  static const char *const build[] = {"another build"};
  return build;
}
