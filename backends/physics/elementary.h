/* Sines, powers and logarithms that have the same bits on every machine: C libraries round them
 * differently, by processor, too. Each is computed in pairs of float64 that add up to the number,
 * with about 100 bits, by + - * / and roots alone, and then rounded once. Where a start is wanted
 * it is the library's, which no bit depends on. Host only; C17 and C++17.
 *
 * Of small angles, as solids turn by in a frame, some 60 bits are enough to know how it is rounded
 * nearly always, and take a tenth of the time (Ziv, ACM Transactions on Mathematical Software 17,
 * 1991): those functions try that first.
 *
 * Sums and products of pairs: Dekker, Numerische Mathematik 18, 1971. */
#ifndef PBF_PHYSICS_ELEMENTARY_H
#define PBF_PHYSICS_ELEMENTARY_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* high + low, of which low is less than half of high's last bit. */
typedef struct pbf_pair_real {
  double high, low;
} pbf_pair_real;

static inline pbf_pair_real pbf_pair_of(double high, double low) {
  const double sum = high + low, part = sum - high;
  pbf_pair_real pair = {sum, (high - (sum - part)) + (low - part)};
  return pair;
}

static inline pbf_pair_real pbf_pair_product_of(double a, double b) {
  const double split = 134217729; /* 2^27 + 1: halves of 26 bits, with exact products */
  const double a_split = split * a, a_high = a_split - (a_split - a), a_low = a - a_high;
  const double b_split = split * b, b_high = b_split - (b_split - b), b_low = b - b_high;
  const double product = a * b;
  pbf_pair_real pair = {
      product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
  return pair;
}

static inline pbf_pair_real pbf_pair_add(pbf_pair_real a, pbf_pair_real b) {
  const pbf_pair_real sum = pbf_pair_of(a.high, b.high);
  return pbf_pair_of(sum.high, sum.low + (a.low + b.low));
}

static inline pbf_pair_real pbf_pair_multiply(pbf_pair_real a, pbf_pair_real b) {
  const pbf_pair_real product = pbf_pair_product_of(a.high, b.high);
  return pbf_pair_of(product.high, product.low + (a.high * b.low + a.low * b.high));
}

static inline pbf_pair_real pbf_pair_negate(pbf_pair_real a) {
  pbf_pair_real negative = {-a.high, -a.low};
  return negative;
}

/* ---- Sines ---------------------------------------------------------------------------------- */

/* What is left of x beyond the multiple `turns` of a quarter of a turn. */
static inline pbf_pair_real pbf_beyond_quarters(double x, double turns) {
  const double quarter[3] = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110};
  pbf_pair_real left = {x, 0};
  for (int k = 0; k < 3; ++k)
    left = pbf_pair_add(left, pbf_pair_negate(pbf_pair_product_of(turns, quarter[k])));
  return left;
}

/* sin x of |x| <= pi / 4 by its series; from x^7 on, less than a ten thousandth of x, without the
 * low parts. */
static inline pbf_pair_real pbf_pair_sine(pbf_pair_real x) {
  const pbf_pair_real third = {-0x1.5555555555555p-3, -0x1.5555555555555p-57}; /* -1/6 */
  const pbf_pair_real fifth = {0x1.1111111111111p-7, 0x1.1111111111111p-63};   /* 1/120 */
  const pbf_pair_real square = pbf_pair_multiply(x, x);
  const double s = square.high;
  double rest = -1 / 1307674368000.0;
  rest = 1 / 6227020800.0 + s * (rest + s * (1 / 355687428096000.0));
  rest = s * (-1 / 5040.0 + s * (1 / 362880.0 + s * (-1 / 39916800.0 + s * rest)));
  pbf_pair_real sum = pbf_pair_add(pbf_pair_of(fifth.high, rest), pbf_pair_of(fifth.low, 0));
  sum = pbf_pair_add(pbf_pair_multiply(sum, square), third);
  return pbf_pair_add(x, pbf_pair_multiply(pbf_pair_multiply(sum, square), x));
}

static inline pbf_pair_real pbf_pair_cosine(pbf_pair_real x) {
  const pbf_pair_real one = {1, 0}, half = {-0.5, 0};
  const pbf_pair_real fourth = {0x1.5555555555555p-5, 0x1.5555555555555p-59}; /* 1/24 */
  const pbf_pair_real square = pbf_pair_multiply(x, x);
  const double s = square.high;
  double rest = 1 / 20922789888000.0;
  rest = 1 / 479001600.0 + s * (-1 / 87178291200.0 + s * rest);
  rest = s * (-1 / 720.0 + s * (1 / 40320.0 + s * (-1 / 3628800.0 + s * rest)));
  pbf_pair_real sum = pbf_pair_add(pbf_pair_of(fourth.high, rest), pbf_pair_of(fourth.low, 0));
  sum = pbf_pair_add(pbf_pair_multiply(sum, square), half);
  return pbf_pair_add(one, pbf_pair_multiply(sum, square));
}

/* The sine of x and, `ahead` 1, of a quarter of a turn on. From 2^52 on, where x is known to no
 * part of a turn, it counts as none. */
static inline pbf_pair_real pbf_pair_sine_ahead(double x, int ahead) {
  const pbf_pair_real none = {ahead ? 1.0 : 0.0, 0}, small = {ahead ? 1.0 : x, 0};
  if (!(fabs(x) < 0x1p52)) return none;
  if (fabs(x) < 0x1p-30) return small;
  const double turns = floor(x * 0x1.45f306dc9c883p-1 + 0.5);
  const pbf_pair_real whole = {x, 0};
  const pbf_pair_real left = turns == 0 ? whole : pbf_beyond_quarters(x, turns);
  const int quarter = (int)((int64_t)turns + ahead) & 3;
  const pbf_pair_real value = quarter & 1 ? pbf_pair_cosine(left) : pbf_pair_sine(left);
  return quarter & 2 ? pbf_pair_negate(value) : value;
}

/* ---- Those of small angles ------------------------------------------------------------------ */

/* Up to here what follows is known well enough 15 times of 16 and more. */
#define PBF_SMALL_ANGLE 0.125

/* Whether the sum of a number and one that is much less, which is known to within `error`, is
 * rounded to *sum wherever it lies. */
static inline int pbf_rounds_surely(double number, double less, double error, double *sum) {
  const double high = number + less, low = less - (high - number);
  *sum = high;
  return high + (low + error) == high && high + (low - error) == high;
}

/* What rounding takes from a series that begins with the square, times what it is a part of: less
 * than three times the last bit of a sixth or a half of it, doubled; and what pairs are off by. */
static inline double pbf_small_series_error(double square) { return 0x1p-51 * square + 0x1p-90; }

static inline int pbf_small_sine(double x, double *sine) {
  const double s = x * x;
  const double rest = 1 / 362880.0 + s * (-1 / 39916800.0 + s * (1 / 6227020800.0));
  const double part = s * (-1 / 6.0 + s * (1 / 120.0 + s * (-1 / 5040.0 + s * rest)));
  return fabs(x) < PBF_SMALL_ANGLE && fabs(x) > 0x1p-30 &&
         pbf_rounds_surely(x, x * part, fabs(x) * pbf_small_series_error(s), sine);
}

static inline int pbf_small_cosine(double x, double *cosine) {
  const double s = x * x;
  const double rest = 1 / 40320.0 + s * (-1 / 3628800.0 + s * (1 / 479001600.0));
  const double part = s * (-0.5 + s * (1 / 24.0 + s * (-1 / 720.0 + s * rest)));
  return fabs(x) < PBF_SMALL_ANGLE && fabs(x) > 0x1p-30 &&
         pbf_rounds_surely(1, part, pbf_small_series_error(s), cosine);
}

/* Of a tangent y / x, by the arctangent's series. */
static inline int pbf_small_angle(double y, double x, double *angle) {
  const double t = y / x, s = t * t;
  if (!(t < PBF_SMALL_ANGLE && t > 0x1p-30 && x > 0x1p-30)) return 0;
  const pbf_pair_real product = pbf_pair_product_of(t, x);
  const double left = ((y - product.high) - product.low) / x;
  double rest = -1 / 15.0 + s * (1 / 17.0 + s * (-1 / 19.0));
  rest = -1 / 11.0 + s * (1 / 13.0 + s * rest);
  rest = -1 / 7.0 + s * (1 / 9.0 + s * rest);
  const double part = s * (-1 / 3.0 + s * (1 / 5.0 + s * rest));
  return pbf_rounds_surely(t, t * part + left, t * pbf_small_series_error(s), angle);
}

/* ---- Of any angle --------------------------------------------------------------------------- */

static inline double pbf_sin(double x) {
  double sine;
  return pbf_small_sine(x, &sine) ? sine : pbf_pair_sine_ahead(x, 0).high;
}

static inline double pbf_cos(double x) {
  double cosine;
  return pbf_small_cosine(x, &cosine) ? cosine : pbf_pair_sine_ahead(x, 1).high;
}

/* The angle of (x, y), neither of which is below 0: Newton's step from the library's. */
static inline double pbf_angle_by_newton(double y, double x) {
  const double start = atan2(y, x);
  const pbf_pair_real sine = pbf_pair_sine_ahead(start, 0), cosine = pbf_pair_sine_ahead(start, 1);
  const pbf_pair_real a = {y, 0}, b = {-x, 0};
  const pbf_pair_real off = pbf_pair_add(pbf_pair_multiply(a, cosine), pbf_pair_multiply(b, sine));
  const double along = y * sine.high + x * cosine.high;
  return along > 0 ? pbf_pair_of(start, off.high / along).high : start;
}

static inline double pbf_angle(double y, double x) {
  double angle;
  return pbf_small_angle(y, x, &angle) ? angle : pbf_angle_by_newton(y, x);
}

/* ---- Powers --------------------------------------------------------------------------------- */

/* a 2^n of a normal a, where the result is one. */
static inline double pbf_scaled_by_power(double a, int n) {
  const uint64_t bits = (uint64_t)(1023 + n) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return a * power;
}

/* e^x of |x| <= 700: that of a 256th of what is beyond a power of two, squared eight times, without
 * the 1 that it begins with. */
static inline pbf_pair_real pbf_pair_exp(pbf_pair_real x) {
  const double log2[3] = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56, 0x1.7b57a079a1934p-111};
  const double power = floor(x.high / log2[0] + 0.5);
  for (int k = 0; k < 3; ++k)
    x = pbf_pair_add(x, pbf_pair_negate(pbf_pair_product_of(power, log2[k])));
  const pbf_pair_real part = {x.high / 256, x.low / 256}, half = {0.5, 0}, two = {2, 0};
  const pbf_pair_real one = {1, 0};
  const double p = part.high;
  const double rest = p * p * p * (1 / 6.0 + p * (1 / 24.0 + p * (1 / 120.0 + p * (1 / 720.0))));
  pbf_pair_real more = pbf_pair_multiply(half, pbf_pair_multiply(part, part));
  more = pbf_pair_add(part, pbf_pair_add(more, pbf_pair_of(rest, 0)));
  for (int k = 0; k < 8; ++k) more = pbf_pair_multiply(more, pbf_pair_add(two, more));
  more = pbf_pair_add(one, more);
  more.high = pbf_scaled_by_power(more.high, (int)power);
  more.low = pbf_scaled_by_power(more.low, (int)power);
  return more;
}

/* The logarithm of what is above 0 and normal: Newton's step from the library's. */
static inline pbf_pair_real pbf_pair_log(pbf_pair_real x) {
  const pbf_pair_real start = {log(x.high), 0};
  const pbf_pair_real at_start = pbf_pair_exp(start);
  const pbf_pair_real off = pbf_pair_add(x, pbf_pair_negate(at_start));
  return pbf_pair_of(start.high, 2 * off.high / (x.high + at_start.high));
}

static inline int pbf_is_in_range(double x) { return x > -700 && x < 700; }

static inline double pbf_exp(double x) {
  const pbf_pair_real pair = {x, 0};
  return pbf_is_in_range(x) ? pbf_pair_exp(pair).high : exp(x);
}

static inline double pbf_log(double x) {
  const pbf_pair_real pair = {x, 0};
  return x > 1e-300 && x < 1e300 ? pbf_pair_log(pair).high : log(x);
}

/* x^y of x >= 0 */
static inline double pbf_pow(double x, double y) {
  const pbf_pair_real base = {x, 0}, exponent = {y, 0};
  if (!(x > 1e-300 && x < 1e300) || y == 0 || y == 1) return pow(x, y);
  const pbf_pair_real power = pbf_pair_multiply(exponent, pbf_pair_log(base));
  return pbf_is_in_range(power.high) ? pbf_pair_exp(power).high : pow(x, y);
}

/* x^n of a whole n >= 0: products, where they overflow in pairs. */
static inline double pbf_whole_power(double x, int n) {
  const pbf_pair_real base = {x, 0};
  pbf_pair_real power = {1, 0};
  double plain = 1;
  for (; n > 0; --n) {
    power = pbf_pair_multiply(power, base);
    plain *= x;
  }
  return isfinite(power.high) ? power.high : plain;
}

/* What is near the ends of the range of numbers is brought away from them by 2^300 first. */
static inline double pbf_cube_root(double x) {
  const pbf_pair_real third = {1 / 3.0, 0x1.5555555555555p-56};
  const double scale = x < 1e-290 ? 0x1p100 : x > 1e290 ? 0x1p-100 : 1;
  const pbf_pair_real base = {x * scale * scale * scale, 0};
  if (!(x > 0 && isfinite(x))) return cbrt(x); /* exact, or no number */
  return pbf_pair_exp(pbf_pair_multiply(third, pbf_pair_log(base))).high / scale;
}

/* Of an area in 2D, of a volume in 3D. */
static inline double pbf_side_of(double x, int dimension) {
  return dimension == 3 ? pbf_cube_root(x) : sqrt(x);
}

static inline double pbf_cosh(double x) {
  const pbf_pair_real up = {x, 0}, down = {-x, 0};
  if (!pbf_is_in_range(x)) return cosh(x);
  return 0.5 * pbf_pair_add(pbf_pair_exp(up), pbf_pair_exp(down)).high;
}

/* Of 1 < x < 1e100. */
static inline double pbf_acosh(double x) {
  const pbf_pair_real pair = {x, 0}, less = {-1, 0};
  const pbf_pair_real square = pbf_pair_add(pbf_pair_product_of(x, x), less);
  const double start = sqrt(square.high);
  const pbf_pair_real off =
      pbf_pair_add(square, pbf_pair_negate(pbf_pair_product_of(start, start)));
  return pbf_pair_log(pbf_pair_add(pair, pbf_pair_of(start, off.high / (2 * start)))).high;
}

#endif
