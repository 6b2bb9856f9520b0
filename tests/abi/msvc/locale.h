#include "c.h"
#define LC_NUMERIC 4
C_BEGIN
char *setlocale(int category, const char *name);
C_END
