#include "c.h"
C_BEGIN
typedef long long time_t;
time_t time(time_t *now);
C_END
