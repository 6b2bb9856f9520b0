/* Sentences are one line of UTF-8, whatever is quoted in them and wherever they are cut. */
#include <math.h>
#include <stdio.h>

#include <pbf/ranks.h>

#include "support.h"

static size_t length_of(unsigned char first) {
  if (first < 0x80) return 1;
  return first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
}

/* The Unicode Standard, table 3-7, but for what its rows exclude of second bytes. */
static void assert_line(const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c;) {
    const size_t length = length_of(*c);
    assert_true(length > 0);
    assert_true(*c >= ' ' && *c != 0x7f);
    for (size_t k = 1; k < length; ++k) assert_int_equal(c[k] & 0xc0, 0x80);
    c += length;
  }
}

/* So many times after a beginning of some bytes. */
static char *repeated(const char *begin, const char *letter, int times) {
  const size_t size = strlen(begin) + strlen(letter) * (size_t)times + 1;
  char *text = malloc(size);
  assert_non_null(text);
  strcpy(text, begin);
  for (int k = 0; k < times; ++k) strcat(text, letter);
  return text;
}

static void assert_quoted(const char *text) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *solver = NULL;
  desc.backend = text;
  assert_int_not_equal(pbf_create(&desc, NULL, &solver), PBF_OK);
  assert_line(pbf_last_error());
  desc = test_desc(3, PBF_FLOAT32, 8);
  desc.isa = text;
  assert_int_not_equal(pbf_create(&desc, NULL, &solver), PBF_OK);
  assert_line(pbf_last_error());
  assert_int_not_equal(pbf_load_backend(text), PBF_OK);
  assert_line(pbf_last_error());
}

static void what_is_quoted_is_one_line(void **state) {
  (void)state;
  static const char *const texts[] = {"serial\n",   "a\nb",     "\x1b[31mred",  "\xff\xfe",
                                      "\xc3",       "\xe2\x82", "\xed\xa0\x80", "\xc0\xaf",
                                      "\x7f",       "/\n.so",   "/tmp/\xff.so", "\xf4\x90\x80\x80",
                                      "caf\xc3\xa9"};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) assert_quoted(texts[i]);
  assert_int_not_equal(pbf_load_backend("caf\xc3\xa9"), PBF_OK); /* what is right stays */
  assert_non_null(strstr(pbf_last_error(), "\"caf\xc3\xa9\""));
}

/* With each number of bytes before them some character is cut in two. */
static void what_is_cut_ends_with_a_character(void **state) {
  (void)state;
  static const char *const begins[] = {"/", "/x", "/xx", "/xxx"};
  static const char *const letters[] = {"\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x92\xa7"};
  for (int b = 0; b < 4; ++b)
    for (int l = 0; l < 3; ++l) {
      char *text = repeated(begins[b], letters[l], 3000);
      assert_quoted(text);
      assert_quoted(text + 1);
      free(text);
    }
  uint32_t count;
  assert_ok(pbf_get_backend_count(&count));
  for (uint32_t i = 0; i < count; ++i) {
    pbf_backend_info info = {.struct_size = sizeof info};
    assert_ok(pbf_get_backend_info(NULL, i, &info));
    assert_line(info.reason);
    if (strstr(info.path, "/x")) assert_line(info.path);
  }
}

static pbf_status gather(void *user, const void *mine, void *all, uint64_t bytes) {
  (void)user, (void)mine, (void)all, (void)bytes;
  return PBF_OK;
}

static pbf_status sum(void *user, uint32_t *values, uint64_t count) {
  (void)user, (void)values, (void)count;
  return PBF_OK;
}

static pbf_status exchange(void *user, uint32_t send_count, const pbf_rank_message *sends,
                           uint32_t receive_count, const pbf_rank_message *receives) {
  (void)user, (void)send_count, (void)sends, (void)receive_count, (void)receives;
  return PBF_OK;
}

static const char *reason(void *user) {
  (void)user;
  return "";
}

/* Whatever its sign, which C libraries write, too. */
static void what_is_no_number_is_nan(void **state) {
  (void)state;
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  const double signs[2] = {NAN, -NAN};
  pbf_solver *solver = test_create(&desc, NULL), *other = NULL;
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  assert_ok(pbf_set_colliders(solver, 1, &ball));
  for (int k = 0; k < 2; ++k) {
    const pbf_ranks ranks = {.struct_size = sizeof ranks,
                             .count = 1,
                             .all_gather = gather,
                             .sum = sum,
                             .exchange = exchange,
                             .reason = reason,
                             .shares = &signs[k]};
    assert_fails(pbf_move_colliders(solver, 1, &ball, signs[k]), PBF_ERROR_INVALID_ARGUMENT,
                 "duration is NaN; it must be a time above 0");
    assert_fails(pbf_create_on_ranks(&desc, NULL, &ranks, &other), PBF_ERROR_INVALID_ARGUMENT,
                 "ranks->shares[0] is NaN; it must be above 0");
  }
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_quoted_is_one_line),
      cmocka_unit_test(what_is_cut_ends_with_a_character),
      cmocka_unit_test(what_is_no_number_is_nan),
  };
  return TEST_RUN(tests);
}
