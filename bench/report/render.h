/* A page from a template, in the file `path`, whose folder is made where it is not there. */
#ifndef PBF_BENCH_REPORT_RENDER_H
#define PBF_BENCH_REPORT_RENDER_H

#include <string>

#include <kainjow/mustache.hpp>

namespace bench {

/* `name` is the template's, for the message. */
void render_page(const std::string &name, const std::string &text,
                 const kainjow::mustache::data &values, const std::string &path);

}  // namespace bench

#endif
