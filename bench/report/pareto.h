/* The page of a sweep. */
#ifndef PBF_BENCH_REPORT_PARETO_H
#define PBF_BENCH_REPORT_PARETO_H

#include <string>

#include "pareto/results.h"

namespace bench {

// A single HTML file that needs nothing beside it.
void write_pareto_page(const Study &study, const std::string &path);

}  // namespace bench

#endif
