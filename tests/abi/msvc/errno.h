#include "c.h"
C_BEGIN
int *_errno(void);
C_END
#define errno (*_errno())
#define ENOENT 2
#define ENOTDIR 20
#define EINTR 4
#define ENOMEM 12
#define EACCES 13
#define EINVAL 22
#define ENFILE 23
#define EMFILE 24
