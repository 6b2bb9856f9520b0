#include "c.h"
C_BEGIN
void *malloc(size_t size);
void *calloc(size_t count, size_t size);
void *realloc(void *memory, size_t size);
void free(void *memory);
void qsort(void *rows, size_t count, size_t size, int (*order)(const void *, const void *));
char *getenv(const char *name);
int atexit(void (*function)(void));
int abs(int a);
unsigned long long strtoull(const char *text, char **end, int base);
unsigned long strtoul(const char *text, char **end, int base);
long strtol(const char *text, char **end, int base);
double strtod(const char *text, char **end);
C_END
