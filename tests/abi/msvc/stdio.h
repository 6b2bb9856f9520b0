#include <stdarg.h>
#include "c.h"
C_BEGIN
typedef struct FILE FILE;
int snprintf(char *text, size_t size, const char *format, ...);
int vsnprintf(char *text, size_t size, const char *format, va_list arguments);
FILE *fopen(const char *path, const char *mode);
int fclose(FILE *file);
size_t fread(void *rows, size_t size, size_t count, FILE *file);
size_t fwrite(const void *rows, size_t size, size_t count, FILE *file);
int fseek(FILE *file, long offset, int from);
int ferror(FILE *file);
C_END
