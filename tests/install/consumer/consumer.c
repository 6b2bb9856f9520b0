/* consumer PREFIX: at least one backend comes from the tree at PREFIX, and runs; PREFIX is empty
 * when it is linked in. */
#include <stdio.h>
#include <string.h>

#include <pbf/pbf.h>

int main(int argc, char **argv) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  pbf_info info = {.struct_size = sizeof info};
  const float position[3] = {0.5f, 0.5f, 0.5f};
  if (argc != 2 || pbf_desc_init(&desc, sizeof desc) != PBF_OK) return 2;
  desc.capacity = 16;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK ||
      pbf_add_particles(solver, 1, position, NULL, NULL) != PBF_OK ||
      pbf_step(solver, 3) != PBF_OK || pbf_get_info(solver, &info) != PBF_OK) {
    fprintf(stderr, "%s\n", pbf_last_error());
    return 1;
  }
  pbf_destroy(solver);
  printf("%s from %s, %s\n", info.backend, info.path, info.build_id);
  if (!argv[1][0]) return info.path[0] != 0;
  return strncmp(info.path, argv[1], strlen(argv[1])) != 0;
}
