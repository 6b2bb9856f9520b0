/* RFC 4648, section 4. */
#ifndef PBF_BENCH_BASE64_H
#define PBF_BENCH_BASE64_H

#include <string>

namespace bench {

std::string base64(const std::string &bytes);

}  // namespace bench

#endif
