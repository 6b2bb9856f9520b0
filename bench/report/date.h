/* The day and minute at which a page is written. */
#ifndef PBF_BENCH_DATE_H
#define PBF_BENCH_DATE_H

#include <string>

namespace bench {

std::string today();

}  // namespace bench

#endif
