/* PNG files. */
#ifndef PBF_BENCH_PNG_H
#define PBF_BENCH_PNG_H

#include <string>

namespace bench {

// A file's bytes. Rows from above, three bytes a pixel.
std::string encode_png(int width, int height, const unsigned char *rgb);

}  // namespace bench

#endif
