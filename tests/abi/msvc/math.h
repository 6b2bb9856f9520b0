#include "c.h"
#define INFINITY (__builtin_inff())
#define NAN (__builtin_nanf(""))
#define HUGE_VAL (__builtin_inf())
#define isfinite(a) (__builtin_isfinite(a))
#define isinf(a) (__builtin_isinf(a))
#define isnan(a) (__builtin_isnan(a))
#define signbit(a) (__builtin_signbit(a))
C_BEGIN
double cosh(double a);
double sqrt(double a);
double fabs(double a);
double floor(double a);
double ceil(double a);
double round(double a);
double trunc(double a);
double rint(double a);
double exp(double a);
double log(double a);
double log2(double a);
double sin(double a);
double cos(double a);
double tan(double a);
double acos(double a);
double asin(double a);
double atan(double a);
double cbrt(double a);
double fmin(double a, double b);
double fmax(double a, double b);
double pow(double a, double b);
double fmod(double a, double b);
double atan2(double a, double b);
double copysign(double a, double b);
double hypot(double a, double b);
double nextafter(double a, double b);
double fma(double a, double b, double c);
double ldexp(double a, int b);
double frexp(double a, int *b);
float sqrtf(float a);
float fabsf(float a);
float floorf(float a);
float ceilf(float a);
float roundf(float a);
float truncf(float a);
float rintf(float a);
float expf(float a);
float logf(float a);
float log2f(float a);
float sinf(float a);
float cosf(float a);
float tanf(float a);
float acosf(float a);
float asinf(float a);
float atanf(float a);
float cbrtf(float a);
float fminf(float a, float b);
float fmaxf(float a, float b);
float powf(float a, float b);
float fmodf(float a, float b);
float atan2f(float a, float b);
float copysignf(float a, float b);
float hypotf(float a, float b);
float nextafterf(float a, float b);
float fmaf(float a, float b, float c);
float ldexpf(float a, int b);
float frexpf(float a, int *b);
C_END
