#include <stdint.h>
#define PRIu32 "u"
#define PRIx32 "x"
#define PRIi64 "lld"
#define PRId64 "lld"
#define PRIu64 "llu"
#define PRIx64 "llx"
