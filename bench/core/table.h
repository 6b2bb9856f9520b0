/* A table that reads well on a terminal and is Markdown. */
#ifndef PBF_BENCH_TABLE_H
#define PBF_BENCH_TABLE_H

#include <string>
#include <vector>

namespace bench {

class Table {
 public:
  explicit Table(std::vector<std::string> header);

  void align_right(size_t first, size_t last);
  void add(std::vector<std::string> row);
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the header first
  std::vector<bool> right_;
};

}  // namespace bench

#endif
