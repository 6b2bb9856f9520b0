#include "fit.h"

void pbf_fit_centre(pbf_fit *m, uint32_t dimension) {
  for (uint32_t k = 0; k < dimension; ++k) m->way[k] /= m->weight;
  for (uint32_t v = 0; v < PBF_FIT_VALUES; ++v) {
    m->value[v] /= m->weight;
    for (uint32_t k = 0; k < dimension; ++k)
      m->slope[v][k] = m->slope[v][k] / m->weight - m->value[v] * m->way[k];
  }
  for (uint32_t k = 0; k < dimension; ++k)
    for (uint32_t l = 0; l <= k; ++l)
      m->ways[k][l] = m->ways[k][l] / m->weight - m->way[k] * m->way[l];
}

void pbf_fit_decompose(pbf_fit *m, double min_spread, uint32_t n) {
  for (uint32_t k = 0; k < n; ++k) {
    double pivot = m->ways[k][k];
    for (uint32_t j = 0; j < k; ++j) pivot -= m->ways[k][j] * m->ways[k][j] * m->ways[j][j];
    m->ways[k][k] = pivot = pivot > min_spread ? pivot : 0;
    for (uint32_t i = k + 1; i < n; ++i) {
      double sum = m->ways[i][k];
      for (uint32_t j = 0; j < k; ++j) sum -= m->ways[i][j] * m->ways[k][j] * m->ways[j][j];
      m->ways[i][k] = pivot > 0 ? sum / pivot : 0;
    }
  }
}

void pbf_fit_solve(const pbf_fit *m, double b[3], uint32_t n) {
  for (uint32_t k = 0; k < n; ++k)
    for (uint32_t j = 0; j < k; ++j) b[k] -= m->ways[k][j] * b[j];
  for (uint32_t k = 0; k < n; ++k) b[k] = m->ways[k][k] > 0 ? b[k] / m->ways[k][k] : 0;
  for (uint32_t k = n; k-- > 0;)
    for (uint32_t i = k + 1; i < n; ++i) b[k] -= m->ways[i][k] * b[i];
}
