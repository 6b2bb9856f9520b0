/* The cases of pbf-forces, and what they have in common. */
#ifndef PBF_BENCH_FORCES_CASES_H
#define PBF_BENCH_FORCES_CASES_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the fluids run on; null: the fastest. */
extern const char *forces_backend;

/* What is done with a figure, at first a line of a table; with a bar of 0 there is none. Returns 1
 * where it is missed. */
extern int (*forces_report)(const char *name, const char *figure, double is, double right,
                            double bar);

int run_buoyancy(double spacing);
int run_half_sunk_cube(double spacing);
int run_dam_break(double spacing);
int run_tow(double spacing);

/* Ends the program where it is a failure. */
void check(pbf_status status);

/* Defaults, with loads, a domain from 0 on, and a step in which nothing of the speed `fastest`
 * moves by more than a quarter of a spacing. */
pbf_params params_of(double spacing, const double domain[3], double fastest);

/* A solver with water at rest wherever `is_water(x, context)` is not 0, from 0 to `size`; in 2D
 * size[2] is 0. */
pbf_solver *water_of(const pbf_params *params, const double size[3],
                     int (*is_water)(const double x[3], const void *context), const void *context);

#ifdef __cplusplus
}
#endif

#endif
