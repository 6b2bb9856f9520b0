#include "core/table.h"

#include <algorithm>

namespace bench {
namespace {

// Code points, so that "–" and "×" take one column.
size_t columns_of(const std::string &text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string &text, size_t width, bool right) {
  const size_t taken = columns_of(text);
  const std::string space(taken < width ? width - taken : 0, ' ');
  return right ? space + text : text + space;
}

std::string rule(size_t width, bool right) {
  return right ? std::string(width - 1, '-') + ":" : std::string(width, '-');
}

}  // namespace

Table::Table(std::vector<std::string> header) : right_(header.size(), false) {
  rows_.push_back(std::move(header));
}

void Table::align_right(size_t first, size_t last) {
  std::fill(right_.begin() + static_cast<std::ptrdiff_t>(first),
            right_.begin() + static_cast<std::ptrdiff_t>(last) + 1, true);
}

void Table::add(std::vector<std::string> row) {
  for (std::string &cell : row) std::replace(cell.begin(), cell.end(), '|', '/');
  row.resize(right_.size());
  rows_.push_back(std::move(row));
}

std::string Table::text() const {
  std::vector<size_t> widths(right_.size(), 3);
  for (const auto &row : rows_) {
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], columns_of(row[i]));
  }
  // A last column of text is ragged: it may hold whole sentences.
  if (!right_.back()) widths.back() = columns_of(rows_[0].back());
  std::string text;
  for (size_t r = 0; r < rows_.size(); ++r) {
    text += "|";
    for (size_t i = 0; i < widths.size(); ++i) {
      text += " " + padded(rows_[r][i], widths[i], right_[i]) + " |";
    }
    text += "\n";
    if (r > 0) continue;
    text += "|";
    for (size_t i = 0; i < widths.size(); ++i) text += " " + rule(widths[i], right_[i]) + " |";
    text += "\n";
  }
  return text;
}

}  // namespace bench
