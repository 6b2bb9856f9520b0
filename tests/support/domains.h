/* Domains that a neighbour search has to cope with, for h = 1. */
#ifndef PBF_TESTS_DOMAINS_H
#define PBF_TESTS_DOMAINS_H

typedef struct test_domain {
  double lower[3], size[3];
} test_domain;

/* Within the limits of any grid, thin along each axis, too large along each, along all, and far
 * from the origin. */
static const test_domain TEST_DOMAINS[] = {
    {{0, 0, 0}, {0, 0, 0}},           {{-3, 2, 1}, {7.3, 5.9, 4.1}},
    {{0, 0, 0}, {3000, 4, 3}},        {{0, 0, 0}, {3, 4000, 4}},
    {{0, 0, 0}, {3, 4, 3000}},        {{0, 0, 0}, {60, 60, 60}},
    {{-50, 0, -50}, {100, 100, 100}}, {{0, 0, 0}, {100, 3, 100}},
    {{0, 0, 0}, {1, 3000, 3000}},     {{-1e4, 0, -1e4}, {2e4, 1e3, 2e4}},
    {{5e5, -5e5, 5e5}, {80, 90, 70}}, {{0, 0, 0}, {1e5, 1e5, 1e5}},
};

#endif
